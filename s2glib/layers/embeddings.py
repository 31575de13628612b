"""Numbers as waves: embeddings of time steps and of positions.

Paper:    MDD B.2, AM C.1 (time steps), PT A.2 (positions)
Notebook: notebooks/10_diffusion.ipynb
"""

import math

import torch
from jaxtyping import Float, Shaped
from torch import Tensor


def sinusoidal_embedding(
    values: Shaped[Tensor, "*b"], width: int, *, longest: float = 1e4
) -> Float[Tensor, "*b width"]:
    """Sines, then cosines, of the values at `width / 2` frequencies from 1 down to 1 / longest.

    Raises:
        ValueError: if the width is odd.
    """
    if width % 2:
        raise ValueError(f"sines and cosines share the width equally: it must be even, got {width}")
    half = torch.arange(width // 2, device=values.device) / (width // 2)
    angles = values[..., None].float() * torch.exp(-math.log(longest) * half)
    return torch.cat([angles.sin(), angles.cos()], dim=-1)


def fixed_positions(count: int, width: int) -> Float[Tensor, "count width"]:
    """The sinusoidal embedding of positions 0 .. count - 1."""
    return sinusoidal_embedding(torch.arange(count), width, longest=1e3)
