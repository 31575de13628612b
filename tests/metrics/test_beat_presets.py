import math

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from s2glib.metrics import BEAT_PRESETS, beat_score, kinematic_beats, mean_speeds, preset_beats

FPS = 30


@pytest.fixture
def motion(rng):
    """Ten seconds of 22 joints that sway at speech-like rates."""
    t = np.arange(300)[:, None, None, None] / FPS
    rates, phases = rng.uniform(0.3, 1.8, (1, 22, 3, 4)), rng.uniform(0, 7, (1, 22, 3, 4))
    sway = np.sin(2 * np.pi * rates * t + phases).sum(-1) * 0.05
    return sway + rng.normal(size=(1, 22, 3))


@pytest.fixture
def audio(rng):
    return np.sort(rng.uniform(0, 10, size=25))


def length(vector):
    return math.sqrt(sum(float(x) ** 2 for x in vector))


def minima(curve, order):
    """Frames strictly below every other frame within `order`, ends excluded."""
    lows = []
    for k in range(1, len(curve) - 1):
        window = range(max(k - order, 0), min(k + order, len(curve) - 1) + 1)
        if all(curve[k] < curve[i] for i in window if i != k):
            lows.append(k)
    return lows


def score(from_beats, to_beats, sigma):
    nearest = [min(abs(a - b) for b in to_beats) for a in from_beats]
    return sum(math.exp(-(d**2) / (2 * sigma**2)) for d in nearest) / len(nearest)


def test_aist_sums_all_joints_and_asks_each_motion_beat(motion, audio):
    speed = [0.0]
    for k in range(1, 300):
        speed.append(sum(length(motion[k, j] - motion[k - 1, j]) for j in range(22)))
    beats = [k / FPS for k in minima(speed, 10)]
    expected = score(beats, audio, 3 / FPS)
    assert beat_score(motion, audio, FPS, preset="aist") == pytest.approx(expected)


@pytest.mark.parametrize("preset", ["bailando", "mddiffusion"])
def test_bailando_smooths_the_speed_and_asks_each_audio_beat(motion, audio, preset):
    speed = [
        sum(length(motion[k + 1, j] - motion[k, j]) for j in range(22)) / 22 for k in range(299)
    ]
    beats = [k / FPS for k in minima(gaussian_filter1d(speed, 5), 1)]
    expected = score(audio, beats, 3 / FPS)
    assert beat_score(motion, audio, FPS, preset=preset) == pytest.approx(expected)


def test_beat_looks_at_the_right_wrist_alone(motion, audio):
    speed = [length(motion[k + 1, 21] - motion[k, 21]) for k in range(299)]
    expected = score(audio, [k / FPS for k in minima(speed, 2)], 0.3)
    assert beat_score(motion, audio, FPS, preset="beat") == pytest.approx(expected)


def test_emage_scores_thirteen_joints_and_wants_beats_above_a_speed(motion, audio, rng):
    joints = [3, 6, 9, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21]
    reference = rng.uniform(0.5, 1.5, 13)
    scores = []
    for j, mean_speed in zip(joints, reference, strict=True):
        x = motion[:, j]
        speed = [length(x[1] - x[0]) * FPS]
        speed += [length(x[k + 1] - x[k - 1]) * FPS / 2 for k in range(1, 299)]
        speed += [length(x[299] - x[298]) * FPS]
        beats = [k / FPS for k in minima(speed, 7) if speed[k] / mean_speed > 0.1]
        scores.append(score(audio, beats, 0.3) if beats else 0.0)
    found = beat_score(motion, audio, FPS, preset="emage", reference_speed=reference)
    assert found == pytest.approx(sum(scores) / 13)


def angle(first, second):
    cosine = float(first @ second) / (length(first) * length(second))
    return math.acos(max(-1.0, min(1.0, cosine))) / math.pi


def test_probtalk_watches_the_angles_of_elbows_and_shoulders(motion, audio, rng):
    reference = rng.uniform(0.05, 0.2, 4)  # so slow a body that some minima are too shallow
    bends = [(18, 16, 20), (19, 17, 21), (16, 9, 18), (17, 9, 19)]  # joint, its two neighbours
    angles = [[angle(x[a] - x[m], x[b] - x[m]) for m, a, b in bends] for x in motion]
    change = [0.0]
    for k in range(1, 300):
        parts = [abs(angles[k][i] - angles[k - 1][i]) / reference[i] / 4 for i in range(4)]
        change.append(sum(parts))
    beats = []
    for k in range(2, 299):
        rise = max(change[k - 1], change[k + 1]) - change[k]
        if change[k] < min(change[k - 1], change[k + 1]) and rise >= 0.01:
            beats.append(k / FPS)
    found = beat_score(motion, audio, FPS, preset="probtalk", reference_speed=reference)
    assert found == pytest.approx(score(audio, beats, 0.1))


def test_amuse_asks_each_beat_of_the_six_arm_joints(motion, audio):
    speed = [
        sum(length(motion[k + 1, j] - motion[k, j]) for j in range(16, 22)) for k in range(299)
    ]
    beats = [(k + 0.5) / FPS for k in minima(speed, 5)]
    assert kinematic_beats(motion, FPS, joints=range(16, 22), order=5) == pytest.approx(beats)
    found = beat_score(motion, audio, FPS, preset="amuse")
    assert found == pytest.approx(score(beats, audio, 0.1))


def test_the_definitions_in_print_disagree_on_one_motion(motion, audio):
    scores = [beat_score(motion, audio, FPS, preset=name) for name in BEAT_PRESETS]
    assert max(scores) - min(scores) > 0.3
    assert all(0 <= value <= 1 for value in scores)


@pytest.mark.parametrize("preset", ["probtalk", "emage"])
def test_the_default_reference_is_the_clip_itself(motion, audio, preset):
    own = mean_speeds([motion], FPS, preset=preset)
    assert beat_score(motion, audio, FPS, preset=preset) == pytest.approx(
        beat_score(motion, audio, FPS, preset=preset, reference_speed=own)
    )


def test_only_emage_has_a_list_of_beats_per_joint(motion):
    counts = {name: len(preset_beats(motion, FPS, preset=name)) for name in BEAT_PRESETS}
    assert counts == dict.fromkeys(BEAT_PRESETS, 1) | {"emage": 13}


@pytest.mark.parametrize("preset", BEAT_PRESETS)
def test_a_body_that_stands_still_scores_zero(preset, audio):
    still = np.ones((60, 22, 3)) * np.arange(22)[:, None]
    assert beat_score(still, audio, FPS, preset=preset) == 0


@pytest.mark.parametrize("preset", BEAT_PRESETS)
def test_silence_is_nan_where_audio_beats_are_averaged_over(motion, preset):
    found = beat_score(motion, np.array([]), FPS, preset=preset)
    audio_first = BEAT_PRESETS[preset].direction == "audio to motion"
    assert math.isnan(found) if audio_first else found == 0


@pytest.mark.parametrize("preset", BEAT_PRESETS)
def test_scoring_leaves_the_motion_as_it_was(motion, audio, preset):
    before = motion.copy()
    first, second = (beat_score(motion, audio, FPS, preset=preset) for _ in range(2))
    assert first == second
    assert np.array_equal(motion, before)


@pytest.mark.parametrize("preset", ["beat", "probtalk", "emage", "amuse"])
def test_a_motion_without_the_arms_is_refused(audio, preset):
    with pytest.raises(ValueError, match="joints"):
        beat_score(np.zeros((60, 16, 3)), audio, FPS, preset=preset)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"preset": "dance"}, "probtalk, beat, emage"),
        ({"preset": "emage", "reference_speed": np.ones(4)}, "reference_speed must have axes"),
        ({"preset": "emage", "reference_speed": np.zeros(13)}, "mean_speeds"),
        ({"preset": "amuse", "fps": 0}, "fps must be a positive"),
        ({"preset": "aist", "fps": 0}, "fps must be a positive"),
        ({"preset": "aist", "motion": np.zeros((30, 66))}, "axes"),
        ({"preset": "aist", "audio_beats": np.array([np.inf])}, "infinite"),
    ],
)
def test_beat_score_refuses_in_one_sentence(unhooked, motion, audio, options, says):
    with pytest.raises(ValueError, match=says):
        beat_score(**({"motion": motion, "audio_beats": audio, "fps": FPS} | options))


def test_the_mean_speed_of_nothing_is_refused():
    with pytest.raises(ValueError, match="no motions"):
        mean_speeds([], FPS, preset="emage")
