"""Motion clips of any length as windows of features, with the speech that belongs to them.

Paper:    AM C.1, F
Notebook: notebooks/12_motion_prior.ipynb
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.corpus.build import Request, motion_set
from s2glib.corpus.script import EMOTIONS, Cell, speech_take, split
from s2glib.papers.amuse.disentangler import SpeechLatents
from s2glib.papers.amuse.motion_features import MotionFeatures, motion_features

FURTHER_TAKES = range(10, 16)  # of the motion takes; more cost rendering time only
EDITED_TAKES = range(16, 20)  # of the motion takes; performed on another emotion's clock


class MotionWindows:
    """Features of many clips; windows are cut from them at any frame.

    Args:
        cells: which clip each motion belongs to.
        poses: half-precision poses of each clip.
        features: how poses become features.
        frames: length of a window.
    """

    def __init__(
        self,
        cells: Sequence[Cell],
        poses: Sequence[np.ndarray],
        features: MotionFeatures,
        frames: int,
    ):
        self.cells, self.frames = list(cells), frames
        self.emotion = torch.tensor([EMOTIONS.index(cell.emotion) for cell in cells])
        self.lengths = np.array([len(p) for p in poses])
        self.starts = np.concatenate([[0], np.cumsum(self.lengths)[:-1]])
        with torch.no_grad():
            parts = [features.from_poses(torch.from_numpy(p).float()).half() for p in poses]
        self.track = torch.cat(parts)

    def window(
        self, clips: np.ndarray, offsets: np.ndarray
    ) -> Float[Tensor, "batch frames features"]:
        """Cut windows; after a clip's end its last frame is held."""
        inside = offsets[:, None] + np.arange(self.frames)
        inside = np.minimum(inside, self.lengths[clips][:, None] - 1)
        return self.track[torch.from_numpy(self.starts[clips][:, None] + inside)].float()

    def any_offset(self, clips: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """A random start in each clip such that the window fits, or 0 in short clips."""
        room = np.maximum(self.lengths[clips] - self.frames, 0)
        return (rng.random(len(clips)) * (room + 1)).astype(int)

    def first(self) -> Float[Tensor, "n frames features"]:
        """The first window of every clip."""
        return self.window(np.arange(len(self.cells)), np.zeros(len(self.cells), int))


def motion_cells() -> list[Cell]:
    """The training cells' performances: takes 0 and 1, and some of the further takes."""
    train, motion = set(split("train")), split("motion")
    performances = [
        c
        for c in motion
        if c.take in FURTHER_TAKES and c._replace(take=speech_take(c.take)) in train
    ]
    return [*split("train"), *performances]


def edited_performances() -> list[Request]:
    """What a swap of the emotion should look like: further takes on another emotion's clock.

    Emotion and speech of a performance are both heard in the training clips, in two of them.
    """
    train, rng = set(split("train")), np.random.default_rng(EDITED_TAKES.start)
    found = []
    for cell in split("motion"):
        clock = str(rng.choice([name for name in EMOTIONS if name != cell.emotion]))
        heard = cell._replace(take=speech_take(cell.take))
        if cell.take in EDITED_TAKES and {heard, heard._replace(emotion=clock)} <= train:
            found.append(Request(cell, clock))
    return found


def motion_windows(
    wanted: Sequence[Cell] | Sequence[Request], features: MotionFeatures, frames: int
) -> MotionWindows:
    """Render (or read) the motion of cells."""
    cells = [each.cell if isinstance(each, Request) else each for each in wanted]
    return MotionWindows(cells, motion_set(wanted).poses, features, frames)


def fit_features(cells: list[Cell], size: int) -> MotionFeatures:
    """Features of `size` numbers, fitted on every ninth frame of every seventh clip."""
    poses = motion_set(cells[::7]).poses
    features = motion_features(size)
    features.fit(torch.from_numpy(np.concatenate([p[::9] for p in poses])).float())
    return features


class SpeechOfClips(NamedTuple):
    """What the disentangler hears in many clips: latents, and rhythm over the speech window."""

    latents: SpeechLatents
    rhythm: Float[Tensor, "n frames 3"]

    def take(self, index: Tensor) -> "SpeechOfClips":
        """Some of the clips."""
        return SpeechOfClips(
            SpeechLatents(*(latent[index] for latent in self.latents)), self.rhythm[index]
        )


def speech_row(cells: Sequence[Cell], spoken: Sequence[Cell]) -> np.ndarray:
    """For each motion clip the row of its speech; -1 where that was not rendered."""
    rows = {cell: row for row, cell in enumerate(spoken)}
    return np.array([rows.get(c._replace(take=speech_take(c.take)), -1) for c in cells])
