"""Exercise 01-3: the same motion at another frame rate.

Paper:    MDD 4.1 (clips at 25 fps)
Notebook: -
"""

import math
from collections.abc import Callable, Iterator

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import normalize

from s2glib.body import Motion, axis_angle_to_matrix, matrix_to_axis_angle
from s2glib.corpus import resample_motion
from s2glib.teaching.exercises.exercise import Exercise, Mutant

Mix = Callable[[Tensor, Tensor, Tensor], Tensor]


def some_motion(rng: np.random.Generator, frames: int, fps: int) -> Motion:
    """Any poses at all, so that the shortest way from one to the next is never straight."""
    poses = normalize(torch.tensor(rng.normal(size=(frames, 55, 3))), dim=-1)
    poses *= torch.tensor(rng.uniform(0, 3, size=(frames, 55, 1)))
    trans, face = rng.normal(size=(frames, 3)), rng.normal(size=(frames, 100))
    return Motion(poses, torch.tensor(trans), torch.tensor(face), fps)


def rate_inputs(rng: np.random.Generator) -> Iterator[tuple[Motion, int]]:
    """From each rate to the other, and to a rate at which the last frames see no later one."""
    for fps, new in ((30, 25), (25, 30), (25, 60)):
        yield some_motion(rng, 7, fps), new


def rate_oracle(motion: Motion, fps: int) -> Motion:
    """SciPy's spherical interpolation of every joint, and numpy's straight one of every number."""
    from scipy.spatial.transform import Rotation, Slerp

    old = np.arange(motion.frames) / motion.fps
    new = np.arange(int(motion.frames * fps / motion.fps)) / fps
    inside = new.clip(max=old[-1])
    tracks = [
        Slerp(old, Rotation.from_rotvec(joint))(inside).as_rotvec()
        for joint in motion.poses.numpy().swapaxes(0, 1)
    ]

    def straight(track: Tensor) -> Tensor:
        columns = [np.interp(new, old, column) for column in track.numpy().T]
        return torch.tensor(np.stack(columns, axis=1))

    poses = torch.tensor(np.stack(tracks, axis=1))
    return Motion(poses, straight(motion.trans), straight(motion.expression), fps)


def _turned(start: Tensor, stop: Tensor, share: Tensor) -> Tensor:
    R = axis_angle_to_matrix(start)
    step = matrix_to_axis_angle(R.mT @ axis_angle_to_matrix(stop))
    return matrix_to_axis_angle(R @ axis_angle_to_matrix(share * step))


def _looked_up(motion: Motion, fps: float | int, places: Tensor, mix: Mix = _turned) -> Motion:
    """The motion at some places among its frames, such as 1.5."""
    places = places.clamp(max=motion.frames - 1)
    before, share = places.floor().long(), places.frac()
    after = (before + 1).clamp(max=motion.frames - 1)

    def track(values: Tensor, mix: Mix) -> Tensor:
        ones = [1] * (values.ndim - 1)
        return mix(values[before], values[after], share.reshape(-1, *ones))

    trans, face = (track(values, torch.lerp) for values in (motion.trans, motion.expression))
    return Motion(track(motion.poses, mix), trans, face, fps)


def _numbers(motion: Motion, fps: int) -> Tensor:
    return torch.arange(math.floor(motion.duration * fps), dtype=motion.poses.dtype)


def stretched(motion: Motion, fps: int) -> Motion:
    """The last frame of one is the last frame of the other."""
    places = torch.linspace(0, motion.frames - 1, len(_numbers(motion, fps)), dtype=torch.float64)
    return _looked_up(motion, fps, places)


def upside_down(motion: Motion, fps: int) -> Motion:
    """The rates are divided the wrong way round."""
    return _looked_up(motion, fps, _numbers(motion, fps) * fps / motion.fps)


def unmixed(motion: Motion, fps: int) -> Motion:
    """Each new frame is the old one before it."""
    return _looked_up(motion, fps, (_numbers(motion, fps) * motion.fps / fps).floor())


def straight_angles(motion: Motion, fps: int) -> Motion:
    """Axis-angles are mixed like places."""
    return _looked_up(motion, fps, _numbers(motion, fps) * motion.fps / fps, torch.lerp)


def half_a_frame_late(motion: Motion, fps: int) -> Motion:
    """Each frame shows the middle of its time."""
    return _looked_up(motion, fps, (_numbers(motion, fps) + 0.5) * motion.fps / fps)


def old_rate(motion: Motion, fps: int) -> Motion:
    """The new motion says that it has the old rate."""
    return _looked_up(motion, motion.fps, _numbers(motion, fps) * motion.fps / fps)


RATE = Exercise(
    id="01-3",
    title="the same motion at another rate",
    reference=resample_motion,
    inputs=rate_inputs,
    oracle=rate_oracle,
    minutes=15,
    difficulty=3,
    equation="MDD 4.1",
    mutants=(
        Mutant(
            stretched,
            "You stretch the motion until its last frames meet. "
            "New frame k belongs to k / fps seconds, wherever the last one falls.",
        ),
        Mutant(
            upside_down,
            "Your rates are the wrong way round: new frame k is at k / fps seconds, "
            "which is old frame k / fps * motion.fps.",
        ),
        Mutant(
            unmixed,
            "Each of your frames shows an old one. Most fall between two: mix these by the share "
            "of the way from one to the next.",
        ),
        Mutant(
            straight_angles,
            "You mix axis-angles as if they were places, and they jump (see section 2). "
            "Go from matrix to matrix by a share of the turn between them.",
        ),
        Mutant(
            half_a_frame_late,
            "You are late by half a frame: new frame k is at k / fps seconds, "
            "not in the middle of its time.",
        ),
        Mutant(old_rate, "Your motion has the right frames but says the old rate: give it fps."),
    ),
    hints=(
        "Where does each new frame fall among the old ones? At "
        "`place = torch.arange(frames, dtype=motion.poses.dtype) / fps * motion.fps`, such as 1.2. "
        "Clamp it to the last old frame.",
        "Take `before = place.floor().long()`, `after` one more (clamp it, too), and "
        "`share = (place - before)[:, None]`. "
        "Then a straight track is `torch.lerp(track[before], track[after], share)`.",
        "For the joints, let `A` and `B` be the matrices before and after. The turn between them "
        "is `matrix_to_axis_angle(A.mT @ B)`; the new matrix is "
        "`A @ axis_angle_to_matrix(share[:, None] * turn)`.",
    ),
)
