"""Exercise 05-2: forward the nearest vector, backward the identity.

Paper:    PT A.1 (after VQ-VAE)
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.quantization import straight_through
from s2glib.teaching.exercises.exercise import Exercise, Mutant


def pass_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor, Tensor]]:
    """Two numbers and what they are rounded to, and any vectors; gradients are asked for."""
    yield _asking([0.4, 1.7]), _asking([0.0, 2.0])
    yield _asking(rng.normal(size=(4, 3))), _asking(rng.normal(size=(4, 3)))


def _asking(values: object) -> Tensor:
    return torch.tensor(values, dtype=torch.float64, requires_grad=True)


def pass_oracle(z: Tensor, nearest: Tensor) -> Tensor:
    """What comes out is the nearest vector itself."""
    return nearest.clone()


def cut(z: Tensor, nearest: Tensor) -> Tensor:
    """The nearest vector, to which the encoder has no path."""
    return z + (nearest - z)


def all_detached(z: Tensor, nearest: Tensor) -> Tensor:
    """Nothing has a gradient."""
    return (z + (nearest - z)).detach()


def swapped(z: Tensor, nearest: Tensor) -> Tensor:
    """The right gradient would be the other one's, and the value is not quantised."""
    return nearest + (z - nearest).detach()


def added(z: Tensor, nearest: Tensor) -> Tensor:
    """Both are added."""
    return z + nearest.detach()


PASS = Exercise(
    id="05-2",
    title="straight through",
    reference=straight_through,
    inputs=pass_inputs,
    oracle=pass_oracle,
    minutes=6,
    difficulty=1,
    equation="PT A.1",
    mutants=(
        Mutant(
            cut,
            "Your value is right, but no gradient reaches z: as it stands, z cancels out.",
        ),
        Mutant(
            all_detached,
            "Your value is right, but you detached all of it, and no gradient reaches z.",
        ),
        Mutant(
            swapped,
            "You have swapped the two: what comes out must be the nearest vector, and the gradient "
            "must go to z.",
        ),
        Mutant(added, "You add the two; what comes out must be the nearest vector alone."),
    ),
    hints=(
        "`z` plus a constant has the gradient 1. Find the constant that makes it `nearest`.",
        "`nearest - z`, and `.detach()` makes a constant of it.",
        "`return z + (nearest - z).detach()`.",
    ),
)
