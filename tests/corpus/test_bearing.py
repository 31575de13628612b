import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from s2glib.corpus import bearing
from s2glib.corpus.bearing import BEARINGS, MANNERS, STRONGEST_REACH, perform
from s2glib.corpus.script import EMOTIONS, SPEAKERS

seeds = st.integers(0, 2**32)


def drawn(emotion, intensity, seed, speaker="voice_01"):
    return perform(emotion, speaker, intensity, np.random.default_rng(seed))


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_without_strength_no_emotion_shows(monkeypatch, emotion):
    monkeypatch.setattr(bearing, "body_strength", lambda intensity: 0.0)
    neutral, other = drawn("neutral", 0.5, 3), drawn(emotion, 0.5, 3)
    assert other.bearing == neutral.bearing
    assert np.array_equal(other.rest, neutral.rest)


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_full_intensity_is_near_the_table_on_the_average(emotion):
    bearings = np.mean([drawn(emotion, 1.0, seed).bearing for seed in range(300)], axis=0)
    table = np.array(BEARINGS[emotion])
    others = [np.abs(bearings - np.array(BEARINGS[e]))[4:].sum() for e in EMOTIONS]
    assert EMOTIONS[int(np.argmin(others))] == emotion
    assert np.abs(bearings - table)[4:9].max() < 0.08  # posture


@given(st.sampled_from(EMOTIONS), st.sampled_from(SPEAKERS), st.floats(0, 1.15), seeds)
def test_gestures_never_outgrow_the_arm(emotion, speaker, intensity, seed):
    performance = drawn(emotion, intensity, seed, speaker)
    assert 0 < performance.bearing.amplitude <= STRONGEST_REACH
    assert performance.bearing.tempo > 0
    assert performance.manner is MANNERS[speaker]


def test_every_speaker_has_a_manner_of_their_own():
    assert tuple(MANNERS) == SPEAKERS
    assert len(set(MANNERS.values())) == len(SPEAKERS)
    left = sum(manner.dominant == "left" for manner in MANNERS.values())
    assert 5 <= left <= 15


def test_chance_enters_through_the_generator_alone():
    assert drawn("anger", 0.5, 3).bearing == drawn("anger", 0.5, 3).bearing
    assert drawn("anger", 0.5, 3).bearing != drawn("anger", 0.5, 4).bearing
