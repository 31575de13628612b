"""What the quantisers demand of vectors and codes, and the sentence they answer with otherwise.

Paper:    -
Notebook: notebooks/05_product_codes.ipynb
"""

import torch
from torch import Tensor


def require_vectors(z: Tensor, dim: int) -> None:
    """Refuse what is no batch of vectors with `dim` channels.

    Raises:
        TypeError: if it is no floating-point tensor.
        ValueError: if it has other axes or is empty.
    """
    if not isinstance(z, Tensor) or not z.is_floating_point():
        raise TypeError(f"expected a tensor of floating-point vectors, got {_kind(z)}; convert it")
    if z.ndim < 1 or z.shape[-1] != dim or not z.numel():
        raise ValueError(
            f"expected at least one vector of {dim} channels, got shape {tuple(z.shape)}; "
            "channels stand on the last axis"
        )


def require_codes(codes: Tensor, num_codes: int, *, groups: int | None = None) -> None:
    """Refuse what are no codes in 0..num_codes - 1.

    Args:
        codes: of any shape, or, with `groups`, one for each group on the last axis.
        num_codes: the size of a codebook.
        groups: how many codebooks there are.

    Raises:
        TypeError: if they are no tensor of integers.
        ValueError: if a code is out of range, or there is not one for each group.
    """
    if not isinstance(codes, Tensor) or codes.dtype not in (torch.int64, torch.int32):
        raise TypeError(
            f"expected a tensor of integer codes, got {_kind(codes)}; pass what `encode` gives"
        )
    if groups is not None and codes.shape[-1:] != (groups,):
        raise ValueError(
            f"expected {groups} codes on the last axis, got shape {tuple(codes.shape)}; "
            "pass what `encode` gives"
        )
    if codes.device.type != "meta" and ((codes < 0) | (codes >= num_codes)).any():
        raise ValueError(
            f"codes must be 0..{num_codes - 1}, got {codes.min()}..{codes.max()}; "
            "were they made with another codebook?"
        )


def _kind(value: object) -> object:
    return value.dtype if isinstance(value, Tensor) else type(value).__name__
