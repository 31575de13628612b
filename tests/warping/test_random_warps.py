import pytest
import torch

from s2glib.warping import (
    apply_affine,
    apply_tps,
    coordinate_grid,
    gaussian_heatmap,
    invert_affine,
    random_affine,
    random_tps,
    region_of_heatmap,
    tps_grid,
    undo_tps,
    warp_image,
)


def test_affine_maps_scatter_around_the_identity_by_sigma(generator):
    drawn = random_affine(4000, sigma=0.05, generator=generator)
    identity = torch.tensor([[0.0, 0], [1, 0], [0, 1]])
    torch.testing.assert_close(drawn.mean(0), identity, rtol=0, atol=0.004)
    torch.testing.assert_close(drawn.std(0), torch.full((3, 2), 0.05), rtol=0.05, atol=0)


def test_splines_bend_x_and_y_alike_on_a_square_grid(generator):
    warp = random_tps(2000, generator=generator)
    assert torch.equal(warp.centers[7].view(5, 5, 2), coordinate_grid(5, 5))
    assert torch.equal(warp.weights[..., 0], warp.weights[..., 1])
    assert warp.weights.std().item() == pytest.approx(0.005, rel=0.05)
    assert warp.affine.std(0).mean().item() == pytest.approx(0.05, rel=0.05)


def test_without_any_sigma_nothing_moves(generator):
    still = random_tps(1, sigma_affine=0, sigma_weights=0, generator=generator)
    grid = coordinate_grid(6, 5)
    torch.testing.assert_close(tps_grid(still, 6, 5)[0], grid)


def test_the_same_generator_draws_the_same_in_any_type(generator):
    first = random_tps(3, generator=generator)
    again = random_tps(3, generator=generator.manual_seed(0), dtype=torch.float64)
    assert all(part.dtype == torch.float64 for part in again)
    for a, b in zip(first, again, strict=True):
        torch.testing.assert_close(a.double(), b, rtol=1e-6, atol=1e-6)


def test_draws_move_to_the_device_that_is_asked_for():
    assert random_tps(2, device="meta").affine.device.type == "meta"
    assert tps_grid(random_tps(2, device="meta"), 8, 9).shape == (2, 8, 9, 2)


def test_a_warp_can_be_undone(generator):
    warp = random_tps(20, generator=generator, dtype=torch.float64)
    points = coordinate_grid(5, 5, dtype=torch.float64).flatten(0, 1)
    torch.testing.assert_close(apply_tps(warp, undo_tps(warp, points)), points.expand(20, 25, 2))


def test_undoing_an_affine_warp_is_its_inverse(generator):
    warp = random_tps(9, sigma_weights=0, generator=generator, dtype=torch.float64)
    points = torch.rand(9, 4, 2, generator=generator).double()
    wanted = apply_affine(invert_affine(warp.affine), points)
    torch.testing.assert_close(undo_tps(warp, points), wanted)


def test_a_warped_image_shows_a_keypoint_where_the_warp_says(generator):
    """Equivariance of a perfect detector: the middle of a bump  [MDD B7]."""
    keypoint = torch.tensor([[0.2, -0.3]])
    image = gaussian_heatmap(keypoint, 96, 96, variance=0.003)[None]  # (1, 1, 96, 96)
    warp = random_tps(8, generator=generator)
    warped = warp_image(image.expand(8, 1, 96, 96), tps_grid(warp, 96, 96), padding="reflection")
    found = region_of_heatmap(warped).mean  # (8, 1, 2)
    assert (found - keypoint).norm(dim=-1).mean() > 0.03  # it did move
    assert (apply_tps(warp, found) - keypoint).norm(dim=-1).max() < 0.01
