"""Exercise 01-1: a turn from six numbers.

Paper:    PT A.2, AM C.2 (6D rotations of SMPL-X joints)
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import normalize

from s2glib.body import sixd_to_matrix
from s2glib.teaching.exercises.exercise import Exercise, Mutant


def sixd_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor]]:
    """Rows that are too long, rows that are not square to each other, and any numbers."""
    yield (torch.tensor([[0.0, 2, 0, -3, 0, 0]], dtype=torch.float64),)
    yield (torch.tensor([[1.0, 0, 0, 1, 1, 0]], dtype=torch.float64),)
    yield (torch.tensor(rng.normal(size=(20, 6))),)


def sixd_oracle(sixd: Tensor) -> Tensor:
    """A QR decomposition, its signs chosen so that the rows keep their directions."""
    turns = []
    for a in sixd.reshape(-1, 2, 3).numpy():
        q, r = np.linalg.qr(a.T)
        b1, b2 = q[:, 0] * np.sign(r[0, 0]), q[:, 1] * np.sign(r[1, 1])
        turns.append([b1, b2, np.cross(b1, b2)])
    return torch.tensor(np.array(turns))


def _rows(b1: Tensor, b2: Tensor) -> Tensor:
    return torch.stack([b1, b2, torch.linalg.cross(b1, b2)], dim=-2)


def _square_to(b: Tensor, a: Tensor) -> Tensor:
    return a - (a * b).sum(-1, keepdim=True) * b


def as_columns(sixd: Tensor) -> Tensor:
    """The three directions stand in columns."""
    return sixd_to_matrix(sixd).mT


def without_lengths(sixd: Tensor) -> Tensor:
    """No row is brought to length 1."""
    a1, a2 = sixd[..., :3], sixd[..., 3:]
    return _rows(a1, _square_to(a1, a2))


def without_second_length(sixd: Tensor) -> Tensor:
    """The second row is not brought to length 1 again."""
    b1 = normalize(sixd[..., :3], dim=-1)
    return _rows(b1, _square_to(b1, sixd[..., 3:]))


def without_bending(sixd: Tensor) -> Tensor:
    """The second row keeps what points along the first."""
    return _rows(normalize(sixd[..., :3], dim=-1), normalize(sixd[..., 3:], dim=-1))


def mirrored(sixd: Tensor) -> Tensor:
    """The cross product is taken in the other order."""
    return sixd_to_matrix(sixd) * torch.tensor([[1], [1], [-1]], dtype=sixd.dtype)


def as_pairs(sixd: Tensor) -> Tensor:
    """The numbers of the two rows are taken in turns."""
    return sixd_to_matrix(torch.cat([sixd[..., 0::2], sixd[..., 1::2]], dim=-1))


SIXD = Exercise(
    id="01-1",
    title="six numbers make a turn",
    reference=sixd_to_matrix,
    inputs=sixd_inputs,
    oracle=sixd_oracle,
    minutes=8,
    difficulty=1,
    equation="PT A.2, AM C.2",
    mutants=(
        Mutant(as_columns, "Your three directions stand in columns; ProbTalk and AMUSE keep rows."),
        Mutant(without_lengths, "Your rows are not of length 1: divide each by its own length."),
        Mutant(
            without_second_length,
            "Taking a part away makes the second row shorter: bring it to length 1 after that.",
        ),
        Mutant(
            without_bending,
            "Your second row is not square to the first: "
            "take away its part along the first row before you bring it to length 1.",
        ),
        Mutant(
            mirrored, "Your third row points the other way: it is row 1 x row 2, in this order."
        ),
        Mutant(
            as_pairs,
            "You deal the six numbers out in turns: "
            "the first three are the first row, the last three the second.",
        ),
    ),
    hints=(
        "Cut the numbers in two: `a1 = sixd[:, :3]` and `a2 = sixd[:, 3:]`. Then divide `a1` by "
        "its length, `a1.norm(dim=-1, keepdim=True)`.",
        "The part of `a2` along `b1` is `(b1 * a2).sum(-1, keepdim=True) * b1`. "
        "Take it away; then divide what is left by its length.",
        "The third row is `torch.linalg.cross(b1, b2)`. Put the rows together with "
        "`torch.stack([b1, b2, b3], dim=-2)`.",
    ),
)
