import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from s2glib.corpus.bearing import perform
from s2glib.corpus.build import timing_of
from s2glib.corpus.lexicon import GESTURES
from s2glib.corpus.script import EMOTIONS, SENTENCES, SPEAKERS, Cell
from s2glib.corpus.strokes import (
    EARLY,
    Key,
    Stroke,
    hand_keys,
    hand_path,
    meaning,
    minimum_jerk,
    plan_strokes,
    smooth,
    zigzag,
)
from s2glib.data import GESTURE_TYPES

plans = st.tuples(
    st.integers(0, 15), st.sampled_from(SPEAKERS), st.sampled_from(EMOTIONS), st.integers(0, 999)
)


def planned(plan, intensity=0.8):
    sentence, speaker, emotion, seed = plan
    rng = np.random.default_rng(seed)
    clock = timing_of(Cell(sentence, speaker, emotion, 0))
    performance = perform(emotion, speaker, intensity, rng)
    strokes = plan_strokes(SENTENCES[sentence].marks, clock, performance, rng)
    return clock, performance, strokes, rng


def test_minimum_jerk_starts_and_ends_at_rest():
    u = np.linspace(-0.5, 1.5, 2001)
    way = minimum_jerk(u)
    assert (way[u <= 0] == 0).all()
    assert way[u >= 1] == pytest.approx(1)
    assert (np.diff(way) >= -1e-12).all()
    speed, acceleration = np.gradient(way, u), np.gradient(np.gradient(way, u), u)
    for end in (500, 1500):
        assert abs(speed[end]) < 1e-3
        assert abs(acceleration[end]) < 0.1
    assert speed.max() == pytest.approx(15 / 8, rel=1e-3)  # the known peak of minimum jerk


@given(st.integers(1, 61), st.integers(1, 40), st.floats(-3, 3))
def test_smoothing_keeps_length_and_constants(width, frames, value):
    smoothed = smooth(np.full((frames, 2), value), width)
    assert smoothed.shape == (frames, 2)
    assert smoothed == pytest.approx(value)


@given(plans)
def test_strokes_end_just_before_a_stressed_vowel_or_a_word(plan):
    clock, performance, strokes, _ = planned(plan)
    anchors = np.concatenate([clock.stress_times, clock.word_starts]) - EARLY
    anchors = np.maximum(anchors + 0.3 * performance.manner.lag, 0.3)
    for stroke in strokes:
        assert np.abs(anchors - stroke.apex).min() < 0.075  # five sigma of the jitter


@given(plans)
def test_only_marked_words_get_a_gesture_of_their_own(plan):
    _, _, strokes, _ = planned(plan)
    assert {s.name for s in strokes} <= set(SENTENCES[plan[0]].marks.values()) | {"beat"}
    assert all(stroke.scale == 1 for stroke in strokes if stroke.name != "beat")
    assert all(0.4 <= stroke.scale <= 1 for stroke in strokes)


def test_eager_emotions_gesture_more():
    counts = {
        emotion: sum(len(planned((s, "voice_01", emotion, s), 1.0)[2]) for s in range(16))
        for emotion in ("anger", "sadness")
    }
    assert counts["anger"] > 1.5 * counts["sadness"]


@given(plans)
def test_a_hands_keys_start_at_rest_and_keep_their_distance(plan):
    clock, performance, strokes, rng = planned(plan)
    for side in ("left", "right"):
        times = [key.time for key in hand_keys(strokes, side, clock.duration, performance, rng)]
        assert times[0] < 0.4
        assert (np.diff(times) >= 0.06 - 1e-9).all()


def test_both_hands_join_in_a_two_handed_gesture():
    clock, performance, _, rng = planned((0, "voice_01", "neutral", 0))
    for name in ("big", "up"):
        keys = {
            side: hand_keys([Stroke(2.0, name, 1.0)], side, clock.duration, performance, rng)
            for side in ("left", "right")
        }
        assert len(keys["right"]) > 1  # voice_01's dominant hand
        if GESTURES[name].hands == "both":
            assert len(keys["left"]) > 1


def test_a_hand_without_tremor_passes_near_its_keys():
    _, performance, _, rng = planned((0, "voice_01", "neutral", 0))
    performance = performance._replace(bearing=performance.bearing._replace(tremor=0.0))
    places = np.array([[0.1, -0.7, 0.3], [0.2, 0.0, 0.6], [0.0, -0.3, 0.5]])
    keys = [Key(t, p, "in", "flat") for t, p in zip((0.0, 1.0, 2.0), places, strict=True)]
    times = np.arange(90) / 30
    path = hand_path(keys, times, np.zeros(90), performance, rng)
    for key in keys[1:]:
        assert np.abs(path.wrist[round(key.time * 30)] - key.place).max() < 0.06
    assert np.linalg.norm(path.palm, axis=1) == pytest.approx(1)
    assert 0 <= path.shape.min() <= path.shape.max() <= 1


@given(plans)
def test_the_zigzag_turns_on_stressed_vowels_and_nowhere_else(plan):
    clock, performance, _, rng = planned(plan)
    times = np.arange(int(clock.duration * 1000)) / 1000
    turn = zigzag(clock, times, performance, rng)
    direction = np.sign(np.diff(turn))
    moving = np.flatnonzero(np.abs(np.diff(turn)) > 1e-9)
    flips = moving[1:][np.diff(direction[moving]) != 0]
    stresses = clock.stress_times - 0.02
    assert len(flips) > 0
    # a turn lies between the last moving frame before it and the first after it
    before = times[moving[:-1][np.diff(direction[moving]) != 0]]
    for early, late in zip(before, times[flips], strict=True):
        assert ((stresses > early - 0.02) & (stresses < late + 0.02)).any()


@given(plans)
def test_meaning_is_scored_between_0_and_1_with_the_strokes_own_kind(plan):
    clock, performance, strokes, _ = planned(plan)
    times = np.arange(int(clock.duration * 30)) / 30
    semantic, kind = meaning(strokes, times, performance.bearing.tempo)
    assert 0 <= semantic.min() <= semantic.max() <= 1
    assert ((semantic > 0) == (kind > 0)).all()
    kinds = {GESTURE_TYPES.index(GESTURES[stroke.name].kind) for stroke in strokes}
    assert set(kind) <= kinds | {0}


def test_a_marked_gesture_outranks_a_beat_at_the_same_moment():
    times = np.arange(60) / 30
    both = [Stroke(1.0, "beat", 1.0), Stroke(1.0, "you", 1.0)]
    semantic, kind = meaning(both, times, 1.0)
    assert semantic[30] == 0.7
    assert GESTURE_TYPES[kind[30]] == "deictic"
