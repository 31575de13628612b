"""What ProbTalk's networks hear in training: wav2vec2 in the paper's size, log-mels in ours.

Paper:    PT A.2 (wav2vec2: authors' code)
Notebook: notebooks/11_losses_and_guidance.ipynb
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from torch import Tensor
from tqdm import tqdm

from s2glib.corpus import render_clip
from s2glib.corpus.build import Request, speech_set
from s2glib.corpus.script import Cell
from s2glib.folders import cache_folder
from s2glib.papers.probtalk.speech_features import (
    MELS,
    MOTION_FPS,
    SAMPLE_RATE,
    Hear,
    at_motion_rate,
    wav2vec2,
)
from s2glib.recipes.holistic_data import single

WAV2VEC2 = "weights/wav2vec2-base-960h"  # a folder in the cache, if the reader has put it there


class Hearing(NamedTuple):
    """Speech features of clips.

    Attributes:
        channels: numbers a frame.
        tracks: what is heard in each of some clips, at the motion's rate.
    """

    channels: int
    tracks: Callable[[Sequence[Cell]], Iterable[Float[Tensor, "frames channels"]]]


def hearing(preset: str) -> Hearing:
    """wav2vec2 for the paper's preset if its public files are there, else log-mels."""
    folder = cache_folder() / WAV2VEC2
    if preset != "paper" or not folder.exists():
        return Hearing(MELS, log_mel_tracks)
    hear = wav2vec2(folder)
    channels = hear(np.zeros(SAMPLE_RATE, np.float32), MOTION_FPS).shape[-1]
    return Hearing(channels, lambda cells: heard_by(hear, cells))


def log_mel_tracks(cells: Sequence[Cell]) -> Iterator[Float[Tensor, "frames 64"]]:
    """Standardised log-mels out of the cache."""
    for window in speech_set([Request(cell) for cell in cells]).windows:
        yield at_motion_rate(single(window))


def heard_by(hear: Hear, cells: Sequence[Cell]) -> Iterator[Float[Tensor, "frames channels"]]:
    """Features of sounds that are rendered anew."""
    for cell in tqdm(cells, desc="listening", unit="clip"):
        sound = render_clip(*cell).waveform
        assert sound is not None
        yield hear(sound.samples, len(sound.samples) * MOTION_FPS // SAMPLE_RATE)
