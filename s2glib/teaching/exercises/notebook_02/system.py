"""Exercise 02-2: find the spline through pairs of points.

Paper:    MDD Eq. A5
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from scipy.linalg import lstsq, null_space
from scipy.spatial.distance import cdist
from scipy.special import xlogy
from torch import Tensor

from s2glib.teaching.exercises.exercise import Exercise, Mutant
from s2glib.warping import ThinPlateSpline, fit_tps, radial_basis
from s2glib.warping.tps import _sq_dist, _system


def pair_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor, Tensor]]:
    """A square of which one corner is pulled, a triangle that only turns, and any points."""
    square = torch.tensor([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=torch.float64)
    pulled = square.clone()
    pulled[2] = 0.5
    yield pulled, square
    yield square[:3], torch.tensor([[1, -1], [1, 1], [-1, 1]], dtype=torch.float64)
    yield torch.tensor(rng.uniform(-1, 1, (7, 2))), torch.tensor(rng.uniform(-1, 1, (7, 2)))


def pair_oracle(driving: Tensor, source: Tensor) -> ThinPlateSpline:
    """The side conditions first: weights among those that neither push nor tilt the plate."""
    c, y = driving.numpy(), source.numpy()
    P = np.column_stack([np.ones(len(c)), c])
    K = cdist(c, c, lambda a, b: xlogy(((a - b) ** 2).sum(), ((a - b) ** 2).sum()))
    Q = null_space(P.T)  # (n, n - 3)
    weights = Q @ np.linalg.solve(Q.T @ K @ Q, Q.T @ y)
    affine = lstsq(P, y - K @ weights)[0]
    return ThinPlateSpline(driving, torch.tensor(weights), torch.tensor(affine))


def solved(L: Tensor, driving: Tensor, source: Tensor) -> ThinPlateSpline:
    """The spline that comes out of one system or another."""
    Y = torch.cat([source, torch.zeros(3, 2, dtype=source.dtype)])
    weights, affine = torch.linalg.solve(L, Y).split([len(source), 3])
    return ThinPlateSpline(driving, weights, affine)


def swapped(driving: Tensor, source: Tensor) -> ThinPlateSpline:
    """The spline leads from the source to the driving points."""
    return fit_tps(source, driving)


def transposed(driving: Tensor, source: Tensor) -> ThinPlateSpline:
    """The affine part is laid on its side, as the paper writes it."""
    spline = fit_tps(driving, source)
    return spline._replace(affine=spline.affine.mT)


def ones_last(driving: Tensor, source: Tensor) -> ThinPlateSpline:
    """P has the columns x, y, 1."""
    spline = fit_tps(driving, source)
    return spline._replace(affine=spline.affine.roll(-1, dims=0))


def with_ridge(driving: Tensor, source: Tensor) -> ThinPlateSpline:
    """The ridge of the released code is left in."""
    L = _system(driving)
    return solved(L + 0.01 * torch.eye(len(L), dtype=L.dtype), driving, source)


def without_square(driving: Tensor, source: Tensor) -> ThinPlateSpline:
    """U is given the distances as if they were squared already."""
    n = len(driving)
    L = _system(driving)
    L[:n, :n] = radial_basis(_sq_dist(driving, driving).sqrt())
    return solved(L, driving, source)


def without_conditions(driving: Tensor, source: Tensor) -> ThinPlateSpline:
    """Only [K P] is solved, by the shortest of its many answers."""
    n = len(driving)
    solution = torch.linalg.pinv(_system(driving)[:n]) @ source
    return ThinPlateSpline(driving, *solution.split([n, 3]))


SYSTEM = Exercise(
    id="02-2",
    title="solve for the spline",
    reference=fit_tps,
    inputs=pair_inputs,
    oracle=pair_oracle,
    minutes=15,
    difficulty=3,
    equation="MDD Eq. A5",
    helpers=(_system,),
    mutants=(
        Mutant(
            swapped,
            "Your spline leads the wrong way, from source to driving: build L from the driving "
            "points and Y from the source points.",
        ),
        Mutant(
            transposed,
            "Your affine part is (2, 3), as the paper writes A. The last three rows of the "
            "solution are A transposed already; leave them so.",
        ),
        Mutant(
            ones_last, "Your P has the columns x, y, 1; in the paper, as here, the ones come first."
        ),
        Mutant(with_ridge, "Your L has 0.01 on its diagonal. Section 9 does that; not yet."),
        Mutant(
            without_square,
            "You call radial_basis with distances; it wants them squared.",
        ),
        Mutant(
            without_conditions,
            "Your spline meets its points, but not the side conditions: L needs the rows "
            "[P^T 0], and Y three rows of zeros.",
        ),
    ),
    hints=(
        "Squared distances between all pairs: "
        "`(driving[:, None] - driving).square().sum(-1)`, of shape (n, n). `radial_basis` makes "
        "them `K`. And `P = torch.cat([torch.ones_like(driving[:, :1]), driving], dim=1)`.",
        "Put blocks beside each other with `torch.cat([K, P], dim=1)`, and rows of blocks below "
        "each other with `dim=0`. The zeros are `driving.new_zeros(3, 3)`, and `new_zeros(3, 2)` "
        "below the source points.",
        "`solution = torch.linalg.solve(L, Y)` has n + 3 rows. The first n are the weights, the "
        "last three the affine part: `ThinPlateSpline(driving, solution[:n], solution[n:])`.",
    ),
)
