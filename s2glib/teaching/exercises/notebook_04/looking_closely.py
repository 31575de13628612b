"""Exercise 04-1: the mean error inside a mask.

Paper:    MDD Eq. B17
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.losses import masked_l1
from s2glib.losses.image import _area
from s2glib.teaching.exercises.exercise import Exercise, Mutant

FAINTEST = 1e-9  # area, in pixels


def masked_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor, Tensor, Tensor]]:
    """One pixel of four; two pictures with masks of different sizes; soft masks; an empty one."""
    black, grey = torch.zeros(1, 3, 2, 2), torch.full((1, 3, 2, 2), 0.25)
    corner = torch.tensor([[[[1.0, 0.0], [0.0, 0.0]]]])
    yield black.double(), grey.double(), corner.double()
    image, image_hat = (torch.tensor(rng.random((2, 3, 4, 5))) for _ in range(2))
    hard = torch.zeros(2, 1, 4, 5, dtype=torch.float64)
    hard[0, :, :1, :2], hard[1, :, :3] = 1, 1
    yield image, image_hat, hard
    yield image, image_hat, torch.tensor(rng.random((2, 1, 4, 5)))
    hard = hard.clone()
    hard[0] = 0
    yield image, image_hat, hard


def masked_oracle(image: Tensor, image_hat: Tensor, mask: Tensor) -> Tensor:
    """A weighted mean over a list of all pixels and channels, picture by picture."""
    means = []
    for x, y, m in zip(image.numpy(), image_hat.numpy(), mask.numpy(), strict=True):
        weights = np.repeat(m, len(x), axis=0)
        seen = weights.sum() > 0
        means.append(np.average(np.abs(x - y), weights=weights) if seen else 0.0)
    return torch.tensor(np.mean(means))


def off(image: Tensor, image_hat: Tensor, mask: Tensor) -> Tensor:
    """The error inside the mask, and zeros elsewhere."""
    return (image - image_hat).abs() * mask


def over_everything(image: Tensor, image_hat: Tensor, mask: Tensor) -> Tensor:
    """The mean is over the whole picture."""
    return off(image, image_hat, mask).mean()


def without_channels(image: Tensor, image_hat: Tensor, mask: Tensor) -> Tensor:
    """Three colours are summed, but one area is divided by."""
    return image.shape[1] * masked_l1(image, image_hat, mask)


def all_at_once(image: Tensor, image_hat: Tensor, mask: Tensor) -> Tensor:
    """One division for all pictures."""
    area = (image.shape[1] * mask.sum()).clamp_min(FAINTEST)
    return off(image, image_hat, mask).sum() / area


def inside_out(image: Tensor, image_hat: Tensor, mask: Tensor) -> Tensor:
    """The complement of the mask."""
    return masked_l1(image, image_hat, 1 - mask)


def summed(image: Tensor, image_hat: Tensor, mask: Tensor) -> Tensor:
    """The pictures' errors are added up."""
    return len(image) * masked_l1(image, image_hat, mask)


def nan_where_empty(image: Tensor, image_hat: Tensor, mask: Tensor) -> Tensor:
    """Zero divided by an area of zero."""
    inside = off(image, image_hat, mask).sum(dim=(1, 2, 3))
    return (inside / (image.shape[1] * mask.sum(dim=(1, 2, 3)))).mean()


CLOSELY = Exercise(
    id="04-1",
    title="the error inside a mask",
    reference=masked_l1,
    inputs=masked_inputs,
    oracle=masked_oracle,
    minutes=8,
    difficulty=1,
    equation="MDD Eq. B17",
    helpers=(_area,),
    mutants=(
        Mutant(
            over_everything,
            "You average over the whole picture, so a small hand counts for little again: divide "
            "by the area of the mask.",
        ),
        Mutant(
            without_channels,
            "Your errors are three times too large: three colours are summed, so divide by the "
            "area times 3.",
        ),
        Mutant(
            all_at_once,
            "You divide once for all pictures, so the one with the largest mask counts most: "
            "divide picture by picture, then take the mean.",
        ),
        Mutant(inside_out, "You look outside of the mask: 1 is where to look."),
        Mutant(summed, "You sum over the pictures of the batch; take their mean."),
        Mutant(
            nan_where_empty,
            "Where a mask is empty you compute 0 / 0, which is nan. Let the area never be quite 0.",
        ),
    ),
    hints=(
        "The error inside the mask is `(image - image_hat).abs() * mask`: one mask serves all "
        "three colours, by broadcasting. Outside it is 0.",
        "Sum it for each picture of its own: `.sum(dim=(1, 2, 3))`, of shape (batch,). The mask "
        "has one channel, so its area in numbers is `3 * mask.sum(dim=(1, 2, 3))`.",
        "Divide the one by the other, which `.clamp_min(1e-9)` keeps from being 0, and take the "
        "`.mean()` over the pictures.",
    ),
)
