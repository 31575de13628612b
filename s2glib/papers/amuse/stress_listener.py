"""Hears where stressed vowels begin: the beats that gestures keep.

A gesture ends on a stressed syllable. The latents say what is said, but hardly when, so a small
network of its own marks the moments in the filterbank.

Paper:    AM E (beat alignment), ours
Notebook: notebooks/13_latent_diffusion.ipynb
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.papers.amuse.front_end import rhythm


@dataclass(frozen=True)
class StressConfig:
    """Sizes of the listener (ours)."""

    n_mels: int = 64
    width: int = 48


class StressListener(nn.Module):
    """Three convolutions over time, each twice as wide in reach as the one before."""

    config_class = StressConfig

    def __init__(self, config: StressConfig):
        super().__init__()
        self.config = config
        width = config.width
        self.layers = nn.Sequential(
            nn.Conv1d(config.n_mels, width, 5, padding=2),
            nn.GELU(),
            nn.Conv1d(width, width, 5, padding=4, dilation=2),
            nn.GELU(),
            nn.Conv1d(width, width, 5, padding=8, dilation=4),
            nn.GELU(),
            nn.Conv1d(width, 1, 1),
        )

    def logits(
        self, filterbank: Float[Tensor, "batch frames mels"]
    ) -> Float[Tensor, "batch frames"]:
        """Log-odds that a stressed vowel begins; loudness as a whole plays no part."""
        levelled = filterbank - filterbank.mean(dim=(1, 2), keepdim=True)
        return self.layers(levelled.mT)[:, 0]

    def forward(
        self, filterbank: Float[Tensor, "batch frames mels"]
    ) -> Float[Tensor, "batch frames"]:
        """Probability that a stressed vowel begins, frame by frame."""
        return self.logits(filterbank).sigmoid()


def heard_rhythm(
    filterbank: Float[Tensor, "batch frames mels"], listener: StressListener
) -> Float[Tensor, "batch frames 3"]:
    """Energy, onset strength and stress, frame by frame."""
    return torch.cat([rhythm(filterbank), listener(filterbank)[..., None]], dim=-1)


def stress_targets(
    times: Float[Tensor, "batch stresses"], frames: int, rate: float, *, spread: float = 0.04
) -> Float[Tensor, "batch frames"]:
    """One at every stressed vowel's start, falling off as a Gaussian of `spread` seconds.

    Missing stresses are marked by NaN.
    """
    moments = (torch.arange(frames) + 0.5) / rate
    bumps = torch.exp(-0.5 * ((moments - times[..., None]) / spread) ** 2)
    return bumps.nan_to_num(0.0).amax(dim=1)


def stress_loss(
    logits: Float[Tensor, "batch frames"], targets: Float[Tensor, "batch frames"]
) -> Float[Tensor, ""]:
    """Cross-entropy with soft targets; the rare beats count four times."""
    return F.binary_cross_entropy_with_logits(logits, targets, weight=1 + 3 * targets)
