"""Exercise 04-3: how much a picture changes from pixel to pixel.

Paper:    MDD Eq. B20
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.losses import total_variation
from s2glib.teaching.exercises.exercise import Exercise, Mutant


def picture_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor]]:
    """A step to the right, a slope, and any pictures."""
    yield (torch.tensor([[[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]]], dtype=torch.float64),)
    yield (torch.arange(12, dtype=torch.float64).view(1, 1, 3, 4) / 12,)
    yield (torch.tensor(rng.random((2, 3, 4, 6))),)


def picture_oracle(image: Tensor) -> Tensor:
    """Pixel by pixel: the one below, the one to the right."""
    values = image.numpy()
    *_, height, width = values.shape
    below = [
        np.abs(values[..., i + 1, j] - values[..., i, j]).mean()
        for i in range(height - 1)
        for j in range(width)
    ]
    right = [
        np.abs(values[..., i, j + 1] - values[..., i, j]).mean()
        for i in range(height)
        for j in range(width - 1)
    ]
    return torch.tensor(np.mean(below) + np.mean(right))


def steps(image: Tensor) -> tuple[Tensor, Tensor]:
    """Differences of neighbours, down and to the right."""
    return image.diff(dim=-2), image.diff(dim=-1)


def as_printed(image: Tensor) -> Tensor:
    """Sums over all pixels."""
    return torch.stack([step.abs().sum() for step in steps(image)]).sum()


def squared(image: Tensor) -> Tensor:
    """Squares instead of absolute values."""
    return torch.stack([step.square().mean() for step in steps(image)]).sum()


def signed(image: Tensor) -> Tensor:
    """Ups and downs cancel each other."""
    return torch.stack([step.mean() for step in steps(image)]).sum()


def only_down(image: Tensor) -> Tensor:
    """Neighbours to the right are forgotten."""
    return steps(image)[0].abs().mean()


def only_right(image: Tensor) -> Tensor:
    """Neighbours below are forgotten."""
    return steps(image)[1].abs().mean()


def halved(image: Tensor) -> Tensor:
    """The mean of the two directions."""
    return total_variation(image) / 2


def around_the_edge(image: Tensor) -> Tensor:
    """The last pixel is compared with the first."""
    rolled = [(image.roll(-1, dims=axis) - image).abs().mean() for axis in (-2, -1)]
    return torch.stack(rolled).sum()


SMOOTHNESS = Exercise(
    id="04-3",
    title="total variation",
    reference=total_variation,
    inputs=picture_inputs,
    oracle=picture_oracle,
    minutes=6,
    difficulty=1,
    equation="MDD Eq. B20",
    mutants=(
        Mutant(
            as_printed,
            "You sum over all pixels, as it is printed; the authors' weight of 0.1 is meant for "
            "means.",
        ),
        Mutant(squared, "You square the differences; the paper takes absolute values."),
        Mutant(signed, "Take absolute values: as it is, ups and downs cancel."),
        Mutant(
            only_down,
            "You compare each pixel with the one below only; the one to the right is missing.",
        ),
        Mutant(
            only_right,
            "You compare each pixel with the one to the right only; the one below is missing.",
        ),
        Mutant(halved, "You average over the two directions; the paper adds them."),
        Mutant(
            around_the_edge,
            "You compare the last pixel of a row or column with the first: `roll` goes around the "
            "edge.",
        ),
    ),
    hints=(
        "`image.diff(dim=-2)` is each pixel minus the one above it; `dim=-1` goes along the rows.",
        "For both directions take `.abs().mean()`, and add the two.",
    ),
)
