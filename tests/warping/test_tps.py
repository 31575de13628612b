import math

import numpy as np
import pytest
import torch
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.interpolate import RBFInterpolator
from skimage.transform import ThinPlateSplineTransform

from s2glib.warping import (
    apply_affine,
    apply_tps,
    bending_energy,
    coordinate_grid,
    fit_tps,
    radial_basis,
    tps_grid,
)

CLOSE = {"rtol": 1e-8, "atol": 1e-8}


def uniform(*shape, seed=0, dtype=torch.float64):
    return 2 * torch.rand(shape, generator=torch.Generator().manual_seed(seed), dtype=dtype) - 1


def points(low=-1.0, high=1.0, least=3):
    """Control points of any number, between two bounds if there are any, always finite."""
    shape = st.tuples(st.integers(least, 7), st.just(2))
    finite = st.floats(low, high, width=32, allow_nan=False, allow_infinity=False)
    return arrays(np.float64, shape, elements=finite).map(torch.from_numpy)


def well_spread(control):
    """Whether no two points are close and no line is near them all."""
    gaps = torch.cdist(control, control) + 9 * torch.eye(len(control))
    return gaps.min() > 0.1 and torch.linalg.svdvals(control - control.mean(0))[1] > 0.2


spread_points = points().filter(well_spread)


@given(spread_points, st.integers(0, 99))
def test_the_spline_takes_every_driving_keypoint_to_its_source(driving, seed):
    source = uniform(*driving.shape, seed=seed)
    moved = apply_tps(fit_tps(driving, source), driving)
    torch.testing.assert_close(moved, source, **CLOSE)


@given(spread_points, arrays(np.float64, (3, 2), elements=st.floats(-2, 2)))
def test_an_affine_pair_gives_that_map_and_no_bending(driving, affine):
    wanted = torch.from_numpy(affine)
    spline = fit_tps(driving, apply_affine(wanted, driving))
    torch.testing.assert_close(spline.affine, wanted, rtol=1e-7, atol=1e-7)
    torch.testing.assert_close(spline.weights, torch.zeros_like(driving), rtol=0, atol=1e-7)
    assert abs(bending_energy(spline)) < 1e-10


@given(spread_points, st.floats(-3, 3), st.floats(0.3, 3), st.booleans())
def test_turning_scaling_or_mirroring_the_driving_image_changes_nothing(driving, turn, size, flip):
    """A spline of A p + b, asked at A p + b, answers as before: distances scale alike."""
    source, queries = uniform(*driving.shape), uniform(20, 2, seed=1)
    c, s = size * math.cos(turn), size * math.sin(turn)
    move = torch.tensor([[0.3, -0.2], [c, s], [s, -c] if flip else [-s, c]]).double()
    before = apply_tps(fit_tps(driving, source), queries)
    after = apply_tps(fit_tps(apply_affine(move, driving), source), apply_affine(move, queries))
    torch.testing.assert_close(after, before, rtol=1e-6, atol=1e-6)


@given(spread_points)
def test_forward_undoes_backward_at_the_keypoints(driving):
    source = driving + 0.1 * uniform(*driving.shape)
    assume(well_spread(source))
    backward, forward = fit_tps(driving, source), fit_tps(source, driving)
    there_and_back = apply_tps(forward, apply_tps(backward, driving))
    torch.testing.assert_close(there_and_back, driving, **CLOSE)


def test_between_the_keypoints_forward_is_not_the_inverse_of_backward():
    driving = uniform(5, 2)
    source = driving + 0.3 * uniform(5, 2, seed=1)
    queries = uniform(50, 2, seed=2)
    backward, forward = fit_tps(driving, source), fit_tps(source, driving)
    assert (apply_tps(forward, apply_tps(backward, queries)) - queries).norm(dim=-1).max() > 0.01


def test_it_is_scipys_thin_plate_spline():
    driving, source, queries = uniform(9, 2), uniform(9, 2, seed=1), 2 * uniform(200, 2, seed=2)
    peer = RBFInterpolator(driving, source, kernel="thin_plate_spline", degree=1)
    ours = apply_tps(fit_tps(driving, source), queries)
    np.testing.assert_allclose(ours, peer(queries), rtol=1e-9, atol=1e-11)


def test_it_is_skimages_thin_plate_spline():
    driving, source, queries = uniform(9, 2), uniform(9, 2, seed=1), uniform(200, 2, seed=2)
    peer = ThinPlateSplineTransform.from_estimate(driving.numpy(), source.numpy())
    ours = apply_tps(fit_tps(driving, source), queries)
    np.testing.assert_allclose(ours, peer(queries.numpy()), rtol=1e-6, atol=1e-6)


def released(driving, source, queries, ridge=0.01):
    """[MDD A5] as the authors' code computes it: columns x, y, 1, and log(r^2 + 1e-9)."""
    ones, n = torch.ones(len(driving), 1, dtype=driving.dtype), len(driving)

    def basis(a, b):
        squared = torch.cdist(a, b, compute_mode="donot_use_mm_for_euclid_dist") ** 2
        return squared * torch.log(squared + 1e-9)

    P = torch.cat([driving, ones], dim=1)
    L = torch.block_diag(basis(driving, driving), torch.zeros(3, 3, dtype=driving.dtype))
    L[:n, n:], L[n:, :n] = P, P.T
    Y = torch.cat([source, torch.zeros(3, 2, dtype=driving.dtype)])
    weights, A = (torch.inverse(L + ridge * torch.eye(n + 3)) @ Y).split([n, 3])
    return basis(queries, driving) @ weights + queries @ A[:2] + A[2]


@pytest.mark.parametrize("ridge", [0.0, 0.01, 0.3])
def test_with_a_ridge_it_is_the_released_code(ridge):
    driving, source, queries = uniform(5, 2), uniform(5, 2, seed=1), uniform(99, 2, seed=2)
    ours = apply_tps(fit_tps(driving, source, ridge=ridge), queries)
    theirs = released(driving, source, queries, ridge)
    torch.testing.assert_close(ours, theirs, rtol=1e-6, atol=1e-6)


def test_the_released_ridge_misses_the_keypoints():
    driving, source = uniform(200, 5, 2), uniform(200, 5, 2, seed=1)
    missed = (apply_tps(fit_tps(driving, source, ridge=0.01), driving) - source).norm(dim=-1)
    assert 0.001 < missed.median() < 0.1
    assert missed.max() > 0.1


def test_the_weights_neither_push_nor_tilt_the_plate():
    spline = fit_tps(uniform(4, 7, 2), uniform(4, 7, 2, seed=1))
    push, tilt = spline.weights.sum(-2), spline.centers.mT @ spline.weights
    torch.testing.assert_close(push, torch.zeros(4, 2).double(), rtol=0, atol=1e-12)
    torch.testing.assert_close(tilt, torch.zeros(4, 2, 2).double(), rtol=0, atol=1e-12)


def laplacian(values, h):
    """Fourth-order finite differences of a square patch."""
    kernel = torch.tensor([-1, 16, -30, 16, -1]).double() / (12 * h * h)
    rows, columns = values.unfold(0, 5, 1), values.unfold(1, 5, 1)
    return (rows @ kernel)[:, 2:-2] + (columns @ kernel)[2:-2]


def test_off_the_control_points_the_bi_laplacian_vanishes():
    """[MDD A3]: the plate is not loaded there; a plain r^2 would have none of this."""
    spline = fit_tps(uniform(6, 2), uniform(6, 2, seed=1))
    h, away = 0.02, torch.tensor([2.0, 1.5]).double()
    patch = away + h * torch.cartesian_prod(*[torch.arange(-4.0, 5.0).double()] * 2)
    values = apply_tps(spline, patch)[:, 0].view(9, 9)
    second = laplacian(values, h)
    assert second.abs().max() > 0.01  # it does bend
    assert laplacian(second, h).abs().max() < 1e-4


@pytest.mark.parametrize("radius", [0.1, 1.0, 3.0])
def test_the_bi_laplacian_of_u_is_16_pi_deltas(radius):
    """[MDD A3-A4]: by the divergence theorem the slope of the Laplacian around a circle."""
    r = torch.tensor(radius).double().requires_grad_()

    def u(r):
        return radial_basis(r.square())

    (slope,) = torch.autograd.grad(u(r), r, create_graph=True)
    (bend,) = torch.autograd.grad(slope, r, create_graph=True)
    (steeper,) = torch.autograd.grad(bend + slope / r, r)  # d/dr of the Laplacian
    assert (2 * math.pi * r * steeper).item() == pytest.approx(16 * math.pi)


def test_the_bending_energy_is_the_integral_over_the_plane():
    """[MDD A1] summed over a plane mapped to a square by x = sinh(u)."""
    spline = fit_tps(uniform(5, 2), uniform(5, 2, seed=1))
    u = torch.linspace(-6, 6, 1201, dtype=torch.float64)
    x, stretch = u.sinh(), u.cosh()
    grid = torch.stack(torch.meshgrid(x, x, indexing="xy"), dim=-1)
    away = grid[..., None, :] - spline.centers
    dx, dy = away.unbind(-1)
    s = dx * dx + dy * dy
    log = 2 * s.log() + 2
    second = (log + 4 * dx * dx / s, 4 * dx * dy / s, log + 4 * dy * dy / s)
    xx, xy, yy = (part @ spline.weights for part in second)
    density = (xx.square() + 2 * xy.square() + yy.square()).sum(-1)
    integral = (density * stretch * stretch[:, None]).sum() * (u[1] - u[0]) ** 2
    assert bending_energy(spline).item() == pytest.approx(integral.item(), rel=0.01)


@given(st.integers(0, 99))
def test_every_other_interpolating_spline_bends_more(seed):
    """More control points that lie on another surface through the same keypoints."""
    driving, source = uniform(4, 2, seed=seed), uniform(4, 2, seed=seed + 1)
    extra = uniform(3, 2, seed=seed + 2)
    assume(well_spread(torch.cat([driving, extra])) and well_spread(driving))
    least = fit_tps(driving, source)
    moved = apply_tps(least, extra) + 0.1 * uniform(3, 2, seed=seed + 3)
    other = fit_tps(torch.cat([driving, extra]), torch.cat([source, moved]))
    assert bending_energy(other) > bending_energy(least)


@pytest.mark.parametrize("ridge", [0.0, 0.01])
def test_gradients_reach_keypoints_and_queries_even_on_a_control_point(ridge):
    driving, source = uniform(2, 5, 2).requires_grad_(), uniform(2, 5, 2, seed=1).requires_grad_()
    queries = torch.cat([driving.detach()[0, :2], uniform(3, 2, seed=2)]).requires_grad_()

    def warp(driving, source, queries):
        return apply_tps(fit_tps(driving, source, ridge=ridge), queries)

    assert torch.autograd.gradcheck(warp, (driving, source, queries))


def test_the_gradient_of_the_bending_energy_is_right():
    pair = uniform(5, 2).requires_grad_(), uniform(5, 2, seed=1).requires_grad_()
    assert torch.autograd.gradcheck(lambda d, s: bending_energy(fit_tps(d, s)), pair)


def value_and_gradient(driving, source, ridge):
    driving, source = driving.clone().requires_grad_(), source.clone().requires_grad_()
    spline = fit_tps(driving, source, ridge=ridge)
    moved = apply_tps(spline, torch.cat([driving.detach(), uniform(3, 2).to(driving)]))
    moved.sum().backward()
    return torch.cat([moved.detach().flatten(), driving.grad.flatten(), source.grad.flatten()])


@given(points(None, None, least=1), st.sampled_from([1e-6, 0.01, 1.0, 2.0]), st.booleans())
def test_with_a_ridge_any_points_give_finite_values_and_gradients(driving, ridge, single):
    driving = driving.float() if single else driving
    assert value_and_gradient(driving, driving.flip(0), ridge).isfinite().all()


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
@pytest.mark.parametrize(
    "driving",
    [[[0.0, 0]] * 5, [[0.0, 0]], [[0.1, 0.2], [0.3, 0.4]], [[-0.5, -0.5], [0, 0], [0.5, 0.5]]],
    ids=["one place", "one point", "two points", "one line"],
)
def test_with_a_ridge_degenerate_points_give_finite_values_and_gradients(driving, dtype):
    driving = torch.tensor(driving, dtype=dtype)
    for ridge in (1e-9, 0.01, 1, len(driving) ** 0.5):  # the last makes L + ridge singular
        assert value_and_gradient(driving, driving + 1, ridge).isfinite().all()


def test_a_ridge_that_meets_an_eigenvalue_stays_finite():
    driving = uniform(5, 2)
    ones = torch.ones(5, 1).double()
    K, P = radial_basis(torch.cdist(driving, driving) ** 2), torch.cat([ones, driving], dim=1)
    L = torch.cat([torch.cat([K, P], 1), torch.cat([P.T, torch.zeros(3, 3).double()], 1)])
    for eigenvalue in torch.linalg.eigvalsh(L):
        if eigenvalue < 0:
            found = value_and_gradient(driving, uniform(5, 2, seed=1), -eigenvalue.item())
            assert found.isfinite().all()


@pytest.mark.parametrize("ridge", [0.0, 0.01])
def test_leading_axes_broadcast_and_splines_are_fitted_one_by_one(ridge):
    driving, source, queries = uniform(4, 5, 2), uniform(3, 1, 5, 2, seed=1), uniform(4, 9, 2)
    spline = fit_tps(driving, source, ridge=ridge)
    assert [part.shape for part in spline] == [(3, 4, 5, 2), (3, 4, 5, 2), (3, 4, 3, 2)]
    moved, energy = apply_tps(spline, queries), bending_energy(spline)
    for b in range(3):
        for k in range(4):
            one = fit_tps(driving[k], source[b, 0], ridge=ridge)
            torch.testing.assert_close(moved[b, k], apply_tps(one, queries[k]))
            torch.testing.assert_close(energy[b, k], bending_energy(one))


@pytest.mark.parametrize("dtype", [torch.float16, torch.bfloat16, torch.float32, torch.float64])
def test_the_dtype_is_kept(dtype):
    driving, source = uniform(5, 2, dtype=torch.float64).to(dtype), uniform(5, 2, seed=1).to(dtype)
    spline = fit_tps(driving, source)
    kinds = {*(part.dtype for part in spline), apply_tps(spline, driving).dtype}
    assert kinds | {bending_energy(spline).dtype} == {dtype}
    error = (apply_tps(spline, driving) - source).abs().max()
    assert error < 60 * torch.finfo(dtype).eps


def test_the_paper_size_has_its_shapes_on_the_meta_device():
    keypoints = torch.empty(8, 20, 5, 2, device="meta")
    for ridge in (0.0, 0.01):
        spline = fit_tps(keypoints, keypoints, ridge=ridge)
        assert spline.affine.shape == (8, 20, 3, 2)
        assert tps_grid(spline, 64, 48).shape == (8, 20, 64, 48, 2)
        assert bending_energy(spline).shape == (8, 20)


def test_the_dense_grid_is_the_spline_at_every_pixel():
    spline = fit_tps(uniform(2, 5, 2), uniform(2, 5, 2, seed=1))
    places = coordinate_grid(7, 9, dtype=torch.float64).view(63, 2)
    dense = tps_grid(spline, 7, 9).view(2, 63, 2)
    torch.testing.assert_close(dense, apply_tps(spline, places), rtol=1e-13, atol=1e-13)


GOOD = uniform(5, 2)
LINE = torch.linspace(-1, 1, 5).double()[:, None] * torch.tensor([0.3, 0.7]).double() + 0.123
TWINS = torch.cat([GOOD[:4], GOOD[:1]])


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("driving", "fault"),
    [
        (GOOD[:2], "at least 3 control points, got 2"),
        (TWINS, "coincide"),
        (LINE, "lie on one line"),
        (LINE.float(), "lie on one line"),
        (torch.zeros(5, 2), "coincide"),
        (1e6 + 1e-3 * GOOD.float(), "coincide"),
        (GOOD.where(GOOD < 0.2, math.nan), "not finite"),
        (GOOD.where(GOOD < 0.2, math.inf), "not finite"),
    ],
)
def test_points_that_hold_no_plate_are_refused(driving, fault):
    with pytest.raises(ValueError, match=fault):
        fit_tps(driving, torch.ones_like(driving))


@pytest.mark.parametrize("where", [(0,), (3,), (1, 2)])
def test_the_refusal_names_the_batch_index(where):
    driving = uniform(*[4] * len(where), 5, 2)
    driving[where] = TWINS
    with pytest.raises(ValueError, match=f"batch index {', '.join(map(str, where))} coincide"):
        fit_tps(driving, driving)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_points_that_are_nearly_on_a_line_are_still_fitted(scale):
    driving = LINE * scale
    driving[2, 0] += 1e-6 * scale
    moved = apply_tps(fit_tps(driving, GOOD), driving)
    torch.testing.assert_close(moved, GOOD, rtol=1e-4, atol=1e-4)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("driving", "source", "fault"),
    [
        ([[0, 0]], GOOD, "driving must be a tensor of floating points, got list"),
        (GOOD, GOOD.long(), "source must be a tensor of floating points, got torch.int64"),
        (GOOD, GOOD.float(), "make them one type"),
    ],
)
def test_what_is_no_pair_of_float_tensors_is_refused(driving, source, fault):
    with pytest.raises(TypeError, match=fault):
        fit_tps(driving, source)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("driving", "source", "fault"),
    [
        (GOOD, GOOD[:4], "pairs of points"),
        (GOOD, torch.zeros(5, 3), r"\(\.\.\., n, 2\), got \(5, 3\)"),
        (GOOD[0], GOOD, r"\(\.\.\., n, 2\), got \(2,\)"),
        (GOOD.expand(2, 5, 2), GOOD.expand(3, 5, 2), "leading axes that broadcast"),
    ],
)
def test_shapes_that_do_not_fit_are_refused(driving, source, fault):
    with pytest.raises(ValueError, match=fault):
        fit_tps(driving, source.to(driving))


@pytest.mark.parametrize("ridge", [-0.01, math.nan, math.inf])
def test_a_ridge_that_is_none_is_refused(ridge):
    with pytest.raises(ValueError, match="ridge must be finite"):
        fit_tps(GOOD, GOOD, ridge=ridge)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("ridge", ["0.01", None, torch.tensor(0.01)])
def test_a_ridge_that_is_no_number_is_refused(ridge):
    with pytest.raises(TypeError, match="ridge must be a number"):
        fit_tps(GOOD, GOOD, ridge=ridge)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("ridge", [0.0, 0.01])
def test_a_point_that_is_not_finite_is_named_by_its_spline(value, ridge):
    driving = GOOD.repeat(3, 1, 1)
    source = driving.clone()
    source[2, 1, 0] = value
    for pair in ((driving, source), (source, driving)):
        with pytest.raises(ValueError, match="batch index 2 hold a value that is not finite"):
            fit_tps(*pair, ridge=ridge)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("points", "kind", "fault"),
    [
        ([[0.0, 0.0]], TypeError, "tensor of floating points, got list"),
        (torch.zeros(4, 2, dtype=torch.long), TypeError, "got torch.int64"),
        (torch.zeros(4, 2), TypeError, "points are torch.float32, the spline torch.float64"),
        (torch.zeros(2, dtype=torch.float64), ValueError, "points must be"),
        (torch.zeros(4, 3, dtype=torch.float64), ValueError, "points must be"),
    ],
)
def test_what_a_spline_cannot_move_is_refused(points, kind, fault):
    with pytest.raises(kind, match=fault):
        apply_tps(fit_tps(GOOD, GOOD), points)
