"""Speech at the rate of motion: wav2vec2, or the log-mels that stand in for it.

Paper:    PT A.2 (wav2vec2: authors' code); log-mels: ours
Notebook: notebooks/06_masked_prediction.ipynb
"""

import math
import os
from collections.abc import Callable

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.audio import Waveform, load_speech_model, wav2vec2_features
from s2glib.data.windows import speech_window

MOTION_FPS = 30
SAMPLE_RATE = 16000
MELS = 64
LOG_MEL_MEAN, LOG_MEL_STD = -6.3, 3.4  # of the corpus
_POOL = 2  # 10 ms frames averaged into one
_HEARD_RATE = 100 / _POOL  # frames a second of the log-mels
_SHORTEST = math.ceil(SAMPLE_RATE / MOTION_FPS)  # samples of a motion frame

Hear = Callable[[Float[np.ndarray, " n"], int], Float[Tensor, "frames channels"]]
"""From samples at 16 kHz to that many frames of speech, also after the sound's end."""


def check_speech(waveform: Waveform) -> None:
    """Refuse what is no speech.

    Raises:
        TypeError: if it is no Waveform.
    """
    if not isinstance(waveform, Waveform):
        raise TypeError(
            f"speech comes as a Waveform, got {type(waveform).__name__}; read a file with "
            "s2glib.audio.load"
        )


def motion_frames(waveform: Waveform) -> int:
    """How many frames of motion go with a recording: those that fit, as in the corpus; 1 or more.

    Raises:
        TypeError: if it is no Waveform.
    """
    check_speech(waveform)
    return max(1, len(waveform.samples) * MOTION_FPS // waveform.sample_rate)


def log_mels(samples: Float[np.ndarray, " n"], frames: int) -> Float[Tensor, "frames 64"]:
    """Standardised log-mels of every motion frame; after the sound's end, the noise floor.

    Args:
        samples: mono, at 16 kHz.
        frames: of motion, 30 a second.
    """
    heard = math.ceil((frames + 1) * _HEARD_RATE / MOTION_FPS)
    window = speech_window(samples, n_mels=MELS, frames=heard, pool=_POOL)
    return at_motion_rate(torch.from_numpy(window))[:frames]


def at_motion_rate(window: Float[Tensor, "*b heard mels"]) -> Float[Tensor, "*b frames mels"]:
    """Raw log-mels of `speech_window`, 50 frames a second, standardised and resized to 30.

    A motion frame hears what sounds at its middle, by linear interpolation.
    """
    heard = window.shape[-2]
    moments = (torch.arange(int(heard * MOTION_FPS / _HEARD_RATE)) + 0.5) / MOTION_FPS
    places = (moments * _HEARD_RATE - 0.5).clamp(0, heard - 1)
    low = places.floor().long()
    share = (places - low)[:, None]
    high = (low + 1).clamp_max(heard - 1)
    resized = window[..., low, :] * (1 - share) + window[..., high, :] * share
    return (resized - LOG_MEL_MEAN) / LOG_MEL_STD


def wav2vec2(folder: str | os.PathLike) -> Hear:
    """The authors' speech features: wav2vec2's last hidden layer, 768 numbers a frame.

    After the sound's end the last frame is held: to pad the sound would change all of them.

    Args:
        folder: a local copy of wav2vec2-base-960h in Hugging Face's layout.

    Raises:
        ImportError: if transformers is not installed.
        ValueError: if the folder holds no such model.
    """
    model = load_speech_model(folder)

    def hear(samples: Float[np.ndarray, " n"], frames: int) -> Float[Tensor, "frames channels"]:
        sound = np.pad(samples, (0, max(0, _SHORTEST - len(samples))))
        heard = torch.from_numpy(wav2vec2_features(model, sound, fps=MOTION_FPS))
        return heard[torch.arange(frames).clamp_max(len(heard) - 1)]

    return hear
