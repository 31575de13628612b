"""Exercise 03-1: scores of warps become weights that sum to one at every pixel.

Paper:    MDD 3.2, B.5 (weight maps)
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from scipy.special import softmax
from torch import Tensor

from s2glib.teaching.exercises.exercise import Exercise, Mutant
from s2glib.warping import weight_maps


def score_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor]]:
    """Three warps and two pixels, then any scores, alone and in a batch."""
    yield (torch.tensor([[[0.0, 2.0]], [[0.0, 1.0]], [[0.0, -1.0]]], dtype=torch.float64),)
    yield (torch.tensor(rng.normal(size=(4, 2, 3))),)
    yield (torch.tensor(3 * rng.normal(size=(2, 5, 3, 2))),)


def score_oracle(logits: Tensor) -> Tensor:
    """SciPy's softmax."""
    return torch.tensor(softmax(logits.numpy(), axis=-3))


def over_pixels(logits: Tensor) -> Tensor:
    """Each map sums to one over its own pixels."""
    return logits.flatten(-2).softmax(-1).view_as(logits)


def over_first_axis(logits: Tensor) -> Tensor:
    """The first axis is taken for that of the warps, even in a batch."""
    return logits.softmax(0)


def each_alone(logits: Tensor) -> Tensor:
    """Every warp is turned on or off by itself."""
    return logits.sigmoid()


def shares(logits: Tensor) -> Tensor:
    """Scores over their sum, without the exponential."""
    return logits / logits.sum(-3, keepdim=True)


def winner(logits: Tensor) -> Tensor:
    """The highest score takes all."""
    return (logits == logits.amax(-3, keepdim=True)).to(logits)


WEIGH = Exercise(
    id="03-1",
    title="from scores to weights",
    reference=weight_maps,
    inputs=score_inputs,
    oracle=score_oracle,
    minutes=4,
    difficulty=1,
    equation="MDD B.5",
    mutants=(
        Mutant(
            over_pixels,
            "Your maps sum to 1 over their pixels; the warps shall sum to 1 at every pixel.",
        ),
        Mutant(
            over_first_axis,
            "In a batch the first axis is not that of the warps; count from the end: axis -3.",
        ),
        Mutant(
            each_alone,
            "A sigmoid looks at one warp alone, so the weights do not sum to 1.",
        ),
        Mutant(
            shares,
            "Scores may be negative or sum to 0: take their exponentials before you divide.",
        ),
        Mutant(
            winner,
            "Your highest score takes all, and no gradient tells the others how to win.",
        ),
    ),
    hints=(
        "At every pixel, the exponential of each score over the sum of all of them.",
        "Count axes from the end, so that a batch may stand in front: the warps are axis -3.",
        "PyTorch has it: `return logits.softmax(dim=-3)`.",
    ),
)
