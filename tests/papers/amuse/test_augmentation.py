import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.papers.amuse.augmentation import gain_and_tilt, mask, shift

X = torch.randn(64, 40, 16, generator=torch.Generator().manual_seed(1))


def drawn(seed=0):
    return torch.Generator().manual_seed(seed)


@given(st.integers(0, 1000))
def test_gain_and_tilt_add_one_straight_line_over_the_octaves(seed):
    added = gain_and_tilt(X, 3.0, gain=2.0, tilt=1.0, generator=drawn(seed)) - X
    assert (added - added[:, :1]).abs().max() < 1e-5  # the same in every frame
    bends = added[:, 0].diff(n=2, dim=-1)
    assert bends.abs().max() < 1e-5


def test_a_gain_is_in_decibels_of_a_standardised_log_of_power():
    many = torch.zeros(20000, 1, 2)
    added = gain_and_tilt(many, 2.5, gain=3.0, tilt=0.0, generator=drawn())
    decibels = added[:, 0, 0] * 2 * 2.5 * 10 / math.log(10)
    assert float(decibels.std()) == pytest.approx(3.0, rel=0.03)
    assert float(decibels.mean()) == pytest.approx(0.0, abs=0.1)


def test_without_strength_nothing_changes():
    assert torch.equal(gain_and_tilt(X, 3.0, gain=0.0, tilt=0.0, generator=drawn()), X)
    assert torch.equal(shift(X, torch.ones(16), earliest=0, latest=0, generator=drawn()), X)


@given(st.integers(0, 1000))
def test_a_mask_hides_one_stretch_and_one_band(seed):
    hidden = mask(X, longest=10, widest=5, generator=drawn(seed)) == 0
    frames, bands = hidden.all(dim=2), hidden.all(dim=1)
    assert torch.equal(hidden, frames[:, :, None] | bands[:, None, :])
    assert frames.sum(dim=1).max() < 10
    assert bands.sum(dim=1).max() < 5
    for row in (*frames, *bands):
        assert (row.int().diff() == 1).sum() + row[0] <= 1  # one stretch


@given(st.integers(0, 1000))
def test_a_shift_moves_frames_and_fills_with_silence(seed):
    silence = torch.full((16,), 9.0)
    moved = shift(X, silence, earliest=6, latest=4, generator=drawn(seed))
    for before, after in zip(X, moved, strict=True):
        fits = []
        for move in range(-6, 5):
            expected = torch.full_like(before, 9.0)
            source, to = (
                slice(max(0, -move), 40 - max(0, move)),
                slice(max(0, move), 40 + min(0, move)),
            )
            expected[to] = before[source]
            fits.append(torch.equal(after, expected))
        assert sum(fits) == 1


def test_chance_comes_from_the_generator():
    for augment in (
        lambda g: gain_and_tilt(X, 3.0, gain=1.0, tilt=1.0, generator=g),
        lambda g: mask(X, longest=10, widest=5, generator=g),
        lambda g: shift(X, torch.zeros(16), earliest=6, latest=4, generator=g),
    ):
        assert torch.equal(augment(drawn(5)), augment(drawn(5)))
        assert not torch.equal(augment(drawn(5)), augment(drawn(6)))
