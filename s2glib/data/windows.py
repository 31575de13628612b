"""Fixed windows of speech and motion, cut and padded the same way for training and for use.

Paper:    AM B.4 (10 s segments), MDD B.5 (3.2 s), PT A.2
Notebook: notebooks/08_speech_patches.ipynb
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float, Float32

from s2glib.audio import filterbank

WINDOW, HOP = 400, 160  # samples of a filterbank's frame and step at 16 kHz
NOISE_FLOOR_DB = -58.0  # the corpus' own noise floor; anything quieter is heard as this


@lru_cache
def noise_floor(n_mels: int) -> Float32[np.ndarray, " mels"]:
    """Mean log-mel spectrum of white noise at the noise floor: what silence looks like."""
    rng = np.random.default_rng(0)
    noise = rng.normal(0, 10 ** (NOISE_FLOOR_DB / 20), 16000 * 8).astype(np.float32)
    return filterbank(noise, n_mels=n_mels, frames=None).mean(axis=0)


def speech_window(
    samples: Float[np.ndarray, " n"], *, n_mels: int, frames: int, pool: int
) -> Float32[np.ndarray, "frames mels"]:
    """Log-mel filterbank of one window of speech at 16 kHz, never below the noise floor.

    Frames after the end of the sound are the noise floor itself, one constant spectrum, so that
    no model is asked to predict noise.

    Args:
        samples: mono speech at 16 kHz; what is longer than the window is cut.
        n_mels: mel filters.
        frames: frames of the window, each `pool` x 10 ms.
        pool: how many 10 ms frames are averaged into one.
    """
    floor = noise_floor(n_mels)
    samples = samples[: (frames * pool - 1) * HOP + WINDOW]
    if len(samples) < WINDOW:
        samples = np.pad(samples, (0, WINDOW - len(samples)))
    sound = filterbank(samples, n_mels=n_mels, frames=None)[: frames * pool]
    window = np.broadcast_to(floor, (frames * pool, n_mels)).copy()
    np.maximum(sound, floor, out=window[: len(sound)])
    return window.reshape(frames, pool, n_mels).mean(axis=1)


def spoken_frames(seconds: float, *, frames: int, pool: int) -> int:
    """How many frames of a window of speech hold sound rather than padding."""
    return min(frames, int(np.ceil(seconds * 100 / pool)))
