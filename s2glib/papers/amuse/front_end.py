"""From sound to what the speech encoders see, and to what the denoiser follows in time.

Paper:    AM B.5 (filterbank); time tracks: ours
Notebook: notebooks/08_speech_patches.ipynb
"""

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional as F

from s2glib.audio import standardize
from s2glib.data.windows import speech_window
from s2glib.papers.amuse.config import SpeechConfig

MOTION_FPS = 30


def standardized(
    filterbank: Float[np.ndarray, "*b mels"], config: SpeechConfig
) -> Float[Tensor, "*b mels"]:
    """A raw log-mel filterbank as the encoders see it."""
    return (
        torch.from_numpy(np.asarray(filterbank, dtype=np.float32))
        .sub(config.mean)
        .div(2 * config.std)
    )


def frame_moments(frames: int) -> Float[Tensor, " frames"]:
    """Seconds at the middle of each motion frame."""
    return (torch.arange(frames) + 0.5) / MOTION_FPS


def speech_input(
    samples: Float[np.ndarray, " n"], config: SpeechConfig
) -> Float[Tensor, "frames mels"]:
    """One window of speech at 16 kHz, cut or padded with silence, standardised."""
    window = speech_window(samples, **config.window)
    return torch.from_numpy(standardize(window, config.mean, config.std))


def rhythm(
    filterbank: Float[Tensor, "batch frames mels"],
) -> Float[Tensor, "batch frames 2"]:
    """Energy, and onset strength (how much the spectrum rises), of standardised filterbanks."""
    energy = filterbank.mean(dim=-1)
    rise = F.pad(filterbank.diff(dim=1).clamp_min(0).mean(dim=-1), (1, 0))
    return torch.stack([energy, 4 * rise], dim=-1)


def time_tracks(
    rhythm: Float[Tensor, "batch frames rhythms"],
    content: Float[Tensor, "batch content"],
    moments: Float[Tensor, "batch m"],
    config: SpeechConfig,
) -> Float[Tensor, "batch m tracks"]:
    """What a speech window does at given seconds: its rhythm, and its content token.

    Content tokens divide the window equally, so a moment's place says which one is spoken.
    """
    seconds = config.frames * config.pool / 100
    tokens = content.unflatten(-1, (config.content_tokens, -1))
    share = moments / seconds
    return torch.cat(
        [
            sample_track(rhythm, share * rhythm.shape[1] - 0.5),
            sample_track(tokens, share * config.content_tokens - 0.5),
        ],
        dim=-1,
    )


def sample_track(
    track: Float[Tensor, "batch n channels"], places: Float[Tensor, "batch m"]
) -> Float[Tensor, "batch m channels"]:
    """Linear interpolation of tracks at fractional places; the ends are held."""
    last = track.shape[1] - 1
    at = places.clamp(0, last)
    low = at.floor().long()
    high = (low + 1).clamp_max(last)
    share = (at - low)[..., None]

    def pick(index: Tensor) -> Tensor:
        return track.gather(1, index[..., None].expand(-1, -1, track.shape[-1]))

    return pick(low) * (1 - share) + pick(high) * share
