"""Noise schedules: how much of the data is left at each level of the forward process.

Paper:    MDD Sup. B.2, Eq. B10
Notebook: notebooks/10_diffusion.ipynb
"""

import math
from dataclasses import dataclass
from functools import cached_property

import torch
from jaxtyping import Float, Float64
from torch import Tensor


@dataclass(frozen=True, eq=False)
class NoiseSchedule:
    """The variances that noise is added with, level by level  [MDD Eq. B10].

    Levels count from 0: level t is step t + 1 of the papers, and already noisy. Everything is
    float64 on the CPU, because 1 - alpha-bar of a float32 table is wrong in its fourth digit.

    Attributes:
        betas: variance of the noise of each level, strictly between 0 and 1.

    Raises:
        ValueError: if `betas` is empty, not one float64 axis, or leaves (0, 1).
    """

    betas: Float[Tensor, " levels"]

    def __post_init__(self) -> None:
        if self.betas.dtype != torch.float64 or self.betas.ndim != 1 or not len(self.betas):
            raise ValueError(
                "betas must be one non-empty axis of float64, got "
                f"{self.betas.dtype} of shape {tuple(self.betas.shape)}; use e.g. .linear(1000)"
            )
        if not ((self.betas > 0) & (self.betas < 1)).all():
            raise ValueError(
                "betas must lie strictly between 0 and 1, got "
                f"{self.betas.min():.3g} to {self.betas.max():.3g}; check start, end or max_beta"
            )

    @classmethod
    def linear(cls, levels: int, start: float = 1e-4, end: float = 0.02) -> "NoiseSchedule":
        """Variances on a straight line, as in DDPM; made for about 1000 levels."""
        return cls(_ramp(start, end, levels))

    @classmethod
    def scaled_linear(
        cls, levels: int, start: float = 0.00085, end: float = 0.012
    ) -> "NoiseSchedule":
        """Standard deviations on a straight line, as in latent diffusion  [AM, authors' code]."""
        return cls(_ramp(start**0.5, end**0.5, levels).square())

    @classmethod
    def cosine(cls, levels: int, s: float = 0.008, max_beta: float = 0.999) -> "NoiseSchedule":
        """Signal that falls like a squared cosine (Nichol and Dhariwal)  [MDD, authors' code]."""
        time = _ramp(0.0, 1.0, levels + 1)
        signal = torch.cos((time + s) / (1 + s) * math.pi / 2).square()
        return cls((1 - signal[1:] / signal[:-1]).clamp(max=max_beta))

    @property
    def levels(self) -> int:
        """How many levels there are: the papers' T."""
        return len(self.betas)

    @cached_property
    def alphas(self) -> Float64[Tensor, " levels"]:
        """Share of the variance that one level keeps: 1 - beta."""
        return 1 - self.betas

    @cached_property
    def alpha_bars(self) -> Float64[Tensor, " levels"]:
        """Share of the data's variance left at a level: the product of all alphas so far."""
        return self.alphas.cumprod(0)

    @cached_property
    def alpha_bars_before(self) -> Float64[Tensor, " levels"]:
        """Alpha-bar one level earlier; before level 0 stands clean data, alpha-bar 1."""
        return torch.cat([self.alpha_bars.new_ones(1), self.alpha_bars[:-1]])


def _ramp(start: float, end: float, count: int) -> Float64[Tensor, " count"]:
    if count < 1:
        raise ValueError(f"a noise schedule needs at least 1 level, got {count}; 1000 is usual")
    return torch.linspace(start, end, count, dtype=torch.float64, device="cpu")
