"""Holistic motion of many clips, and the speech that belongs to it, cut into windows.

Paper:    PT A.1, A.2
Notebook: notebooks/07_refiner.ipynb
"""

from collections.abc import Callable, Iterable, Sequence

import numpy as np
import torch
from jaxtyping import Float, Int, Shaped
from torch import Tensor
from torch.nn import functional as F

from s2glib.body import FACE_CURVES
from s2glib.corpus.build import face_set, motion_set
from s2glib.corpus.script import Cell, speech_take
from s2glib.papers.probtalk import HolisticFeatures, PQVAEConfig

_COEFFICIENTS = 100  # of a motion's expression


class Tracks:
    """Tracks of any length, kept end to end in half precision, cut into windows.

    Args:
        tracks: (frames, channels) each.
    """

    def __init__(self, tracks: Iterable[Float[Tensor, "_ channels"]]):
        kept = [track.half() for track in tracks]
        self.lengths = np.array([len(track) for track in kept])
        self.starts = np.concatenate([[0], np.cumsum(self.lengths)[:-1]])
        self.frames = torch.cat(kept)

    def window(
        self, rows: Int[np.ndarray, " n"], offsets: Int[np.ndarray, " n"], frames: int
    ) -> Float[Tensor, "n frames channels"]:
        """Cut windows; after a track's end its last frame is held.

        Args:
            rows: which tracks.
            offsets: where in them the windows begin.
            frames: length of a window.
        """
        inside = np.minimum(offsets[:, None] + np.arange(frames), self.lengths[rows][:, None] - 1)
        return self.frames[torch.from_numpy(self.starts[rows][:, None] + inside)].float()


class HolisticClips:
    """Features of many clips, and where it was asked for what is heard in them, frame by frame.

    Attributes:
        cells: which clip is which.
        motion: features of `HolisticFeatures`.
        speech: at the motion's frame rate; performances of one speech share a track.
    """

    def __init__(
        self,
        cells: Sequence[Cell],
        motion: Tracks,
        speech: Tracks | None = None,
        speech_rows: Int[np.ndarray, " n"] | None = None,
    ):
        self.cells, self.motion, self.speech, self.speech_rows = cells, motion, speech, speech_rows

    def any_offset(
        self, clips: Int[np.ndarray, " n"], frames: int, rng: np.random.Generator
    ) -> Int[np.ndarray, " n"]:
        """A random start in each clip such that the window fits, or 0 in short clips.

        Where there is speech, the window ends before the speech does.
        """
        lengths = self.motion.lengths[clips]
        if self.speech is not None and self.speech_rows is not None:
            lengths = np.minimum(lengths, self.speech.lengths[self.speech_rows[clips]])
        room = np.maximum(lengths - frames, 0)
        return (rng.random(len(clips)) * (room + 1)).astype(int)

    def moving(
        self, clips: Int[np.ndarray, " n"], offsets: Int[np.ndarray, " n"], frames: int
    ) -> Float[Tensor, "n frames size"]:
        """Windows of features."""
        return self.motion.window(clips, offsets, frames)

    def heard(
        self, clips: Int[np.ndarray, " n"], offsets: Int[np.ndarray, " n"], frames: int
    ) -> Float[Tensor, "n frames channels"]:
        """The speech of the same windows; after a clip's end it is the noise floor.

        Raises:
            ValueError: if the clips were gathered without speech.
        """
        if self.speech is None or self.speech_rows is None:
            raise ValueError("these clips have no speech; gather them with `hear`")
        return self.speech.window(self.speech_rows[clips], offsets, frames)

    def first(self, frames: int) -> Float[Tensor, "n frames size"]:
        """The first window of every clip."""
        clips = np.arange(len(self.cells))
        return self.moving(clips, np.zeros_like(clips), frames)


Listen = Callable[[Sequence[Cell]], Iterable[Float[Tensor, "frames channels"]]]


def holistic_clips(
    cells: Sequence[Cell], features: HolisticFeatures, *, hear: Listen | None = None
) -> HolisticClips:
    """Render (or read) the motion of cells, and their speech.

    Args:
        cells: which clips.
        features: how poses and faces become features.
        hear: the speech of clips at the motion's rate, see `Hearing.tracks`; without it, the
            clips have none.
    """
    with torch.no_grad():
        pairs = zip(motion_set(cells).poses, face_set(cells), strict=True)
        motion = Tracks(
            features.from_motion(single(poses), whole_face(face)) for poses, face in pairs
        )
    if hear is None:
        return HolisticClips(cells, motion)
    spoken = list(dict.fromkeys(spoken_cell(cell) for cell in cells))
    speech = Tracks(hear(spoken))
    rows = {cell: row for row, cell in enumerate(spoken)}
    return HolisticClips(cells, motion, speech, np.array([rows[spoken_cell(c)] for c in cells]))


def spoken_cell(cell: Cell) -> Cell:
    """The cell whose sound a cell shares."""
    return cell._replace(take=speech_take(cell.take))


def single(values: Shaped[np.ndarray, "..."]) -> Float[Tensor, "..."]:
    """Half precision out of the cache, as single."""
    return torch.from_numpy(values).float()


def whole_face(curves: Float[np.ndarray, "frames curves"]) -> Float[Tensor, "frames 100"]:
    """Face curves as a motion's expression."""
    return F.pad(single(curves), (0, _COEFFICIENTS - len(FACE_CURVES)))


def fitted_features(cells: Sequence[Cell], config: PQVAEConfig) -> HolisticFeatures:
    """Features whose statistics are those of every ninth frame of every seventh clip."""
    some = cells[::7]
    poses = np.concatenate([poses[::9] for poses in motion_set(some).poses])
    faces = np.concatenate([face[::9] for face in face_set(some)])
    features = HolisticFeatures(config.expression, config.statistics)
    features.fit(single(poses), whole_face(faces))
    return features
