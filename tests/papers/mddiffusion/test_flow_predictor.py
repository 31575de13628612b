from dataclasses import replace

import pytest
import torch

from s2glib.papers.mddiffusion import PAPER_DECOUPLING, FlowPredictor, group_blobs, group_warps
from s2glib.warping import coordinate_grid

WARPS = pytest.mark.parametrize("warp", ["tps", "affine"])


@pytest.fixture
def grid():
    return coordinate_grid(16, 16)


def exact(config, warp="tps"):
    return replace(config, warp=warp, ridge=0.0)


def convolution(inputs, outputs, kernel):
    return inputs * outputs * kernel**2 + outputs


def block(inputs, outputs):
    """3 x 3 convolution and an instance norm with scale and shift."""
    return convolution(inputs, outputs, 3) + 2 * outputs


def test_the_papers_network_has_the_released_channels():
    """164 in, five steps down and up, 21 weight maps, four masks, two steps to 256 pixels."""
    with torch.device("meta"):
        predictor = FlowPredictor(PAPER_DECOUPLING)
    steps = [
        (164, 128), (128, 256), (256, 512), (512, 1024), (1024, 1024),
        (1024, 1024), (2048, 512), (1024, 256), (512, 128), (256, 64),
        (228, 114), (114, 57),
    ]  # fmt: skip
    heads = [(228, 21), (256, 1), (228, 1), (114, 1), (57, 1)]
    expected = sum(block(*s) for s in steps) + sum(convolution(*h, 7) for h in heads)
    assert sum(p.numel() for p in predictor.parameters()) == expected == 38_364_647


def test_the_papers_flow_has_the_papers_shapes():
    with torch.device("meta"):
        points = torch.zeros(2, 20, 5, 2)
        flow = FlowPredictor(PAPER_DECOUPLING)(torch.zeros(2, 3, 256, 256), points, points)
    assert flow.sampling_grid.shape == (2, 64, 64, 2)
    assert flow.contributions.shape == (2, 21, 64, 64)
    assert flow.warps.shape == (2, 21, 64, 64, 2)
    assert [tuple(m.shape) for m in flow.occlusion_masks] == [
        (2, 1, s, s) for s in (32, 64, 128, 256)
    ]


@WARPS
def test_weights_sum_to_one_and_masks_are_shares(config, images, keypoints, warp):
    predictor = FlowPredictor(replace(config, warp=warp))
    moved = keypoints + 0.1 * torch.randn_like(keypoints)
    flow = predictor(images[0], keypoints, moved)
    torch.testing.assert_close(flow.contributions.sum(1), torch.ones(2, 16, 16))
    assert [tuple(m.shape[-2:]) for m in flow.occlusion_masks] == [(8, 8), (16, 16), (32, 32)]
    assert all(((m >= 0) & (m <= 1)).all() for m in flow.occlusion_masks)
    mixture = torch.einsum("bkhw,bkhwc->bhwc", flow.contributions, flow.warps)
    torch.testing.assert_close(flow.sampling_grid, mixture)


@WARPS
def test_equal_keypoints_move_nothing(config, images, keypoints, grid, warp):
    flow = FlowPredictor(exact(config, warp))(images[0], keypoints, keypoints)
    torch.testing.assert_close(flow.warps, grid.expand_as(flow.warps), atol=1e-4, rtol=0)
    torch.testing.assert_close(flow.sampling_grid, grid.expand(2, 16, 16, 2), atol=1e-4, rtol=0)


def test_a_ridge_bends_pictures_at_rest_unless_told_to_pull_towards_no_motion(
    config, keypoints, grid
):
    close = 0.1 * keypoints
    moved = {
        rests: group_warps(close, close, grid, replace(config, ridge=0.01, rests=rests)) - grid
        for rests in (False, True)
    }
    assert moved[True].abs().max() < 1e-5
    assert moved[False].abs().max() > 0.1


def test_without_a_ridge_both_ways_to_fit_are_one(config, keypoints, grid):
    moved = keypoints + 0.1 * torch.randn_like(keypoints)
    ways = [
        group_warps(moved, keypoints, grid, replace(config, ridge=0.0, rests=rests))
        for rests in (False, True)
    ]
    torch.testing.assert_close(*ways, rtol=1e-3, atol=1e-3)


@WARPS
def test_an_untrained_network_trusts_warps_near_their_points(config, images, keypoints, warp):
    predictor = FlowPredictor(replace(config, warp=warp, nearness=50.0))
    keypoints = keypoints.clone()
    keypoints[:, 1] = 0.5 + 0.1 * keypoints[:, 1]
    shares = predictor(images[0], keypoints, keypoints).contributions[:, 2]
    assert shares[:, 11, 11].min() > 0.9
    assert shares[:, 0, 15].max() < 0.5


@WARPS
def test_a_group_that_was_elsewhere_in_the_source_is_fetched_from_there(
    config, keypoints, grid, warp
):
    """Backward flow: driving places plus the way to the source."""
    step = torch.tensor([0.2, -0.1])
    source = keypoints.clone()
    source[:, 1] += step
    warps = group_warps(keypoints, source, grid, exact(config, warp))
    torch.testing.assert_close(warps[:, 1], (grid + step).expand(2, 16, 16, 2), atol=1e-4, rtol=0)
    torch.testing.assert_close(warps[:, 0], grid.expand(2, 16, 16, 2), atol=1e-4, rtol=0)


def test_a_spline_bends_where_an_affine_map_only_shears(config, keypoints, grid):
    source = keypoints.clone()
    source[:, 0, 2] += 0.3
    bent, sheared = (
        group_warps(keypoints, source, grid, exact(config, warp))[0, 0]
        for warp in ("tps", "affine")
    )
    assert sheared.diff(n=2, dim=0).abs().max() < 1e-4
    assert bent.diff(n=2, dim=0).abs().max() > 1e-3


def test_the_network_sees_a_blob_at_each_keypoint_or_one_for_a_region(config, keypoints):
    points, regions = (
        group_blobs(keypoints, replace(config, warp=warp)) for warp in ("tps", "affine")
    )
    assert points.shape == (2, 15, 16, 16)
    assert regions.shape == (2, 3, 16, 16)
    row, column = divmod(int(regions[0, 1].argmax()), 16)
    centre = keypoints[0, 1].mean(dim=0)
    assert (torch.tensor([column, row]) / 7.5 - 1 - centre).abs().max() < 0.08


def test_dropped_warps_do_not_count_and_the_background_always_does(config, images, keypoints):
    predictor = FlowPredictor(config)
    generator = torch.Generator().manual_seed(0)
    flow = predictor(images[0], keypoints, keypoints, dropout=0.99, generator=generator)
    torch.testing.assert_close(flow.contributions[:, 0], torch.ones(2, 16, 16))
    flow = predictor(images[0], keypoints, keypoints, dropout=0.5, generator=generator)
    counts = flow.contributions.amax(dim=(2, 3)) > 0
    assert counts[:, 0].all()
    assert not counts.all()


def test_a_moving_background_follows_its_affine_map(config, images, keypoints, grid):
    background = torch.tensor([[0.1, 0.0], [1.0, 0.0], [0.2, 1.0]]).expand(2, 3, 2)
    flow = FlowPredictor(config)(images[0], keypoints, keypoints, background=background)
    x, y = grid.unbind(-1)
    expected = torch.stack([x + 0.2 * y + 0.1, y], dim=-1)
    torch.testing.assert_close(flow.warps[:, 0], expected.expand(2, 16, 16, 2))


@pytest.mark.parametrize("share", [0.5, 0.88])
def test_masks_start_as_open_as_told(config, images, keypoints, share):
    predictor = FlowPredictor(replace(config, visible_at_start=share))
    for mask in predictor.masks:
        torch.nn.init.zeros_(mask.weight)
    for mask in predictor(images[0], keypoints, keypoints).occlusion_masks:
        torch.testing.assert_close(mask, torch.full_like(mask, share))
