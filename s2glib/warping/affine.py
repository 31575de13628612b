"""Affine motion: maps with six numbers, and those of a region's mean and covariance (MRAA).

A region of the body is summed up by the mean and the covariance of its pixels, and moves by the
affine map that takes one ellipse to the other. A covariance says how *wide* the region is; where
it is thin, as a forearm is, the matrix is nearly singular, and a small error in it is a large one
in the map:

    >>> forearm = Region(torch.zeros(2), torch.diag(torch.tensor([0.1, 0.0001])))
    >>> predicted = Region(torch.zeros(2), torch.diag(torch.tensor([0.1, 0.0009])))
    >>> round(condition_number(forearm.covariance).item())
    1000
    >>> round(fit_region_affine(forearm, predicted)[2, 1].item(), 2)  # error 0.0008, 3 x as wide
    3.0
    >>> round(fit_region_affine(forearm, predicted, floor=0.1)[2, 1].item(), 2)  # the safe version
    1.04

Keypoints have no such trouble: what is wrong by 0.01 moves by 0.01, however close they lie.

Paper:    MDD Sup. E, Fig. E1 (the MRAA baseline)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from collections.abc import Callable
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.warping.grids import coordinate_grid


class Region(NamedTuple):
    """Where a part of the body is, how long and wide it is, and how it is turned."""

    mean: Float[Tensor, "*b 2"]
    covariance: Float[Tensor, "*b 2 2"]


def apply_affine(
    affine: Float[Tensor, "*#b 3 2"], points: Float[Tensor, "*#b m 2"]
) -> Float[Tensor, "*b m 2"]:
    """Move points by an affine map with the rows 1, x, y; leading axes broadcast."""
    return affine[..., :1, :] + points @ affine[..., 1:, :]


def invert_affine(affine: Float[Tensor, "*b 3 2"]) -> Float[Tensor, "*b 3 2"]:
    """The map that leads back."""
    linear = affine[..., 1:, :].inverse()
    return torch.cat([-affine[..., :1, :] @ linear, linear], dim=-2)


def region_of_points(points: Float[Tensor, "*b n 2"]) -> Region:
    """Mean and covariance of points that all count alike."""
    mean = points.mean(-2)
    centred = points - mean[..., None, :]
    return Region(mean, centred.mT @ centred / points.shape[-2])


def region_of_heatmap(heatmap: Float[Tensor, "*b height width"]) -> Region:
    """Mean and covariance of the pixels' places, each counted by its share of the heat.

    Args:
        heatmap: not negative, and somewhere positive; a softmax over the pixels is both.
    """
    share = (heatmap / heatmap.sum((-2, -1), keepdim=True)).flatten(-2)[..., None]  # (*b, m, 1)
    height, width = heatmap.shape[-2:]
    grid = coordinate_grid(height, width, dtype=heatmap.dtype, device=heatmap.device)
    places = grid.flatten(0, 1)  # (m, 2)
    mean = (share * places).sum(-2)
    centred = places - mean[..., None, :]
    return Region(mean, (share * centred).mT @ centred)


def cholesky_root(covariance: Float[Tensor, "*b 2 2"]) -> Float[Tensor, "*b 2 2"]:
    """The lower triangle R with R R^T = covariance: smooth, and one for each matrix  [MDD E]."""
    return torch.linalg.cholesky(covariance)


def principal_root(covariance: Float[Tensor, "*b 2 2"]) -> Float[Tensor, "*b 2 2"]:
    """The principal axes, long one first, as long as the spread along them (MRAA's PCA).

    Axes have no sign, and those of a round region no direction: a small change may turn them by
    any angle, and the gradient has no bound there.
    """
    variances, axes = torch.linalg.eigh(covariance)  # in rising order
    return axes.flip(-1) * variances.flip(-1).clamp_min(0).sqrt()[..., None, :]


def fit_region_affine(
    driving: Region,
    source: Region,
    *,
    root: Callable[[Tensor], Tensor] = cholesky_root,
    floor: float | int = 0.0,
) -> Float[Tensor, "*b 3 2"]:
    """Find the affine map that takes the driving region's mean and covariance to the source's.

    With roots R of the covariances it is p -> mean_S + R_S R_D^-1 (p - mean_D).

    Args:
        driving: the region where it is seen; leading axes broadcast with the source's.
        source: the same region in the source image.
        root: which matrix R with R R^T = covariance to take; they differ by a rotation.
        floor: smallest width (standard deviation) of a region; both are blurred by it. Zero is the
            papers' version. Ours, and the safe one, is the size of a few pixels: the condition
            number stays below 1 + variance / floor^2.

    Returns:
        The rows 1, x, y of the map, as `ThinPlateSpline.affine` holds them.

    Raises:
        ValueError: if `floor` is negative, or a covariance, after the blur, is not positive
            definite. On the meta device values are not looked at.
    """
    roots = [root(_blurred(region.covariance, floor)) for region in (driving, source)]
    linear = torch.linalg.solve(roots[0].mT, roots[1].mT)  # transposed: it acts on rows
    offset = source.mean[..., None, :] - driving.mean[..., None, :] @ linear
    return torch.cat(torch.broadcast_tensors(offset, linear[..., :1, :], linear[..., 1:, :]), -2)


def condition_number(covariance: Float[Tensor, "*b 2 2"]) -> Float[Tensor, "*b"]:
    """Largest over smallest variance: 1 for a round region, (length / width)^2 for a long one."""
    variances = torch.linalg.eigvalsh(covariance)
    return variances[..., 1] / variances[..., 0]


def region_heatmap(
    region: Region, height: int, width: int, *, floor: float | int = 0.0
) -> Float[Tensor, "*b height width"]:
    """A bump of height 1 with the region's shape: exp(-d^T covariance^-1 d / 2).

    Near-singular covariances make it a needle, or nothing: "severe errors in heatmaps"  [MDD E].

    Raises:
        ValueError: as `fit_region_affine` does.
    """
    mean, covariance = region.mean, _blurred(region.covariance, floor)
    grid = coordinate_grid(height, width, dtype=mean.dtype, device=mean.device)
    away = grid.flatten(0, 1) - mean[..., None, :]  # (*b, m, 2)
    squared = (away * torch.linalg.solve(covariance, away.mT).mT).sum(-1)
    return torch.exp(-squared / 2).unflatten(-1, (height, width))


def _blurred(covariance: Tensor, floor: float | int) -> Tensor:
    """The covariance after a blur by `floor`, if it has a root and an inverse."""
    if not floor >= 0:
        raise ValueError(f"floor must not be negative, got {floor}; try a few pixels, e.g. 0.02")
    blurred = covariance + floor**2 * torch.eye(2).to(covariance)
    if blurred.device.type != "meta":
        variances = torch.linalg.eigvalsh(blurred.detach())
        flat = ~(variances[..., 0] > torch.finfo(blurred.dtype).eps * variances[..., 1])
        if flat.any():
            index = flat.nonzero()[0].tolist()
            raise ValueError(
                f"the covariance at batch index {index} is not positive definite: the region is "
                "as thin as a line; set a floor"
            )
    return blurred
