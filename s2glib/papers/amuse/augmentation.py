"""What the encoders hear instead of clean clips, so that they listen for the factor alone.

All functions take standardised filterbanks.

Paper:    AM B.2 ("augmented speech filterbank"); strengths: ours
Notebook: notebooks/09_disentanglement.ipynb
"""

import math

import torch
from jaxtyping import Float
from torch import Tensor

NEPERS_PER_DECIBEL = math.log(10) / 10  # a filterbank is a log of power


def gain_and_tilt(
    x: Float[Tensor, "batch frames mels"],
    std: float,
    *,
    gain: float,
    tilt: float,
    generator: torch.Generator | None,
) -> Float[Tensor, "batch frames mels"]:
    """Another loudness (dB) and another slope (dB per octave), both normally distributed."""
    octaves = torch.linspace(-2.5, 2.5, x.shape[-1], device=x.device)
    drawn = torch.randn(2, len(x), 1, 1, generator=generator).to(x)
    decibels = gain * drawn[0] + tilt * drawn[1] * octaves
    return x + decibels * NEPERS_PER_DECIBEL / (2 * std)


def mask(
    x: Float[Tensor, "batch frames mels"],
    *,
    longest: int,
    widest: int,
    generator: torch.Generator | None,
) -> Float[Tensor, "batch frames mels"]:
    """Hide one stretch of time and one band of frequency behind the mean value 0 (SpecAugment)."""
    _, frames, mels = x.shape
    time = _stretch(x, frames, longest, generator)[:, :, None]
    band = _stretch(x, mels, widest, generator)[:, None, :]
    return x.masked_fill(time | band, 0.0)


def _stretch(x, length, longest, generator):
    start = torch.randint(length - longest, (len(x), 1), generator=generator)
    size = torch.randint(longest, (len(x), 1), generator=generator)
    place = torch.arange(length)
    return ((place >= start) & (place < start + size)).to(x.device)


def shift(
    x: Float[Tensor, "batch frames mels"],
    silence: Float[Tensor, " mels"],
    *,
    earliest: int,
    latest: int,
    generator: torch.Generator | None,
) -> Float[Tensor, "batch frames mels"]:
    """Start the clip between `earliest` frames sooner and `latest` frames later.

    What moves out of the window is lost; what moves in is silence.
    """
    frames = x.shape[1]
    move = torch.randint(-earliest, latest + 1, (len(x), 1), generator=generator)
    source = torch.arange(frames) - move
    outside = ((source < 0) | (source >= frames)).to(x.device)
    index = source.clamp(0, frames - 1).to(x.device)[:, :, None].expand_as(x)
    return torch.where(outside[:, :, None], silence.to(x), x.gather(1, index))
