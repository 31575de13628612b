import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.metrics import acceleration, derivative_sizes, jerk


def test_jerk_of_a_cubic_is_its_third_derivative():
    t = np.arange(40) / 30
    path = np.stack([2 * t**3, t**2, 0 * t], axis=-1)[:, None]
    assert jerk(path, 30) == pytest.approx(12)
    assert acceleration(path[:, :, 1:], 30) == pytest.approx(2)
    assert derivative_sizes(path[:, :, 2:] + t[:, None, None], 30, order=1) == pytest.approx(1)


def test_a_ten_centimetre_sine_has_the_jerk_that_exposes_the_printed_figures():
    t = np.arange(300) / 30
    sine = 0.1 * np.sin(2 * np.pi * t)[:, None, None] * np.array([1.0, 0, 0])
    assert jerk(sine, 30) == pytest.approx(15.6, abs=0.05)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1))
def test_constant_acceleration_has_no_jerk(seed):
    start, velocity, pull = np.random.default_rng(seed).normal(size=(3, 1, 2, 3))
    t = np.arange(12)[:, None, None] / 30
    assert jerk(start + velocity * t + pull * t**2, 30) < 1e-8


def test_the_same_motion_at_twice_the_rate_has_the_same_acceleration():
    coarse, fine = (
        acceleration(np.cos(np.arange(0, 6, step))[:, None, None] * np.ones(3), 1 / step)
        for step in (0.02, 0.01)
    )
    assert coarse == pytest.approx(fine, rel=1e-2)


def test_too_few_frames_are_refused():
    with pytest.raises(ValueError, match="at least 4 frames, got 3"):
        jerk(np.zeros((3, 2, 3)), 30)
    with pytest.raises(ValueError, match="at least 3 frames, got 2"):
        acceleration(np.zeros((2, 2, 3)), 30)


@pytest.mark.parametrize(
    ("positions", "fps", "says"),
    [
        (np.full((5, 2, 3), np.nan), 30, "NaN"),
        (np.zeros((5, 0, 3)), 30, "empty"),
        (np.zeros((5, 6)), 30, "axes"),
        (np.zeros((5, 2, 3)), 0, "fps must be a positive"),
        (np.zeros((5, 2, 3)), np.nan, "fps must be a positive"),
    ],
)
def test_jerk_refuses_what_has_no_derivative(unhooked, positions, fps, says):
    with pytest.raises(ValueError, match=says):
        jerk(positions, fps)


def test_a_derivative_of_order_zero_is_refused():
    with pytest.raises(ValueError, match="order"):
        derivative_sizes(np.zeros((5, 2, 3)), 30, order=0)
