"""Exercise 03-2: many warps and their weights become one flow.

Paper:    MDD 3.2, B.5 (optical flow)
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.teaching.exercises.exercise import Exercise, Mutant
from s2glib.warping import combine_flows, identity_flow


def mix_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor, Tensor]]:
    """Two warps of one pixel, then any of them, alone and in a batch."""
    flows = torch.tensor([[[[0.0, 0.0]]], [[[0.5, -1.0]]]], dtype=torch.float64)
    yield flows, torch.tensor([[[0.75]], [[0.25]]], dtype=torch.float64)
    for shape in ((4, 2, 3), (2, 5, 3, 2)):
        weights = torch.tensor(rng.exponential(size=shape))
        yield torch.tensor(rng.uniform(-1, 1, (*shape, 2))), weights / weights.sum(-3, keepdim=True)


def mix_oracle(flows: Tensor, weights: Tensor) -> Tensor:
    """Picture by picture, row by row, pixel by pixel: a weighted average of points."""
    *batch, k, height, width = weights.shape
    points = flows.numpy().reshape(-1, k, height, width, 2)
    shares = weights.numpy().reshape(-1, k, height, width)
    mixed = np.empty((len(points), height, width, 2))
    for n, i, j in np.ndindex(mixed.shape[:-1]):
        mixed[n, i, j] = np.average(points[n, :, i, j], axis=0, weights=shares[n, :, i, j])
    return torch.tensor(mixed.reshape(*batch, height, width, 2))


def all_alike(flows: Tensor, weights: Tensor) -> Tensor:
    """The weights are forgotten."""
    return flows.mean(-4)


def without_background(flows: Tensor, weights: Tensor) -> Tensor:
    """The first warp is left out."""
    return combine_flows(flows[..., 1:, :, :, :], weights[..., 1:, :, :])


def divided(flows: Tensor, weights: Tensor) -> Tensor:
    """A mean over warps that the weights have averaged already."""
    return (weights[..., None] * flows).mean(-4)


def added(flows: Tensor, weights: Tensor) -> Tensor:
    """The pixel's own place is added, as if warps said how far to move."""
    return identity_flow(flows) + combine_flows(flows, weights)


def strongest(flows: Tensor, weights: Tensor) -> Tensor:
    """Every pixel follows the warp of largest weight."""
    return combine_flows(flows, (weights == weights.amax(-3, keepdim=True)).to(weights))


MIX = Exercise(
    id="03-2",
    title="many warps, one flow",
    reference=combine_flows,
    inputs=mix_inputs,
    oracle=mix_oracle,
    minutes=5,
    difficulty=1,
    equation="MDD B.5",
    mutants=(
        Mutant(all_alike, "All your warps count alike: multiply each by its weight."),
        Mutant(
            without_background,
            "You left out the first warp. It is the background's, and most pixels need it.",
        ),
        Mutant(
            divided,
            "Your places are too near the middle: the weights sum to 1 already, so take the sum "
            "over the warps, not the mean.",
        ),
        Mutant(
            added,
            "A warp says which place to look at, not how far away that is: add no grid.",
        ),
        Mutant(
            strongest,
            "Each of your pixels follows its strongest warp, and the picture tears where two meet: "
            "mix them.",
        ),
    ),
    hints=(
        "For every pixel: the sum over the warps of weight times place.",
        "Weights are (..., k, height, width), places have one axis more: `weights[..., None]`.",
        "The warps are axis -4 of the product: `return (weights[..., None] * flows).sum(-4)`.",
    ),
)
