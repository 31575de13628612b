"""Exercise 05-1: the nearest code in each group's own table.

Paper:    PT A.1
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from scipy.spatial import cKDTree
from torch import Tensor

from s2glib.quantization import nearest_codes
from s2glib.teaching.exercises.exercise import Exercise, Mutant


def search_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor, Tensor]]:
    """One vector in one group, several in two groups, and any number of both."""
    z = torch.tensor([[[0.9, 0.1]]], dtype=torch.float64)
    yield z, torch.tensor([[[0.0, 0.0], [1.0, 0.0], [3.0, 0.5]]], dtype=torch.float64)
    yield torch.tensor(rng.normal(size=(4, 2, 3))), torch.tensor(rng.normal(size=(2, 5, 3)))
    yield torch.tensor(rng.normal(size=(2, 6, 3, 4))), torch.tensor(rng.normal(size=(3, 7, 4)))


def search_oracle(z: Tensor, vectors: Tensor) -> Tensor:
    """A tree search in each table."""
    found = [cKDTree(table).query(z[..., g, :])[1] for g, table in enumerate(vectors)]
    return torch.tensor(np.stack(found, axis=-1))


def _squared(z: Tensor, vectors: Tensor) -> Tensor:
    return (z[..., None, :] - vectors).square().sum(-1)


def farthest(z: Tensor, vectors: Tensor) -> Tensor:
    """The largest distance wins."""
    return _squared(z, vectors).argmax(-1)


def shared(z: Tensor, vectors: Tensor) -> Tensor:
    """All groups look into the first table."""
    return _squared(z, vectors[:1]).argmin(-1)


def by_product(z: Tensor, vectors: Tensor) -> Tensor:
    """The largest inner product wins, and long vectors have large ones."""
    return (z[..., None, :] * vectors).sum(-1).argmax(-1)


def by_angle(z: Tensor, vectors: Tensor) -> Tensor:
    """The direction alone decides."""
    return torch.cosine_similarity(z[..., None, :], vectors, dim=-1).argmax(-1)


def by_blocks(z: Tensor, vectors: Tensor) -> Tensor:
    """Absolute differences are added, not squares."""
    return (z[..., None, :] - vectors).abs().sum(-1).argmin(-1)


SEARCH = Exercise(
    id="05-1",
    title="the nearest code",
    reference=nearest_codes,
    inputs=search_inputs,
    oracle=search_oracle,
    minutes=8,
    difficulty=2,
    equation="PT A.1",
    mutants=(
        Mutant(farthest, "You choose the farthest code: take the smallest distance."),
        Mutant(shared, "All your groups look into the first table; each has its own."),
        Mutant(
            by_product,
            "You compare inner products, and long codes win. Distances need the codes' own "
            "lengths, too.",
        ),
        Mutant(by_angle, "You compare directions only; how long the vectors are counts as well."),
        Mutant(
            by_blocks,
            "You add absolute differences; the distance is the root of a sum of squares.",
        ),
    ),
    hints=(
        "Put an axis for the codes into `z`: `z[..., None, :]` is (..., groups, 1, dim), and minus "
        "`vectors` it is (..., groups, codes, dim).",
        "The squared distance is `.square().sum(-1)`; a root would not change which is smallest.",
        "The codes are the last axis now: `argmin(-1)`. The package gets the same from a product "
        "of matrices, which is quicker.",
    ),
)
