"""Exercise 06-1: one half of the channels decides what passes of the other.

Paper:    PT A.2 (after PixelCNN)
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.layers import gated
from s2glib.teaching.exercises.exercise import Exercise, Mutant


def gate_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor]]:
    """One channel with an open and a shut gate, and any number of both."""
    yield (torch.tensor([[2.0, 2.0], [9.0, -9.0]], dtype=torch.float64),)
    yield (torch.tensor(rng.normal(size=(6, 8))),)
    yield (torch.tensor(rng.normal(size=(2, 4, 10))),)


def gate_oracle(both: Tensor) -> Tensor:
    """Both curves by exponentials, one channel after the other."""
    tracks = both.numpy()
    half = tracks.shape[-2] // 2
    passed = []
    for channel in range(half):
        a, b = np.exp(2 * tracks[..., channel, :]), np.exp(tracks[..., half + channel, :])
        passed.append((a - 1) / (a + 1) * b / (1 + b))
    return torch.from_numpy(np.stack(passed, axis=-2))


def swapped(both: Tensor) -> Tensor:
    """The first half is the gate."""
    a, b = both.chunk(2, dim=-2)
    return b.tanh() * a.sigmoid()


def plain_content(both: Tensor) -> Tensor:
    """A gated linear unit."""
    a, b = both.chunk(2, dim=-2)
    return a * b.sigmoid()


def added(both: Tensor) -> Tensor:
    """A gate that adds cannot shut."""
    a, b = both.chunk(2, dim=-2)
    return a.tanh() + b.sigmoid()


def two_tanh(both: Tensor) -> Tensor:
    """A gate from -1 to 1."""
    a, b = both.chunk(2, dim=-2)
    return a.tanh() * b.tanh()


def interleaved(both: Tensor) -> Tensor:
    """Even channels are let through by odd ones."""
    return both[..., ::2, :].tanh() * both[..., 1::2, :].sigmoid()


def early_and_late(both: Tensor) -> Tensor:
    """The halves of time, not of the channels."""
    a, b = both.chunk(2, dim=-1)
    return a.tanh() * b.sigmoid()


GATE = Exercise(
    id="06-1",
    title="a gate",
    reference=gated,
    inputs=gate_inputs,
    oracle=gate_oracle,
    minutes=6,
    difficulty=1,
    equation="PT A.2",
    mutants=(
        Mutant(swapped, "You have swapped the halves: the first is what passes, the second opens."),
        Mutant(
            plain_content,
            "That is a gated linear unit, and a good gate. Here what passes goes through a tanh "
            "first.",
        ),
        Mutant(added, "You add the two, and nothing is ever shut out; multiply them."),
        Mutant(two_tanh, "A gate is open or shut, from 0 to 1: that is the sigmoid."),
        Mutant(
            interleaved,
            "You pair even channels with odd ones; the halves are the first and the last channels.",
        ),
        Mutant(early_and_late, "You cut time in halves; channels are the last axis but one."),
    ),
    hints=(
        "`a, b = both.chunk(2, dim=-2)` cuts the channels into halves.",
        "`a.tanh()` lies between -1 and 1, `b.sigmoid()` between 0 (shut) and 1 (open).",
        "`return a.tanh() * b.sigmoid()`.",
    ),
)
