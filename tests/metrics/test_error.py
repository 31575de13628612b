import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.metrics import (
    landmark_velocity_difference,
    mean_absolute_error,
    mean_joint_error,
    mean_squared_error,
)

ERRORS = [
    mean_absolute_error,
    mean_joint_error,
    mean_squared_error,
    landmark_velocity_difference,
]
seeds = st.integers(0, 2**32 - 1)


@pytest.mark.parametrize("error", ERRORS)
@settings(deadline=None, max_examples=15)
@given(seeds)
def test_errors_are_symmetric_and_zero_only_for_equal_motion(error, seed):
    a, b = np.random.default_rng(seed).normal(size=(2, 6, 4, 3))
    assert error(a, a) == 0
    assert error(a, b) == pytest.approx(error(b, a))
    assert error(a, b) > 0


def test_errors_agree_with_scikit_learn(rng):
    from sklearn import metrics

    a, b = rng.normal(size=(2, 30, 8))
    assert mean_absolute_error(a, b) == pytest.approx(metrics.mean_absolute_error(a, b))
    assert mean_squared_error(a, b) == pytest.approx(metrics.mean_squared_error(a, b))


def test_joint_error_is_summed_over_joints_and_averaged_over_frames(rng):
    a, b = rng.normal(size=(2, 5, 4, 3))
    loop = sum(np.sqrt(((a[t, j] - b[t, j]) ** 2).sum()) for t in range(5) for j in range(4)) / 5
    assert mean_joint_error(a, b) == pytest.approx(loop)
    twice = mean_joint_error(np.concatenate([a, a], axis=1), np.concatenate([b, b], axis=1))
    assert twice == pytest.approx(2 * loop)


def test_samples_are_averaged_over(rng):
    a, b = rng.normal(size=(2, 3, 5, 4, 3))
    for error in ERRORS:
        assert error(a, b) == pytest.approx(
            np.mean([error(x, y) for x, y in zip(a, b, strict=True)])
        )


def test_probtalks_velocity_difference_is_blind_to_direction_and_emages_is_not(rng):
    motion = rng.normal(size=(9, 4, 3))
    mirrored = motion * [-1, 1, 1]
    assert landmark_velocity_difference(mirrored, motion) == pytest.approx(0, abs=1e-12)
    assert landmark_velocity_difference(mirrored, motion, variant="emage") > 0.1


def test_the_printed_velocity_difference_is_a_position_error(rng):
    motion = rng.normal(size=(9, 4, 3))
    offset = motion + 0.5
    assert landmark_velocity_difference(offset, motion) == pytest.approx(0, abs=1e-12)
    assert landmark_velocity_difference(offset, motion, variant="emage") < 1e-12
    assert landmark_velocity_difference(offset, motion, variant="emage-printed") == 0.5
    offset[0] += 7.0  # its first frame is never looked at
    assert landmark_velocity_difference(offset, motion, variant="emage-printed") == 0.5


def test_velocity_differences_agree_with_the_loops(rng):
    a, b = rng.normal(size=(2, 5, 2, 3))
    speeds = vectors = 0.0
    for t in range(4):
        for j in range(2):
            va, vb = a[t + 1, j] - a[t, j], b[t + 1, j] - b[t, j]
            speeds += abs(np.sqrt((va**2).sum()) - np.sqrt((vb**2).sum())) / 4
            vectors += np.abs(va - vb).sum() / (4 * 2 * 3)
    assert landmark_velocity_difference(a, b) == pytest.approx(speeds)
    assert landmark_velocity_difference(a, b, variant="emage") == pytest.approx(vectors)


@pytest.mark.parametrize("error", ERRORS)
@pytest.mark.parametrize(
    ("predicted", "kind", "says"),
    [
        (np.zeros((4, 2, 3)), ValueError, "same shape"),
        (np.full((5, 2, 3), np.nan), ValueError, "NaN"),
        (np.zeros((0, 2, 3)), ValueError, "at least|empty"),
        (np.zeros(3), ValueError, "axes"),
        (None, TypeError, "numpy array"),
    ],
)
def test_unusable_motion_is_refused_in_one_sentence(unhooked, error, predicted, kind, says):
    with pytest.raises(kind, match=says):
        error(predicted, np.zeros((5, 2, 3)))


def test_a_velocity_needs_two_frames_and_a_known_variant(unhooked):
    with pytest.raises(ValueError, match="at least 2 frames"):
        landmark_velocity_difference(np.zeros((1, 2, 3)), np.zeros((1, 2, 3)))
    with pytest.raises(ValueError, match="no variant"):
        landmark_velocity_difference(np.zeros((2, 2, 3)), np.zeros((2, 2, 3)), variant="x")
