from itertools import product

import numpy as np
import pytest

from s2glib.corpus.script import EMOTIONS, TRAIN_SENTENCES, Cell, check_cell, split
from s2glib.recipes.donors import emotion_donors, strangers, style_donors

CELLS = [Cell(*f, 2) for f in product((1, 3), ("voice_01", "voice_05"), EMOTIONS)]


def test_an_emotion_donor_is_the_same_voice_with_other_words_in_another_emotion(rng):
    for cell, donor in zip(CELLS, emotion_donors(CELLS, rng), strict=True):
        assert donor.speaker == cell.speaker
        assert donor.sentence != cell.sentence
        assert donor.emotion != cell.emotion
        assert donor in CELLS


def test_a_style_donor_is_another_voice_with_other_words_in_the_same_emotion(rng):
    for cell, donor in zip(CELLS, style_donors(CELLS, rng), strict=True):
        assert donor.speaker != cell.speaker
        assert donor.sentence != cell.sentence
        assert donor.emotion == cell.emotion


def test_every_emotion_is_wanted_about_equally_often(rng):
    donors = emotion_donors(split("test"), rng)
    counts = [sum(donor.emotion == emotion for donor in donors) for emotion in EMOTIONS]
    assert min(counts) > 50
    assert max(counts) < 120


def test_where_the_test_clips_have_no_donor_their_block_lends_one(rng):
    alone = CELLS[:8]  # one sentence, one voice
    for cell, donor in zip(alone, emotion_donors(alone, rng), strict=True):
        check_cell(donor)
        assert donor.sentence in set(TRAIN_SENTENCES) - {cell.sentence}
        assert donor.take == cell.take


def test_strangers_are_of_another_class(rng):
    classes = rng.integers(3, size=50)
    assert (classes[strangers(classes, rng)] != classes).all()


def test_without_a_second_class_there_is_no_stranger(rng):
    with pytest.raises(ValueError, match="two or more"):
        strangers(np.zeros(4, int), rng)
