"""Thin-plate splines: fit a smooth warp to keypoint pairs, then apply it anywhere.

Paper:    MDD Sup. A, Eqs. A1-A5
Notebook: notebooks/02_thin_plate_splines.ipynb
"""

import math
from numbers import Real
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.warping.affine import apply_affine
from s2glib.warping.grids import check_points, coordinate_grid

FAR = 1e15  # image units from the middle; no point is taken to be farther away
BLOCK = 2**19  # distances to compute at a time; larger blocks only wait for memory
ROUNDING = 8  # roundings of the largest coordinate by which points on a line may leave it


class ThinPlateSpline(NamedTuple):
    """The map T(p) = A [1; p] + sum_i w_i U(|c_i - p|)  [MDD Eq. A2].

    Attributes:
        centers: c, the driving keypoints.
        weights: w, how strongly the plate bends at each center; no side is pushed or tilted.
        affine: A transposed, with the rows 1, x, y in the order of P's columns. The paper writes
            A [p; 1], but solves for this order  [MDD Eq. A5].
    """

    centers: Float[Tensor, "*b n 2"]
    weights: Float[Tensor, "*b n 2"]
    affine: Float[Tensor, "*b 3 2"]


def radial_basis(sq_dist: Float[Tensor, "*shape"]) -> Float[Tensor, "*shape"]:
    """U(r) = r^2 log r^2  [MDD Eq. A2], as a function of r^2; 0 with slope 0 at r = 0.

    The smallest normal number changes no other distance; it keeps log and its slope finite at 0.
    """
    return sq_dist * (sq_dist + torch.finfo(sq_dist.dtype).tiny).log()


def fit_tps(
    driving: Float[Tensor, "*#b n 2"],
    source: Float[Tensor, "*#b n 2"],
    *,
    ridge: float | int = 0.0,
) -> ThinPlateSpline:
    """Find the spline that takes each driving keypoint to its source keypoint  [MDD Eq. A5].

    Evaluated on the pixels of a driving image it says what they show of the source image: that is
    the backward flow. With the two arguments swapped it moves points of the source forward.

    Args:
        driving: control points in the driving image; leading axes broadcast.
        source: where they lie in the source image.
        ridge: added to the whole diagonal of L, as in the authors' code, which takes 0.01. Above
            zero the spline misses its points a little, but any points will do, and value and
            gradient stay finite.

    Returns:
        The spline, of the arguments' type; the system itself is solved in float64.

    Raises:
        TypeError: if the points are not tensors of one floating type, or `ridge` is no number.
        ValueError: if the shapes do not fit, a point is not finite, `ridge` is negative, or,
            without a ridge, there are fewer than three control points, two of them coincide, or
            all lie on one line. On the meta device values are not looked at.
    """
    _check_pairs(driving, source, ridge)
    driving, source = torch.broadcast_tensors(driving, source)
    if driving.device.type != "meta":
        _check_finite(driving, source)
        if ridge == 0:
            _check_control_points(driving)
    driving, source = _in_reach(driving), _in_reach(source)
    n = driving.shape[-2]
    L = _system(driving.double())
    Y = torch.cat([source.double(), L.new_zeros(*L.shape[:-2], 3, 2)], dim=-2)  # (*b, n + 3, 2)
    if ridge == 0:
        solution = torch.linalg.solve(L, Y)
    else:  # minus the ridge may happen to be an eigenvalue of L, which a pseudo-inverse survives
        identity = torch.eye(n + 3, dtype=L.dtype, device=L.device)
        solution = torch.linalg.pinv(L + ridge * identity, hermitian=True) @ Y
    weights, affine = solution.to(driving.dtype).split([n, 3], dim=-2)
    return ThinPlateSpline(driving, weights, affine)


def apply_tps(spline: ThinPlateSpline, points: Float[Tensor, "*#b m 2"]) -> Float[Tensor, "*b m 2"]:
    """Move points by the spline  [MDD Eq. A2]; leading axes broadcast.

    Raises:
        TypeError: if the points are not of the spline's floating type.
        ValueError: if they are not (..., m, 2).
    """
    check_points("points", points)
    if points.dtype != spline.centers.dtype:
        raise TypeError(f"points are {points.dtype}, the spline {spline.centers.dtype}")
    points = _in_reach(points)
    U = radial_basis(_sq_dist(points, spline.centers))  # (*b, m, n)
    return apply_affine(spline.affine, points) + U @ spline.weights


def tps_grid(
    spline: ThinPlateSpline, height: int, width: int
) -> Float[Tensor, "*b height width 2"]:
    """Where every pixel of the driving image comes from: the sampling grid for `warp_image`.

    The same as `apply_tps` on a `coordinate_grid`, and faster on large pictures: on a grid
    |p - c|^2 is a part for each column plus a part for each row, and some rows at a time stay in
    the cache.
    """
    centers = spline.centers
    grid = coordinate_grid(height, width, dtype=centers.dtype, device=centers.device)
    across = (grid[0, :, None, 0] - centers[..., None, :, 0]).square()  # (*b, width, n)
    down = (grid[:, None, 0, 1] - centers[..., None, :, 1]).square()  # (*b, height, n)
    bent = []
    for rows in down.split(max(1, BLOCK // max(1, across.numel())), dim=-2):
        U = radial_basis(rows[..., :, None, :] + across[..., None, :, :])  # (*b, rows, width, n)
        bent.append(U.flatten(-3, -2) @ spline.weights)
    flat = apply_affine(spline.affine, grid.flatten(0, 1))  # (*b, height width, 2)
    return (flat + torch.cat(bent, dim=-2)).unflatten(-2, (height, width))


def bending_energy(spline: ThinPlateSpline) -> Float[Tensor, "*b"]:
    """The integral that the spline makes smallest  [MDD Eq. A1], for x and y together.

    It is 16 pi sum_ij (w_i . w_j) U(|c_i - c_j|): integrate by parts twice, and let the
    bi-Laplacian of U be 16 pi times the delta function  [MDD Eq. A3]. That takes sum w = 0 and
    sum w c^T = 0, which hold without a ridge; with one the integral diverges, and this is its
    finite part.
    """
    weights, centers = spline.weights.double(), spline.centers.double()
    K = radial_basis(_sq_dist(centers, centers))
    return (16 * math.pi * (weights * (K @ weights)).sum((-2, -1))).to(spline.weights.dtype)


def _in_reach(points: Tensor) -> Tensor:
    """The same points, but those whose squares would overflow stay where squares are finite."""
    reach = min(FAR, torch.finfo(points.dtype).max ** 0.4)
    return points.clamp(-reach, reach)


def _sq_dist(points: Tensor, centers: Tensor) -> Tensor:
    """|p - c|^2 of every point and center, (*b, m, n)."""
    dx, dy = (points[..., :, None, k] - centers[..., None, :, k] for k in (0, 1))
    return dx * dx + dy * dy


def _system(driving: Tensor) -> Tensor:
    """L = [K P; P^T 0]  [MDD before Eq. A5], (*b, n + 3, n + 3)."""
    K = radial_basis(_sq_dist(driving, driving))
    P = torch.cat([torch.ones_like(driving[..., :1]), driving], dim=-1)
    zeros = P.new_zeros(*P.shape[:-2], 3, 3)
    return torch.cat([torch.cat([K, P], dim=-1), torch.cat([P.mT, zeros], dim=-1)], dim=-2)


def _check_pairs(driving: Tensor, source: Tensor, ridge: float | int) -> None:
    check_points("driving", driving)
    check_points("source", source)
    if driving.dtype != source.dtype:
        raise TypeError(f"driving is {driving.dtype}, source {source.dtype}; make them one type")
    if driving.shape[-2] != source.shape[-2] or not _broadcast(driving, source):
        raise ValueError(
            "driving and source must hold pairs of points, with leading axes that broadcast; got "
            f"{tuple(driving.shape)} and {tuple(source.shape)}"
        )
    if not isinstance(ridge, Real):
        raise TypeError(f"ridge must be a number, got {type(ridge).__name__}")
    if ridge == 0 and driving.shape[-2] < 3:
        raise ValueError(
            "a thin-plate spline needs at least 3 control points, got "
            f"{driving.shape[-2]}; give more, or a ridge"
        )
    if not 0 <= ridge < math.inf:
        raise ValueError(f"ridge must be finite and not negative, got {ridge}; 0 interpolates")


def _broadcast(driving: Tensor, source: Tensor) -> bool:
    sizes = zip(reversed(driving.shape), reversed(source.shape), strict=False)
    return all(a == b or 1 in (a, b) for a, b in sizes)


def _check_finite(driving: Tensor, source: Tensor) -> None:
    finite = (driving.isfinite() & source.isfinite()).flatten(-2).all(-1)
    _refuse(~finite, "hold a value that is not finite; look where it came from")


def _check_control_points(driving: Tensor) -> None:
    """Refuse what leaves L without an inverse, naming the first such spline."""
    points = _in_reach(driving.detach()).double()
    tolerance = ROUNDING * torch.finfo(driving.dtype).eps * points.abs().amax((-2, -1))
    n = points.shape[-2]
    first, second = torch.triu_indices(n, n, 1)
    gaps = (points[..., first, :] - points[..., second, :]).norm(dim=-1)
    off_line = torch.linalg.svdvals(points - points.mean(-2, keepdim=True))[..., -1] / n**0.5
    _refuse(gaps.amin(-1) <= tolerance, "coincide; move them, or give a ridge")
    _refuse(off_line <= tolerance, "lie on one line; move them, or give a ridge")


def _refuse(found: Tensor, fault: str) -> None:
    if found.any():
        place = found.nonzero()[0].tolist()
        index = f" at batch index {', '.join(map(str, place))}" if place else ""
        raise ValueError(f"control points{index} {fault}")
