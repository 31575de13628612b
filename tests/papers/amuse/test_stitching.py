import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.papers.amuse import agreeing, blend, cut, mend_joins, window_starts

counts = st.integers(1, 6)
shapes = st.tuples(st.integers(2, 30), st.integers(0, 15)).filter(lambda s: 2 * s[1] <= s[0])


@given(st.integers(1, 500), shapes)
def test_windows_cover_every_frame_and_start_a_hop_apart(frames, shape):
    window, overlap = shape
    starts = window_starts(frames, window, overlap)
    assert starts[0] == 0
    assert set(torch.tensor(starts).diff().tolist()) <= {window - overlap}
    assert starts[-1] + window >= frames
    assert len(starts) == 1 or starts[-2] + window < frames  # and none is superfluous


@given(counts, shapes, st.integers(0, 99))
def test_cutting_a_blend_gives_windows_that_agree_back(count, shape, seed):
    window, overlap = shape
    length = (count - 1) * (window - overlap) + window
    track = torch.randn(length, 3, generator=torch.Generator().manual_seed(seed))
    windows = cut(track, window, overlap)
    assert windows.shape == (count, window, 3)
    torch.testing.assert_close(blend(windows, overlap), track)
    torch.testing.assert_close(cut(blend(windows, overlap), window, overlap), windows)


@given(counts, shapes)
def test_the_weights_of_a_blend_sum_to_one(count, shape):
    window, overlap = shape
    blended = blend(torch.ones(count, window, 2), overlap)
    torch.testing.assert_close(blended, torch.ones_like(blended))


def test_an_overlap_fades_straight_from_one_window_to_the_next():
    windows = torch.stack([torch.zeros(20, 1), torch.ones(20, 1)])
    track = blend(windows, 10)[:, 0]
    assert (track[:10] == 0).all()
    assert (track[20:] == 1).all()
    torch.testing.assert_close(track[9:21].diff(), torch.tensor([0.05] + [0.1] * 9 + [0.05]))


def test_a_single_window_is_denoised_as_it_is(prior, denoiser):
    together = agreeing(lambda xt, t: xt + t, prior, denoiser, overlap=10)
    assert torch.equal(together(torch.ones(1, 5, 6), 2), torch.full((1, 5, 6), 3.0))


def test_windows_that_were_made_to_agree_are_latents_of_one_track(prior, denoiser):
    denoiser.latent_mean.normal_()
    x0 = torch.randn(3, 5, 6)
    agreed = agreeing(lambda xt, t: x0, prior, denoiser, overlap=10)(x0, 0)
    with torch.no_grad():
        track = blend(prior.decode(denoiser.restore(x0)), 10)
        windows = [track[start : start + 40] for start in (0, 30, 60)]
        expected = denoiser.standardize(prior.encode(torch.stack(windows)).mean)
    torch.testing.assert_close(agreed, expected, rtol=1e-4, atol=1e-4)


def test_without_an_overlap_windows_stand_side_by_side():
    windows = torch.randn(3, 8, 2)
    assert torch.equal(blend(windows, 0), windows.flatten(0, 1))
    assert window_starts(24, 8, 0) == [0, 8, 16]


@pytest.mark.parametrize(("frames", "expected"), [(120, [0]), (121, [0, 90]), (211, [0, 90, 180])])
def test_four_second_windows_share_one_second(frames, expected):
    assert window_starts(frames, 120, 30) == expected


def test_joins_are_smoothed_and_nothing_else():
    windows = torch.randn(2, 12, 3)
    mended = mend_joins(windows, 4)
    changed = (mended != windows).any(dim=2).any(dim=0)
    assert changed.nonzero().flatten().tolist() == [3, 4, 7, 8]
    expected = (windows[:, 2] + 2 * windows[:, 3] + windows[:, 4]) / 4
    torch.testing.assert_close(mended[:, 3], expected)


def test_a_straight_line_needs_no_mending():
    line = torch.arange(12.0)[None, :, None].expand(1, 12, 2)
    torch.testing.assert_close(mend_joins(line, 4), line)


@pytest.mark.parametrize("at_once", [1, 2, 4])
def test_windows_agree_across_the_borders_of_what_a_network_sees(
    prior, denoiser, monkeypatch, at_once
):
    x0 = torch.randn(5, 5, 6)
    together = agreeing(lambda xt, t: xt, prior, denoiser, overlap=10)
    whole = together(x0, 0)
    monkeypatch.setattr("s2glib.papers.amuse.stitching.AT_ONCE", at_once)
    torch.testing.assert_close(together(x0, 0), whole, rtol=1e-4, atol=1e-4)
