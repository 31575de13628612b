"""Networks applied to many rows a few at a time, so that memory does not grow with their number.

Paper:    -
Notebook: notebooks/15_long_sequences.ipynb
"""

from collections.abc import Callable, Sequence
from typing import Any

import torch
from torch import Tensor


@torch.no_grad()
def in_batches(network: Callable[..., Any], *inputs: Any, size: int = 96) -> Any:
    """`network(*inputs)`, `size` rows at a time; without gradients.

    Args:
        network: maps every row by itself, whatever rows stand beside it.
        *inputs: tensors, or named tuples of such, with as many rows; the result is one, too.
        size: how many rows the network sees together.
    """
    pieces = zip(*(_split(rows, size) for rows in inputs), strict=True)
    return _joined([network(*piece) for piece in pieces])


def _split(rows: Any, size: int) -> Sequence[Any]:
    if isinstance(rows, Tensor):
        return rows.split(size)
    return [type(rows)(*parts) for parts in zip(*(_split(x, size) for x in rows), strict=True)]


def _joined(parts: list[Any] | tuple[Any, ...]) -> Any:
    if isinstance(parts[0], Tensor):
        return torch.cat(parts)
    return type(parts[0])(*map(_joined, zip(*parts, strict=True)))
