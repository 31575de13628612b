"""Test clips as the speech models hear them.

Paper:    AM B.4
Notebook: notebooks/09_disentanglement.ipynb
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from s2glib.corpus.build import Request, speech_set
from s2glib.corpus.script import EMOTIONS, SPEAKERS, Cell
from s2glib.data.windows import spoken_frames
from s2glib.layers import in_batches
from s2glib.papers.amuse.config import SpeechConfig
from s2glib.papers.amuse.disentangler import SpeechDisentangler, SpeechLatents
from s2glib.papers.amuse.front_end import standardized


class SpeechClips(NamedTuple):
    """Clips with their standardised filterbanks and their lengths."""

    cells: list[Cell]
    windows: Float[Tensor, "n frames mels"]
    seconds: Float[np.ndarray, " n"]

    @property
    def sentence(self) -> Int[np.ndarray, " n"]:
        """Number of each clip's sentence."""
        return np.array([cell.sentence for cell in self.cells])

    @property
    def emotion(self) -> Int[np.ndarray, " n"]:
        """Number of each clip's emotion."""
        return np.array([EMOTIONS.index(cell.emotion) for cell in self.cells])

    @property
    def style(self) -> Int[np.ndarray, " n"]:
        """Number of each clip's voice."""
        return np.array([SPEAKERS.index(cell.speaker) for cell in self.cells])

    def at(self, rows: Int[np.ndarray, " m"]) -> "SpeechClips":
        """Some of the clips."""
        return SpeechClips(
            [self.cells[row] for row in rows], self.windows[rows], self.seconds[rows]
        )


class Encoded(NamedTuple):
    """Clips and what the disentangler hears in them."""

    clips: SpeechClips
    latents: SpeechLatents

    def at(self, rows: Int[np.ndarray, " m"]) -> "Encoded":
        """Some of the clips."""
        latents = SpeechLatents(*(latent[rows] for latent in self.latents))
        return Encoded(self.clips.at(rows), latents)


def speech_clips(requests: Sequence[Request], config: SpeechConfig) -> SpeechClips:
    """Read clips from the cache, or render them.

    Raises:
        ImportError: without the extra `corpus`, where the cache lacks a clip.
    """
    found = speech_set(requests, config.window)
    windows = standardized(found.windows, config)
    return SpeechClips([request.cell for request in requests], windows, found.seconds)


def encode_clips(model: SpeechDisentangler, cells: Sequence[Cell]) -> Encoded:
    """Read or render clips and encode them as they are."""
    clips = speech_clips([Request(cell) for cell in cells], model.config)
    return Encoded(clips, in_batches(model.encode, clips.windows))


def decoded_errors(
    model: SpeechDisentangler, latents: SpeechLatents, target: SpeechClips
) -> Float[np.ndarray, " n"]:
    """L1 of each decoded clip to its target, over the target's frames that hold speech."""
    config = model.config
    ends = [spoken_frames(s, frames=config.frames, pool=config.pool) for s in target.seconds]
    spoken = torch.arange(config.frames) < torch.tensor(ends)[:, None]
    by_frame = (in_batches(model.decoder, *latents) - target.windows).abs().mean(dim=-1)
    return ((by_frame * spoken).sum(1) / spoken.sum(1)).double().numpy()


def is_right(
    scores: Float[Tensor, "n classes"], labels: Int[np.ndarray, " n"]
) -> Bool[np.ndarray, " n"]:
    """Whether the highest score is the label's."""
    return scores.argmax(dim=-1).numpy() == labels
