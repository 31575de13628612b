"""Are the codes used? Perplexity, and the codes that nothing chooses.

Paper:    - (ours)
Notebook: notebooks/05_product_codes.ipynb
"""

import torch
from jaxtyping import Float, Int
from torch import Tensor

from s2glib.quantization.doors import require_codes


def code_counts(codes: Int[Tensor, "*b"], num_codes: int) -> Int[Tensor, " num_codes"]:
    """How often each code occurs; for several groups, ask about `codes[..., group]`.

    Raises:
        TypeError: if `codes` is no tensor of integers.
        ValueError: if it is empty, or a code is not in 0..num_codes - 1.
    """
    require_codes(codes, num_codes)
    if not codes.numel():
        raise ValueError("expected at least one code, got none; usage is a share of something")
    return torch.bincount(codes.flatten(), minlength=num_codes)


def perplexity(codes: Int[Tensor, "*b"], num_codes: int) -> Float[Tensor, ""]:
    """How many codes are in use, as it were: exp of the entropy of their shares.

    1 if one code does it all, `num_codes` if all occur alike.

    Raises:
        TypeError: if `codes` is no tensor of integers.
        ValueError: if it is empty, or a code is not in 0..num_codes - 1.
    """
    counts = code_counts(codes, num_codes).double()
    return torch.special.entr(counts / counts.sum()).sum().exp()


def dead_codes(codes: Int[Tensor, "*b"], num_codes: int) -> Int[Tensor, " dead"]:
    """The codes that do not occur, in rising order.

    Raises:
        TypeError: if `codes` is no tensor of integers.
        ValueError: if it is empty, or a code is not in 0..num_codes - 1.
    """
    return (code_counts(codes, num_codes) == 0).nonzero()[:, 0]
