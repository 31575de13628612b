"""Exercise 02-3: move any points by a spline.

Paper:    MDD Eq. A2
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from scipy.spatial.distance import cdist
from scipy.special import xlogy
from torch import Tensor

from s2glib.teaching.exercises.exercise import Exercise, Mutant
from s2glib.warping import ThinPlateSpline, apply_affine, apply_tps, radial_basis
from s2glib.warping.tps import _sq_dist


def move_inputs(rng: np.random.Generator) -> Iterator[tuple[ThinPlateSpline, Tensor]]:
    """One push at the middle, and any spline with any points."""
    identity = torch.tensor([[0, 0], [1, 0], [0, 1]], dtype=torch.float64)
    push = torch.tensor([[0.5, -0.25]], dtype=torch.float64)
    middle = torch.zeros(1, 2, dtype=torch.float64)
    places = torch.tensor([[0.0, 0.0], [0.5, 0.0], [1.0, 2.0]], dtype=torch.float64)
    yield ThinPlateSpline(middle, push, identity), places
    parts = (torch.tensor(rng.normal(size=(n, 2))) for n in (5, 5, 3))
    yield ThinPlateSpline(*parts), torch.tensor(rng.uniform(-1, 1, (6, 2)))


def move_oracle(spline: ThinPlateSpline, points: Tensor) -> Tensor:
    """One point after the other: the offset, two columns, and a sum over the centers."""
    centers, weights, affine = (part.numpy() for part in spline)
    moved = []
    for x, y in points.numpy():
        squared = cdist([[x, y]], centers)[0] ** 2
        bend = sum(xlogy(r2, r2) * w for r2, w in zip(squared, weights, strict=True))
        moved.append(affine[0] + x * affine[1] + y * affine[2] + bend)
    return torch.tensor(np.array(moved))


def only_affine(spline: ThinPlateSpline, points: Tensor) -> Tensor:
    """The plate is not bent."""
    return apply_affine(spline.affine, points)


def only_bending(spline: ThinPlateSpline, points: Tensor) -> Tensor:
    """The affine part is missing."""
    return apply_tps(spline, points) - only_affine(spline, points)


def offset_last(spline: ThinPlateSpline, points: Tensor) -> Tensor:
    """The rows of the affine part are read as x, y, 1."""
    return only_bending(spline, points) + apply_affine(spline.affine.roll(1, dims=0), points)


def added(spline: ThinPlateSpline, points: Tensor) -> Tensor:
    """The point itself is added, as if the spline said how far it moves."""
    return points + apply_tps(spline, points)


def without_square(spline: ThinPlateSpline, points: Tensor) -> Tensor:
    """U is given the distances as if they were squared already."""
    distances = _sq_dist(points, spline.centers).sqrt()
    return only_affine(spline, points) + radial_basis(distances) @ spline.weights


APPLY = Exercise(
    id="02-3",
    title="move any point",
    reference=apply_tps,
    inputs=move_inputs,
    oracle=move_oracle,
    minutes=9,
    difficulty=2,
    equation="MDD Eq. A2",
    helpers=(apply_affine, _sq_dist),
    mutants=(
        Mutant(only_affine, "Your plate stays flat: add the weights times U."),
        Mutant(only_bending, "Your plate bends, but the affine part is missing."),
        Mutant(
            offset_last,
            "You read the rows of the affine part as x, y, 1; the offset is the first one.",
        ),
        Mutant(
            added,
            "The spline says where a point goes, not how far it moves: do not add the point.",
        ),
        Mutant(
            without_square,
            "You call radial_basis with distances; it wants them squared.",
        ),
    ),
    hints=(
        "Squared distances from every point to every center: "
        "`(points[:, None] - spline.centers).square().sum(-1)`, of shape (m, n).",
        "`radial_basis` of these is `U`, and `U @ spline.weights` is the whole sum, (m, 2).",
        "The affine part is its first row plus the points times the other two: "
        "`spline.affine[0] + points @ spline.affine[1:]`.",
    ),
)
