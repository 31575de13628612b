"""Gestures with known factors: a whole body that speaks a sentence in one manner and emotion.

Paper:    AM E, F (gestures of BEAT's speakers and emotions), generator: ours
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Int
from scipy.spatial.transform import Rotation
from torch import Tensor

from s2glib.body import Motion
from s2glib.body.skeleton import FACE_CURVES, PELVIS_HEIGHT, REST_OFFSETS, joint
from s2glib.corpus.arms import clear_of_body, shoulder_places, solve_arm, wrist_targets
from s2glib.corpus.bearing import Performance, perform
from s2glib.corpus.clock import SEED, Timing
from s2glib.corpus.face import face_tracks
from s2glib.corpus.lexicon import finger_poses
from s2glib.corpus.script import EMOTIONS, SENTENCES, SPEAKERS, Cell
from s2glib.corpus.strokes import (
    SIDES,
    Stroke,
    hand_keys,
    hand_path,
    meaning,
    plan_strokes,
    smooth,
    zigzag,
)

FPS = 30
_STREAM = 2
_SPINE = (("spine1", 0.30), ("spine2", 0.35), ("spine3", 0.35))
_NECK = (("neck", 0.45), ("head", 0.55))
_LEG = -float(REST_OFFSETS[joint("left_knee")][1] + REST_OFFSETS[joint("left_ankle")][1])


class Gesturing(NamedTuple):
    """A motion and what it means, frame by frame."""

    motion: Motion
    semantic: Float[np.ndarray, " frames"]
    gesture_type: Int[np.ndarray, " frames"]
    strokes: list[Stroke]


def render_gestures(cell: Cell, timing: Timing, intensity: float) -> Gesturing:
    """Move a body through one clip of the corpus.

    Args:
        cell: whose manner, which emotion, and the seed of everything that varies by chance.
        timing: the clock of the clip.
        intensity: how strongly the emotion shows, about 0 to 1.
    """
    factors = [cell.sentence, SPEAKERS.index(cell.speaker), EMOTIONS.index(cell.emotion)]
    rng = np.random.default_rng([SEED, _STREAM, *factors, cell.take])
    times = np.arange(int(timing.duration * FPS)) / FPS
    performance = perform(cell.emotion, cell.speaker, intensity, rng)
    strokes = plan_strokes(SENTENCES[cell.sentence].marks, timing, performance, rng)
    turn = zigzag(timing, times, performance, rng)
    poses = np.zeros((len(times), 55, 3))
    trans = _stand(poses, times, performance, rng)
    _move_trunk(poses, times, strokes, turn, performance, rng)
    _move_arms(poses, times, strokes, turn, timing.duration, performance, rng)
    jaw, curves = face_tracks(timing, times, cell.emotion, intensity, rng)
    poses[:, joint("jaw"), 0] = jaw
    expression = np.zeros((len(times), 100))
    expression[:, : len(FACE_CURVES)] = curves
    motion = Motion(_single(poses), _single(trans), _single(expression), FPS)
    return Gesturing(motion, *meaning(strokes, times, performance.bearing.tempo), strokes)


def _single(values: np.ndarray) -> Tensor:
    return torch.from_numpy(values).float()


def _stand(poses, times, performance: Performance, rng):
    """Shift weight from foot to foot; hips and ankles turn so that the feet stay."""
    phase = rng.uniform(0, 2 * np.pi)
    rate = 0.5 * performance.manner.sway_rate
    shift = (0.004 + 0.25 * performance.bearing.sway) * np.sin(2 * np.pi * rate * times + phase)
    tilt = -np.arcsin(np.clip(shift / _LEG, -1, 1))
    for side in SIDES:
        poses[:, joint(f"{side}_hip"), 2] = tilt
        poses[:, joint(f"{side}_ankle"), 2] = -tilt
    drop = _LEG * (1 - np.cos(tilt))
    return np.stack([shift, PELVIS_HEIGHT - drop, np.zeros_like(shift)], axis=1)


def _move_trunk(poses, times, strokes, turn, performance: Performance, rng):
    """Lean, sway and twist; nod with the strokes and on the beat."""
    bearing, manner, _ = performance
    phases = rng.uniform(0, 2 * np.pi, 3)
    noise = smooth(rng.normal(0, 1, (len(times), 6)), 31) * 0.10
    impulse = sum(
        (s.scale * np.exp(-0.5 * ((times - s.apex) / 0.10) ** 2) for s in strokes),
        np.zeros(len(times)),
    )
    rate = 2 * np.pi * manner.sway_rate * (0.6 + 0.4 * bearing.tempo)
    sway = 3 * bearing.sway
    lean = bearing.lean + 0.03 * impulse * bearing.amplitude + 0.5 * noise[:, 0]
    twist = manner.twist + 1.5 * sway * np.sin(rate * times + phases[0]) + 0.5 * noise[:, 1]
    side = sway * np.sin(rate * times + phases[1]) + 0.4 * noise[:, 2]
    for name, share in _SPINE:
        poses[:, joint(name)] = share * np.stack([lean, twist, side], axis=1)
    poses[:, 0, 1] = 0.3 * manner.twist + 0.2 * noise[:, 2]
    nod = 1.2 * bearing.nod * impulse - 0.5 * turn
    shake = 1.6 * bearing.shake * np.sin(2 * np.pi * 1.4 * bearing.tempo * times + phases[2])
    pitch = bearing.head - 0.6 * bearing.lean + nod + noise[:, 3]
    yaw = manner.yaw + shake + 1.5 * noise[:, 4]
    for name, share in _NECK:
        poses[:, joint(name)] = share * np.stack([pitch, yaw, bearing.roll + noise[:, 5]], axis=1)
    raised = bearing.shoulders + 0.05 * impulse * (bearing.amplitude - 0.5)
    poses[:, joint("left_collar"), 2] = raised
    poses[:, joint("right_collar"), 2] = -raised


def _move_arms(poses, times, strokes, turn, duration, performance: Performance, rng):
    """Follow the hand paths; where a hand would touch the body, go round it."""
    collars = {s: Rotation.from_rotvec(poses[:, joint(f"{s}_collar")]) for s in SIDES}
    shoulders = shoulder_places(collars)
    paths, wrists = {}, {}
    for side in SIDES:
        keys = hand_keys(strokes, side, duration, performance, rng)
        mine = turn * (1.0 if side == performance.manner.dominant else 0.7)
        paths[side] = hand_path(keys, times, mine, performance, rng)
        wrists[side] = wrist_targets(paths[side], side, shoulders[side])

    def solve(side):
        elbows = performance.bearing.elbows
        return solve_arm(
            wrists[side], paths[side].palm, side, shoulders[side], collars[side], elbows
        )

    for _ in range(2):
        wrists = clear_of_body(wrists, {side: solve(side).hand for side in SIDES})
    for side in SIDES:
        arm = solve(side)
        for name in ("shoulder", "elbow", "wrist"):
            poses[:, joint(f"{side}_{name}")] = getattr(arm, name).as_rotvec()
        first = joint(f"{side}_index1")
        poses[:, first : first + 15] = finger_poses(paths[side].shape, side)
