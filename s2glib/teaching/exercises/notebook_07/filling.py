"""Exercise 07-1: what is known, and the rest from the codes.

Paper:    PT Eq. 8
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.papers.probtalk import fill
from s2glib.teaching.exercises.exercise import Exercise, Mutant

Case = tuple[Tensor, Tensor, Tensor]


def fill_inputs(rng: np.random.Generator) -> Iterator[Case]:
    """Three frames, then numbers of which some are known; what is not given may be NaN."""
    known = torch.tensor([[[True], [False], [True]]])
    yield torch.tensor([[[1.0], [2.0], [3.0]]]), torch.tensor([[[7.0], [8.0], [9.0]]]), known
    yield _case(rng, (1, 4, 3))
    given, made, known = _case(rng, (2, 5, 4))
    yield given.masked_fill(~known, torch.nan), made, known


def _case(rng: np.random.Generator, shape: tuple[int, ...]) -> Case:
    given, made = (torch.tensor(rng.normal(size=shape)) for _ in range(2))
    return given, made, torch.tensor(rng.random(shape) < 0.5)


def fill_oracle(given: Tensor, made: Tensor, known: Tensor) -> Tensor:
    """Number by number."""
    filled = made.clone()
    for place in known.nonzero().tolist():
        filled[tuple(place)] = given[tuple(place)]
    return filled


def inverted(given: Tensor, made: Tensor, known: Tensor) -> Tensor:
    """The mask is read the other way round."""
    return fill(made, given, known)


def multiplied(given: Tensor, made: Tensor, known: Tensor) -> Tensor:
    """Eq. 8 letter by letter: zero times NaN is NaN."""
    return known * given + ~known * made


def added(given: Tensor, made: Tensor, known: Tensor) -> Tensor:
    """What is known is added to everything that was made."""
    return torch.where(known, given, 0.0) + made


def frame_by_frame(given: Tensor, made: Tensor, known: Tensor) -> Tensor:
    """A frame is kept as a whole or not at all."""
    return fill(given, made, known.all(dim=-1, keepdim=True).expand_as(known))


FILL = Exercise(
    id="07-1",
    title="known here, made there",
    reference=fill,
    inputs=fill_inputs,
    oracle=fill_oracle,
    minutes=5,
    difficulty=1,
    equation="PT Eq. 8",
    mutants=(
        Mutant(
            inverted,
            "Your mask is inverted: where `known` is true, what is given stands.",
        ),
        Mutant(
            multiplied,
            "Zero times NaN is NaN: do not multiply what is not given, choose instead.",
        ),
        Mutant(added, "Where something is known, what was made must be gone: (1 - I) is 0 there."),
        Mutant(
            frame_by_frame,
            "You keep whole frames only; the mask says it for every number of every frame.",
        ),
    ),
    hints=(
        "Eq. 8 is a choice: at every place one of the two, as the mask says.",
        "PyTorch chooses with `torch.where(condition, one, other)`.",
        "`return torch.where(known, given, made)`.",
    ),
)
