import re
from itertools import combinations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from s2glib.corpus import BEARINGS, EMOTIONS, GESTURES, PROSODY, SENTENCES, SPEAKERS, VOICES
from s2glib.corpus.script import (
    UNSEEN_SENTENCES,
    UNSEEN_SPEAKERS,
    Cell,
    parse_id,
    speech_take,
    split,
)

SIZES = {
    "train": None,
    "validation": None,
    "test": 672,
    "unseen-sentences": 2 * 24 * 8,
    "unseen-speakers": 14 * 6 * 8,
    "motion": 14 * 24 * 8 * 10,
    "shipped": 4 * 4 * 8,
}
APART = [name for name in SIZES if name != "shipped"]
cells = st.builds(
    Cell, st.integers(0, 15), st.sampled_from(SPEAKERS), st.sampled_from(EMOTIONS), st.integers(0)
)


def test_the_corpus_is_sixteen_sentences_by_thirty_voices_by_beats_eight_emotions():
    assert (len(SENTENCES), len(SPEAKERS), len(EMOTIONS)) == (16, 30, 8)
    assert len({voice.variant for voice in VOICES.values()}) == 30
    assert tuple(PROSODY) == tuple(BEARINGS) == EMOTIONS


def test_every_emotion_has_two_lines_of_its_own():
    lines = [sentence.emotion for sentence in SENTENCES]
    assert all(lines.count(emotion) == 2 for emotion in EMOTIONS)


def test_every_mark_stands_on_a_word_and_names_a_gesture_of_the_lexicon():
    for sentence in SENTENCES:
        assert set(sentence.marks.values()) <= set(GESTURES)
        assert max(sentence.marks) < len(sentence.words)
        assert "|" not in sentence.text


@pytest.mark.parametrize("name", SIZES)
def test_a_split_has_its_size_and_no_cell_twice(name):
    found = split(name)
    assert len(set(found)) == len(found) == (SIZES[name] or len(found))


@pytest.mark.parametrize(("one", "other"), list(combinations(APART, 2)))
def test_no_two_splits_share_a_clip(one, other):
    assert not set(split(one)) & set(split(other))


def test_training_and_validation_fill_takes_0_and_1_of_the_block():
    train, validation = split("train"), split("validation")
    block = {(c.sentence, c.speaker, c.emotion, c.take) for c in train + validation}
    assert len(block) == 14 * 24 * 8 * 2
    assert 0.08 < len(validation) / len(block) < 0.12
    assert {cell.take for cell in train} == {0, 1}


@pytest.mark.parametrize("name", ["train", "validation", "test", "motion", "shipped"])
def test_the_trained_block_never_meets_what_is_kept_unseen(name):
    for cell in split(name):
        assert cell.sentence not in UNSEEN_SENTENCES
        assert cell.speaker not in UNSEEN_SPEAKERS


def test_each_unseen_split_is_unseen_in_one_factor_only():
    assert {c.sentence for c in split("unseen-sentences")} == set(UNSEEN_SENTENCES)
    assert not {c.speaker for c in split("unseen-sentences")} & set(UNSEEN_SPEAKERS)
    assert {c.speaker for c in split("unseen-speakers")} == set(UNSEEN_SPEAKERS)
    assert not {c.sentence for c in split("unseen-speakers")} & set(UNSEEN_SENTENCES)


def test_shipped_clips_are_a_full_factorial_that_no_checkpoint_trains_on():
    shipped = split("shipped")
    factors = [{cell[axis] for cell in shipped} for axis in range(4)]
    assert [len(values) for values in factors] == [4, 4, 8, 1]
    used = {cell for name in ("train", "validation", "motion") for cell in split(name)}
    assert not used & set(shipped)


def test_an_unknown_split_is_refused_with_the_known_ones():
    with pytest.raises(ValueError, match="train, validation, test"):
        split("holdout")


@given(cells)
def test_a_clips_name_says_which_cell_it_is(cell):
    assert parse_id(cell.id) == cell


@given(st.text())
def test_only_well_formed_names_are_read(name):
    assume(not re.fullmatch(r"s\d+-voice_\d\d-[a-z]+-t\d+", name))
    with pytest.raises(ValueError, match="got"):
        parse_id(name)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("s16-voice_01-anger-t2", "sentences are 0 to 15"),
        ("s01-voice_31-anger-t2", "speakers are voice_01 to voice_30"),
        ("s01-voice_01-joy-t2", "emotions are neutral"),
        ("s01-voice_01-anger", "a clip is named like"),
        ("s1x-voice_01-anger-t2", "a clip is named like"),
        ("", "a clip is named like"),
    ],
)
def test_a_wrong_name_is_refused_with_the_factor_that_is_wrong(name, reason):
    with pytest.raises(ValueError, match=reason):
        parse_id(name)


@given(st.integers(0, 19))
def test_motion_takes_share_the_speech_of_takes_0_and_1(take):
    assert speech_take(take) == (take % 2 if take >= 10 else take)
