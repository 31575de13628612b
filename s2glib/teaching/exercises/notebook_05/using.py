"""Exercise 05-4: how many codes are in use, as it were.

Paper:    PT A.1
Notebook: -
"""

import math
from collections import Counter
from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.quantization import code_counts, perplexity
from s2glib.teaching.exercises.exercise import Exercise, Mutant


def use_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor, int]]:
    """Two of four codes in equal use, one code alone, and any codes."""
    yield torch.tensor([0, 0, 3, 3]), 4
    yield torch.tensor([1, 1, 1]), 2
    yield torch.tensor(rng.integers(6, size=(3, 10))), 8


def use_oracle(codes: Tensor, num_codes: int) -> Tensor:
    """The product of shares to the power of minus the shares, over the codes in use."""
    counts = Counter(codes.flatten().tolist()).values()
    shares = [count / codes.numel() for count in counts]
    return torch.tensor(math.prod(p**-p for p in shares), dtype=torch.float64)


def _shares(codes: Tensor, num_codes: int) -> Tensor:
    return code_counts(codes, num_codes).double() / codes.numel()


def entropy(codes: Tensor, num_codes: int) -> Tensor:
    """The entropy itself."""
    return perplexity(codes, num_codes).log()


def bits_to_e(codes: Tensor, num_codes: int) -> Tensor:
    """The entropy is in bits, but e is raised to it."""
    return (perplexity(codes, num_codes).log2()).exp()


def in_use(codes: Tensor, num_codes: int) -> Tensor:
    """A code that occurs once counts as much as any other."""
    return (code_counts(codes, num_codes) > 0).double().sum()


def nan_if_unused(codes: Tensor, num_codes: int) -> Tensor:
    """Zero times minus infinity."""
    p = _shares(codes, num_codes)
    return (-(p * p.log()).sum()).exp()


def minus_forgotten(codes: Tensor, num_codes: int) -> Tensor:
    """The entropy is negative."""
    return 1 / perplexity(codes, num_codes)


USE = Exercise(
    id="05-4",
    title="how many codes are in use",
    reference=perplexity,
    inputs=use_inputs,
    oracle=use_oracle,
    minutes=7,
    difficulty=2,
    equation="PT A.1",
    helpers=(code_counts,),
    mutants=(
        Mutant(entropy, "That is the entropy; the perplexity is e to its power."),
        Mutant(bits_to_e, "Your logarithm has base 2, but you raise e: use the same base twice."),
        Mutant(
            in_use,
            "You count the codes that occur at all; rare ones must count less than common ones.",
        ),
        Mutant(
            nan_if_unused,
            "For a code that does not occur you compute 0 times minus infinity, which is nan; "
            "it adds 0.",
        ),
        Mutant(minus_forgotten, "Your sum lacks its minus: the entropy is never negative."),
    ),
    hints=(
        "`torch.bincount(codes.flatten(), minlength=num_codes)` counts. Make it `.double()`, and "
        "divide by its sum to get the shares.",
        "Shares of 0 make trouble in the logarithm only: leave them out, `p = p[p > 0]`.",
        "`return (-(p * p.log()).sum()).exp()`.",
    ),
)
