import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.metrics import beat_alignment, kinematic_beats, shuffled_alignment

quick = settings(deadline=None, max_examples=25)
seeds = st.integers(0, 2**32 - 1)


def strokes(rng, stops, duration=10.0, fps=30):
    """A hand that travels between random places and comes to rest at the times `stops`."""
    t = np.arange(round(duration * fps)) / fps
    knots = np.concatenate([[0.0], stops, [duration]])
    places = rng.normal(scale=0.2, size=(len(knots), 3))
    leg = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(knots) - 2)
    u = ((t - knots[leg]) / (knots[leg + 1] - knots[leg]))[:, None]
    return (places[leg] + (places[leg + 1] - places[leg]) * (3 * u**2 - 2 * u**3))[:, None]


def alignment_by_hand(from_beats, to_beats, sigma):
    total = 0.0
    for a in from_beats:
        total += math.exp(-(min(abs(a - b) for b in to_beats) ** 2) / (2 * sigma**2))
    return total / len(from_beats)


def test_a_hand_that_stops_beats_where_it_stops(rng):
    stops = np.array([1.21, 2.5, 3.87, 6.1, 8.0])
    beats = kinematic_beats(strokes(rng, stops), 30, joints=[0], order=5)
    assert beats == pytest.approx(stops, abs=1 / 30)


@quick
@given(seeds, st.integers(1, 8), st.sampled_from([0.0, 20.0, 60.0]))
def test_kinematic_beats_agree_with_the_loop(seed, order, threshold):
    motion = np.random.default_rng(seed).normal(size=(60, 3, 3))
    speed = [25 * sum(math.dist(motion[k + 1, j], motion[k, j]) for j in (0, 2)) for k in range(59)]
    expected = []
    for k in range(1, 58):
        near = [speed[i] for i in range(max(k - order, 0), min(k + order, 58) + 1) if i != k]
        rise = max(speed[k - 1], speed[k + 1]) - speed[k]
        if speed[k] < min(near) and rise >= threshold:
            expected.append((k + 0.5) / 25)
    found = kinematic_beats(motion, 25, joints=[0, 2], order=order, threshold=threshold)
    assert found == pytest.approx(expected)


@quick
@given(seeds)
def test_minima_further_apart_are_a_subset(seed):
    motion = np.random.default_rng(seed).normal(size=(80, 2, 3))
    near, far = (set(kinematic_beats(motion, 30, joints=[0], order=k)) for k in (2, 6))
    assert far <= near


def test_a_still_or_steady_body_has_no_beats():
    steady = np.arange(20.0)[:, None, None] * np.ones((1, 2, 3))
    assert kinematic_beats(steady, 30, joints=[0, 1], order=3).shape == (0,)
    assert kinematic_beats(0 * steady, 30, joints=[0, 1], order=3).shape == (0,)


@quick
@given(seeds, st.floats(0.02, 1))
def test_alignment_agrees_with_the_definition(seed, sigma):
    a, b = np.random.default_rng(seed).uniform(0, 5, size=(2, 9))
    found = beat_alignment(a, b[:6], sigma=sigma)
    assert found == pytest.approx(alignment_by_hand(a, b[:6], sigma))
    assert 0 <= found <= 1


@quick
@given(seeds)
def test_more_beats_to_meet_never_lower_the_score(seed):
    a, b = np.random.default_rng(seed).uniform(0, 5, size=(2, 9))
    assert beat_alignment(a, b, sigma=0.1) >= beat_alignment(a, b[:4], sigma=0.1)


def test_beats_that_coincide_score_one_and_missing_beats_are_told_apart():
    beats, none = np.array([1.0, 2.0]), np.array([])
    assert beat_alignment(beats, beats[::-1].copy(), sigma=0.1) == 1
    assert beat_alignment(beats, none, sigma=0.1) == 0
    assert math.isnan(beat_alignment(none, beats, sigma=0.1))
    assert math.isnan(beat_alignment(none, none, sigma=0.1))


def test_jitter_lifts_audio_to_motion_but_not_motion_to_audio(rng):
    """METRICS pitfall 17: two centimetres of trembling, and one direction calls it better."""
    audio = np.sort(rng.uniform(0.5, 9.5, size=20))
    calm = strokes(rng, np.arange(0.7, 9.5, 0.45))
    trembling = calm + rng.normal(scale=0.02, size=calm.shape)
    calm_beats, many = (kinematic_beats(x, 30, joints=[0], order=1) for x in (calm, trembling))
    assert len(many) > 2 * len(calm_beats)
    gain = beat_alignment(audio, many, sigma=0.1) - beat_alignment(audio, calm_beats, sigma=0.1)
    assert gain > 0.15
    back = beat_alignment(many, audio, sigma=0.1) - beat_alignment(calm_beats, audio, sigma=0.1)
    assert back < 0.05


def test_a_gaussian_over_the_speed_resists_the_jitter(rng):
    calm = strokes(rng, np.arange(0.7, 9.5, 0.9))
    trembling = calm + rng.normal(scale=0.02, size=calm.shape)
    raw, smooth = (
        len(kinematic_beats(trembling, 30, joints=[0], order=1, smooth=s)) for s in (0, 5)
    )
    assert smooth < raw / 3


def test_beating_all_the_time_wins_from_audio_to_motion_only(rng):
    audio, metronome = rng.uniform(0, 10, size=20), np.arange(0, 10, 5 / 30)
    assert beat_alignment(audio, metronome, sigma=0.1) > 0.85
    assert beat_alignment(metronome, audio, sigma=0.1) < 0.6


def clips_of_beats(rng, clips, jitter=0.03):
    audio = [np.sort(rng.uniform(0, 4, size=8)) for _ in range(clips)]
    return [beats + rng.normal(scale=jitter, size=8) for beats in audio], audio


def test_the_margin_separates_aligned_beats_from_unrelated_ones(rng):
    motion, audio = clips_of_beats(rng, clips=100)
    _, other_audio = clips_of_beats(rng, clips=100)
    options = {"durations": np.full(100, 4.0), "sigma": 0.1, "rng": rng, "shuffles": 10}
    aligned = shuffled_alignment(motion, audio, **options)
    unrelated = shuffled_alignment(motion, other_audio, **options)
    assert aligned.margins.mean() > 0.4
    assert abs(unrelated.margins.mean()) < 0.05
    assert unrelated.scores.mean() > 0.3  # chance alone looks respectable


def test_shuffled_scores_agree_with_all_wrong_pairs(rng):
    motion, audio = clips_of_beats(rng, clips=4)
    found = shuffled_alignment(
        motion, audio, durations=np.full(4, 9.0), sigma=0.1, rng=rng, shuffles=1000
    )
    for i in range(4):
        wrong = [alignment_by_hand(motion[i], audio[j], 0.1) for j in range(4) if j != i]
        assert found.scores[i] == pytest.approx(alignment_by_hand(motion[i], audio[i], 0.1))
        assert found.shuffled[i] == pytest.approx(np.mean(wrong), abs=0.04)


def test_a_shorter_partner_does_not_inflate_the_margin():
    ticks = np.arange(0.0, 8.0, 0.5)
    long_and_short = [ticks, ticks[:4]]
    found = shuffled_alignment(
        long_and_short,
        long_and_short,
        durations=np.array([8.0, 1.9]),
        sigma=0.1,
        rng=np.random.default_rng(0),
        shuffles=3,
    )
    assert found.margins == pytest.approx([0, 0])


def test_a_clip_without_beats_has_no_margin_and_spoils_no_other(rng):
    motion, audio = clips_of_beats(rng, clips=3)
    motion[1] = np.array([])
    found = shuffled_alignment(motion, audio, durations=np.full(3, 4.0), sigma=0.1, rng=rng)
    assert np.isnan(found.margins).tolist() == [False, True, False]


@pytest.mark.parametrize(
    ("motion", "options", "error", "says"),
    [
        (np.zeros((9, 2)), {}, ValueError, "axes"),
        (np.zeros((1, 2, 3)), {}, ValueError, "at least 2 frames"),
        (np.zeros((0, 2, 3)), {}, ValueError, "at least 2 frames"),
        (np.full((9, 2, 3), np.nan), {}, ValueError, "NaN"),
        (None, {}, TypeError, "numpy array"),
        (np.zeros((9, 2, 3)), {"joints": [2]}, ValueError, "2 joints of the motion"),
        (np.zeros((9, 2, 3)), {"joints": []}, ValueError, "2 joints of the motion"),
        (np.zeros((9, 2, 3)), {"order": 0}, ValueError, "order must be at least 1"),
        (np.zeros((9, 2, 3)), {"smooth": -1}, ValueError, "smooth"),
        (np.zeros((9, 2, 3)), {"fps": 0}, ValueError, "fps"),
    ],
)
def test_kinematic_beats_refuses_in_one_sentence(unhooked, motion, options, error, says):
    with pytest.raises(error, match=says):
        kinematic_beats(motion, **({"fps": 30, "joints": [0], "order": 2} | options))


@pytest.mark.parametrize(
    ("beats", "sigma", "error", "says"),
    [
        (np.array([np.nan]), 0.1, ValueError, "NaN"),
        (np.ones((2, 2)), 0.1, ValueError, "axes"),
        ([1.0], 0.1, TypeError, "numpy array"),
        (np.ones(2), 0.0, ValueError, "sigma"),
    ],
)
def test_alignment_refuses_in_one_sentence(unhooked, beats, sigma, error, says):
    with pytest.raises(error, match=says):
        beat_alignment(beats, np.ones(1), sigma=sigma)


def test_one_clip_cannot_be_shuffled(rng):
    with pytest.raises(ValueError, match="at least 2 clips"):
        shuffled_alignment([np.ones(1)], [np.ones(1)], durations=np.ones(1), sigma=0.1, rng=rng)
    with pytest.raises(ValueError, match="every clip needs"):
        shuffled_alignment([np.ones(1)], [np.ones(1)], durations=np.ones(2), sigma=0.1, rng=rng)
