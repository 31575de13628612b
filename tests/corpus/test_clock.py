import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from s2glib.corpus.build import timing_of
from s2glib.corpus.clock import LEAD_IN, TAIL, readings, word_places
from s2glib.corpus.script import EMOTIONS, PROSODY, SENTENCES, SPEAKERS, Cell

sentences = st.integers(0, 15)
speakers = st.sampled_from(SPEAKERS)
emotions = st.sampled_from(EMOTIONS)


def same(a, b):
    return all(np.array_equal(x, y) for x, y in zip(a, b, strict=True))


@given(sentences, speakers, speakers, emotions, st.integers(0, 2))
def test_two_speakers_keep_one_clock(sentence, one, other, emotion, take):
    first, second = (timing_of(Cell(sentence, who, emotion, take)) for who in (one, other))
    assert same(first, second)


@given(sentences, emotions, st.integers(10, 19))
def test_a_motion_take_keeps_the_clock_of_its_speech(sentence, emotion, take):
    cell = Cell(sentence, "voice_01", emotion, take)
    assert same(timing_of(cell), timing_of(cell._replace(take=take % 2)))


@given(sentences, emotions, emotions)
def test_a_clip_can_be_put_on_another_emotions_clock(sentence, emotion, clock_of):
    cell = Cell(sentence, "voice_01", emotion, 2)
    assert same(timing_of(cell, clock_of), timing_of(cell._replace(emotion=clock_of)))


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_an_emotion_bends_the_tempo_as_its_table_says(emotion):
    for sentence in range(16):
        neutral, bent = (
            timing_of(Cell(sentence, "voice_01", name, 0)) for name in ("neutral", emotion)
        )
        prosody = PROSODY[emotion]
        silent = np.array([phoneme == "" for phoneme in neutral.phonemes])
        factors = np.where(neutral.stressed, prosody.accent, np.where(silent, prosody.pause, 1))
        expected = np.diff(neutral.boundaries) * factors / prosody.rate
        assert np.diff(bent.boundaries) == pytest.approx(expected)


@given(sentences)
def test_takes_differ_by_a_little_jitter(sentence):
    a, b = (np.diff(timing_of(Cell(sentence, "voice_01", "fear", t)).boundaries) for t in (0, 1))
    change = np.log(a[b > 0] / b[b > 0])
    assert 0 < np.abs(change).max() < 0.5


@given(sentences, emotions, st.integers(0, 2))
def test_phonemes_follow_each_other_between_lead_in_and_tail(sentence, emotion, take):
    clock = timing_of(Cell(sentence, "voice_01", emotion, take))
    assert clock.boundaries[0] == LEAD_IN
    assert clock.duration == clock.boundaries[-1] + TAIL
    assert (np.diff(clock.boundaries) >= 0).all()
    assert len(clock.phonemes) == len(clock.stressed) == len(clock.boundaries) - 1


@given(sentences, emotions)
def test_words_divide_the_speech_between_them(sentence, emotion):
    clock = timing_of(Cell(sentence, "voice_01", emotion, 1))
    assert clock.words == SENTENCES[sentence].words
    assert (clock.word_ends > clock.word_starts).all()
    assert clock.word_ends[:-1] == pytest.approx(clock.word_starts[1:])
    assert clock.word_starts[0] >= LEAD_IN


@given(sentences, emotions)
def test_every_stressed_vowel_lies_in_a_word(sentence, emotion):
    clock = timing_of(Cell(sentence, "voice_01", emotion, 0))
    assert len(clock.stress_times) >= 3
    word = np.searchsorted(clock.word_starts, clock.stress_times + 1e-9, "right") - 1
    assert (word >= 0).all()
    assert (clock.stress_times < clock.word_ends[word]).all()


def test_every_sentence_has_a_shipped_reading_with_as_many_words():
    for sentence, reading in zip(SENTENCES, readings(), strict=True):
        assert len(reading.word_places) == len(sentence.words)
        assert list(reading.word_places) == sorted(set(reading.word_places))
        assert len(reading.phonemes) == len(reading.durations)


def test_words_that_espeak_joins_share_their_phonemes_by_letters():
    starts = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    places = word_places(("do", "not", "go"), (("do", 0.0), ("go", 0.5)), starts)
    assert places == (0, 2, 5)  # two of five letters, five phonemes


def test_without_the_shipped_clock_there_is_no_reading(tmp_path):
    with pytest.raises(FileNotFoundError):
        readings(tmp_path / "clock.json")
