import doctest
import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.warping import (
    Region,
    affine,
    apply_affine,
    cholesky_root,
    condition_number,
    coordinate_grid,
    fit_region_affine,
    gaussian_heatmap,
    invert_affine,
    principal_root,
    region_heatmap,
    region_of_heatmap,
    region_of_points,
)

ROOTS = (cholesky_root, principal_root)


def normal(*shape, seed=0):
    generator = torch.Generator().manual_seed(seed)
    return torch.randn(shape, generator=generator, dtype=torch.float64)


def ellipse(length, width, turn):
    """A covariance with these two spreads, its long axis at `turn` radians."""
    c, s = math.cos(turn), math.sin(turn)
    axes = torch.tensor([[c, -s], [s, c]]).double()
    return axes @ torch.diag(torch.tensor([length, width]).double().square()) @ axes.T


def test_the_docstring_shows_what_is_so():
    assert doctest.testmod(affine).failed == 0


def test_the_inverse_leads_back():
    maps, points = normal(4, 3, 2), normal(4, 9, 2, seed=1)
    there = apply_affine(maps, points)
    torch.testing.assert_close(apply_affine(invert_affine(maps), there), points)


def test_points_are_summed_up_by_their_mean_and_covariance():
    points = normal(3, 50, 2)
    region = region_of_points(points)
    torch.testing.assert_close(region.mean, points.mean(1))
    torch.testing.assert_close(region.covariance[1], torch.cov(points[1].T, correction=0))


def test_a_heatmap_is_summed_up_by_the_bump_that_drew_it():
    keypoint = torch.tensor([[0.1, -0.2]]).double()
    heat = gaussian_heatmap(keypoint, 64, 48, variance=0.02)
    region = region_of_heatmap(7 * heat)
    torch.testing.assert_close(region.mean, keypoint, atol=1e-6, rtol=0)
    torch.testing.assert_close(
        region.covariance[0], 0.02 * torch.eye(2).double(), atol=1e-4, rtol=0
    )


def test_a_regions_heatmap_has_its_mean_and_covariance():
    region = Region(torch.tensor([0.1, -0.1]).double(), ellipse(0.2, 0.08, 0.6))
    found = region_of_heatmap(region_heatmap(region, 90, 80))
    torch.testing.assert_close(found.mean, region.mean, atol=1e-4, rtol=0)
    torch.testing.assert_close(found.covariance, region.covariance, atol=1e-4, rtol=0)


@pytest.mark.parametrize("root", ROOTS)
def test_a_root_squares_to_its_covariance(root):
    x = normal(5, 2, 2)
    covariance = x @ x.mT
    R = root(covariance)
    torch.testing.assert_close(R @ R.mT, covariance)


def test_the_first_principal_axis_points_along_the_region():
    long_axis = principal_root(ellipse(0.5, 0.1, 0.7))[:, 0]
    assert long_axis.norm().item() == pytest.approx(0.5)
    assert math.atan(long_axis[1] / long_axis[0]) == pytest.approx(0.7)


@pytest.mark.parametrize("root", ROOTS)
def test_the_map_takes_mean_and_covariance_to_those_of_the_source(root):
    points = normal(6, 30, 2)
    driving, source = region_of_points(points), region_of_points(normal(6, 30, 2, seed=1))
    moved = region_of_points(apply_affine(fit_region_affine(driving, source, root=root), points))
    torch.testing.assert_close(moved.mean, source.mean)
    torch.testing.assert_close(moved.covariance, source.covariance)


def test_regions_broadcast():
    driving, source = region_of_points(normal(4, 9, 2)), region_of_points(normal(9, 2, seed=1))
    maps = fit_region_affine(driving, source)
    alone = fit_region_affine(Region(driving.mean[2], driving.covariance[2]), source)
    torch.testing.assert_close(maps[2], alone)
    assert fit_region_affine(source, driving).shape == (4, 3, 2)


def test_the_map_cannot_see_a_rotation_of_a_round_region():
    """Two covariances know nothing of the angle between them: five points do."""
    points = torch.tensor([[0.3, 0], [0, 0.3], [-0.3, 0], [0, -0.3]]).double()
    turned = points @ torch.tensor([[0.8, 0.6], [-0.6, 0.8]]).double()
    found = fit_region_affine(region_of_points(points), region_of_points(turned))
    torch.testing.assert_close(found[1:], torch.eye(2).double())


@given(st.floats(0.05, 0.5), st.floats(1, 100), st.floats(-3, 3))
def test_the_condition_number_is_the_square_of_length_over_width(length, slimness, turn):
    found = condition_number(ellipse(length, length / slimness, turn)).item()
    assert found == pytest.approx(slimness**2, rel=1e-6)


@pytest.mark.parametrize("width", [0.1, 0.01, 0.001])
def test_the_error_of_the_map_grows_as_the_region_gets_thin_and_the_floor_bounds_it(width):
    """The same small error of a covariance, ever thinner regions."""
    still = torch.zeros(2).double()
    error = torch.diag(torch.tensor([0.0, 1e-3]).double())
    true = Region(still, ellipse(0.3, width, 0.0))
    predicted = Region(still, true.covariance + error)
    stretch = fit_region_affine(true, predicted)[2, 1].item()
    assert stretch == pytest.approx((1 + 1e-3 / width**2) ** 0.5)
    assert fit_region_affine(true, predicted, floor=0.05)[2, 1] < 1.2


def test_a_thin_region_draws_a_needle_and_the_floor_makes_it_a_bump():
    region = Region(torch.zeros(2).double(), ellipse(0.3, 1e-3, 0.0))
    assert region_heatmap(region, 32, 32).max() < 1e-6  # between two rows of pixels
    assert region_heatmap(region, 32, 32, floor=0.05).max() > 0.8


def test_gradients_reach_the_points():
    points = normal(7, 2).requires_grad_()
    source = Region(torch.ones(2).double(), ellipse(0.3, 0.1, 0.4))

    def motion(points):
        region = region_of_points(points)
        return fit_region_affine(region, source), region_heatmap(region, 3, 4)

    assert torch.autograd.gradcheck(motion, points)


def test_with_a_floor_a_collapsed_region_has_finite_maps_and_gradients():
    points = torch.zeros(5, 2).requires_grad_()
    source = Region(torch.ones(2), 0.1 * torch.eye(2))
    found = fit_region_affine(region_of_points(points), source, floor=0.02)
    found.square().sum().backward()
    assert found.isfinite().all()
    assert points.grad.isfinite().all()


@pytest.mark.parametrize("function", [fit_region_affine, region_heatmap])
def test_a_region_thin_as_a_line_is_refused_by_its_batch_index(function):
    covariances = torch.stack([torch.eye(2), torch.tensor([[1.0, 1.0], [1.0, 1.0]])])
    region = Region(torch.zeros(2, 2), covariances)
    others = (region,) if function is fit_region_affine else (4, 4)
    with pytest.raises(ValueError, match=r"batch index \[1\] is not positive definite"):
        function(region, *others)


def test_a_negative_floor_is_refused():
    region = Region(torch.zeros(2), torch.eye(2))
    with pytest.raises(ValueError, match="floor must not be negative"):
        fit_region_affine(region, region, floor=-0.1)


def test_shapes_hold_on_the_meta_device():
    with torch.device("meta"):
        region = region_of_heatmap(torch.empty(8, 10, 64, 64))
        assert fit_region_affine(region, region, floor=0.02).shape == (8, 10, 3, 2)
        assert region_heatmap(region, 16, 12).shape == (8, 10, 16, 12)


def test_a_grid_point_has_no_area():
    """One hot pixel is a collapsed region: its condition number is not a number."""
    heat = torch.zeros(9, 9)
    heat[2, 3] = 1
    region = region_of_heatmap(heat)
    torch.testing.assert_close(region.mean, coordinate_grid(9, 9)[2, 3])
    assert not condition_number(region.covariance).isfinite()
