import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.layers import fixed_positions, sinusoidal_embedding


def slow_embedding(value, width, longest):
    """One number at a time, as the formula says."""
    frequencies = [longest ** (-2 * i / width) for i in range(width // 2)]
    return [math.sin(value * f) for f in frequencies] + [math.cos(value * f) for f in frequencies]


@given(st.integers(0, 1000), st.integers(1, 32).map(lambda half: 2 * half))
def test_an_embedding_agrees_with_the_formula(value, width):
    embedded = sinusoidal_embedding(torch.tensor(value), width)
    assert embedded.tolist() == pytest.approx(slow_embedding(value, width, 1e4), abs=2e-4)


@pytest.mark.parametrize("shape", [(), (5,), (2, 3)])
def test_leading_axes_are_kept(shape):
    values = torch.arange(math.prod(shape)).reshape(shape)
    assert sinusoidal_embedding(values, 8).shape == (*shape, 8)


def test_every_level_has_its_own_embedding():
    embedded = sinusoidal_embedding(torch.arange(1000), 256)
    gap = torch.cdist(embedded, embedded) + 10 * torch.eye(1000)
    assert gap.min() > 0.1


def test_positions_count_from_zero():
    expected = [slow_embedding(place, 12, 1e3) for place in range(20)]
    assert fixed_positions(20, 12).numpy() == pytest.approx(torch.tensor(expected), abs=1e-4)


def test_an_odd_width_is_refused():
    with pytest.raises(ValueError, match="even, got 7"):
        sinusoidal_embedding(torch.arange(3), 7)
