"""Exercise 02-1: how far a plate bends, at a distance from where it is pushed.

Paper:    MDD Eq. A2
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from scipy.special import xlogy
from torch import Tensor

from s2glib.teaching.exercises.exercise import Exercise, Mutant
from s2glib.warping import radial_basis


def basis_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor]]:
    """One distance, the special ones 0 and 1, and any table of distances."""
    yield (torch.tensor(4.0, dtype=torch.float64),)
    yield (torch.tensor([0.25, 1.0, 0.0], dtype=torch.float64),)
    yield (torch.tensor(rng.exponential(size=(4, 5))),)


def basis_oracle(sq_dist: Tensor) -> Tensor:
    """SciPy's x log y, which knows that 0 log 0 is 0."""
    return torch.as_tensor(xlogy(sq_dist.numpy(), sq_dist.numpy()))


def log_of_r(sq_dist: Tensor) -> Tensor:
    """The logarithm is taken of r, not of r squared."""
    return radial_basis(sq_dist) / 2


def base_ten(sq_dist: Tensor) -> Tensor:
    """The logarithm has base 10."""
    return radial_basis(sq_dist) / np.log(10)


def r_in_front(sq_dist: Tensor) -> Tensor:
    """The factor in front is r, not r squared."""
    return sq_dist.sqrt() * torch.where(sq_dist > 0, sq_dist, 1.0).log()


def squared_twice(sq_dist: Tensor) -> Tensor:
    """What is squared already is squared once more."""
    return radial_basis(sq_dist.square())


def nan_at_zero(sq_dist: Tensor) -> Tensor:
    """Zero times minus infinity."""
    return sq_dist * sq_dist.log()


BASIS = Exercise(
    id="02-1",
    title="the bend around one point",
    reference=radial_basis,
    inputs=basis_inputs,
    oracle=basis_oracle,
    minutes=6,
    difficulty=1,
    equation="MDD Eq. A2",
    mutants=(
        Mutant(
            log_of_r,
            "Your values are half as large: take the logarithm of r squared, not of r.",
        ),
        Mutant(base_ten, "Your logarithm has base 10; in mathematics log means base e."),
        Mutant(r_in_front, "In front of the logarithm stands r squared; you have r."),
        Mutant(
            squared_twice,
            "The argument is the squared distance already, and you square it once more.",
        ),
        Mutant(
            nan_at_zero,
            "At distance 0 you compute 0 times minus infinity, which is nan; the limit is 0.",
        ),
    ),
    hints=(
        "The argument `sq_dist` *is* r squared, so the formula reads `sq_dist * sq_dist.log()`. "
        "Find out what that gives at 0.",
        "Nothing but the logarithm makes trouble, so let it never see a 0: "
        "`safe = torch.where(sq_dist > 0, sq_dist, 1.0)`.",
        "The factor in front makes the value at 0 right: `return sq_dist * safe.log()`.",
    ),
)
