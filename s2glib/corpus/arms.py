"""From hand paths to joint rotations: analytic two-bone arms that keep clear of the body.

Everything is in the chest's frame (joint `spine3`): x to the body's left, y up, z forward.

Paper:    AM C.2 (self-penetration as a fault of retargeted gestures), method: ours
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from s2glib.body.skeleton import REST_JOINTS, REST_OFFSETS, joint
from s2glib.corpus.strokes import SIDES, HandPath, smooth

UPPER = float(np.linalg.norm(REST_OFFSETS[joint("left_elbow")]))  # metres
FOREARM = float(np.linalg.norm(REST_OFFSETS[joint("left_wrist")]))
ARM = UPPER + FOREARM
_SOFT, _LIMIT, _NEAREST = 0.80, 0.96, 0.30  # of ARM: where reach softens, ends, and begins
_TWIST_LIMIT = 2.2  # radians; the forearm takes 70 % of it, the wrist the rest
_CHEST = REST_JOINTS[joint("spine3")]
_HEAD_CENTRE = REST_JOINTS[joint("head")] - _CHEST + (0.0, 0.07, 0.02)
_HEAD_RADII = np.array([0.135, 0.18, 0.165])  # the head and a hand's thickness
_TORSO_CENTRE = np.array([0.0, 0.0, -0.02])
_TORSO_RADII = np.array([0.20, 0.175])  # half width and half depth, with a hand's thickness
_NECKLINE = 0.16  # metres above the chest joint
_APART = 0.15  # metres between the middles of the hands
_HAND_POINTS = (0.0, 0.09, 0.17)  # metres from the wrist towards the finger tips


class Arm(NamedTuple):
    """Local rotations of one arm (frames,) and the hand's direction in the chest frame."""

    shoulder: Rotation
    elbow: Rotation
    wrist: Rotation
    hand: np.ndarray  # (frames, 3)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True).clip(1e-9)


def _about(axis: tuple[float, float, float], angles: np.ndarray) -> Rotation:
    return Rotation.from_rotvec(np.outer(angles, axis))


def _frame(along: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Orthonormal frames (n, 3, 3): `along`, `side` made orthogonal to it, and their cross."""
    x = _unit(along)
    y = _unit(side - (side * x).sum(-1, keepdims=True) * x)
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def shoulder_places(collars: dict[str, Rotation]) -> dict[str, np.ndarray]:
    """Where the shoulders are (frames, 3), metres in the chest frame."""
    return {
        side: REST_OFFSETS[joint(f"{side}_collar")]
        + collars[side].apply(REST_OFFSETS[joint(f"{side}_shoulder")])
        for side in SIDES
    }


def wrist_targets(path: HandPath, side: str, shoulder: np.ndarray) -> np.ndarray:
    """Wrist places (frames, 3) in metres: arm lengths scaled, and kept within soft reach."""
    sign = np.array([1.0 if side == "left" else -1.0, 1.0, 1.0])
    reach = path.wrist * sign
    distance = np.linalg.norm(reach, axis=1, keepdims=True).clip(1e-6)
    room = _LIMIT - _SOFT
    soft = np.where(
        distance < _SOFT, distance, _SOFT + room * np.tanh((distance - _SOFT) / room)
    ).clip(_NEAREST)
    return shoulder + reach * (soft / distance) * ARM


def solve_arm(
    wrist: np.ndarray,
    palm: np.ndarray,
    side: str,
    shoulder: np.ndarray,
    collar: Rotation,
    elbow_out: float,
) -> Arm:
    """Two-bone inverse kinematics: the elbow hangs down and out, the palm faces `palm`.

    Args:
        wrist: (frames, 3) metres in the chest frame.
        palm: (frames, 3) palm normal; its x counts outwards, to the hand's own side.
        side: "left" or "right".
        shoulder: (frames, 3) metres in the chest frame.
        collar: the collar's rotation.
        elbow_out: how far the elbow stays from the body, arm lengths.
    """
    sign = 1.0 if side == "left" else -1.0
    reach = wrist - shoulder
    distance = np.linalg.norm(reach, axis=1).clip(_NEAREST * ARM, _LIMIT * ARM)
    u = _unit(reach)
    wrist = shoulder + u * distance[:, None]
    pole = np.stack(
        [
            sign * (0.45 + 2 * elbow_out + 0.3 * np.maximum(0, reach[:, 1] / ARM + 0.3)),
            np.full(len(u), -1.0),
            np.full(len(u), -0.35),
        ],
        axis=1,
    )
    pole = _unit(pole - (pole * u).sum(-1, keepdims=True) * u)
    cosine = (UPPER**2 + distance**2 - FOREARM**2) / (2 * UPPER * distance)
    cosine = cosine.clip(-1, 1)[:, None]
    elbow = UPPER * (cosine * u + np.sqrt(1 - cosine**2) * pole)
    forearm = wrist - shoulder - elbow
    hinge = np.cross(pole, u)
    rest_hinge = np.array([[0.0, -sign, 0.0]])
    upper_rest = REST_OFFSETS[joint(f"{side}_elbow")][None]
    fore_rest = REST_OFFSETS[joint(f"{side}_wrist")][None]
    upper_turn = Rotation.from_matrix(
        _frame(elbow, hinge) @ _frame(upper_rest, rest_hinge).transpose(0, 2, 1)
    )
    fore_turn = Rotation.from_matrix(
        _frame(forearm, hinge) @ _frame(fore_rest, rest_hinge).transpose(0, 2, 1)
    )
    twist = _forearm_twist(fore_turn, forearm, palm * [sign, 1, 1], fore_rest)
    bend = sign * (0.15 + 0.25 * smooth((palm[:, 1:2] > 0.5).astype(float), 5)[:, 0])
    wrist_turn = _about((1.0, 0.0, 0.0), 0.3 * twist) * _about((0.0, 0.0, 1.0), bend)
    elbow_turn = fore_turn * _about((1.0, 0.0, 0.0), 0.7 * twist)
    hand = (elbow_turn * wrist_turn).apply(fore_rest[0] / FOREARM)
    return Arm(collar.inv() * upper_turn, upper_turn.inv() * elbow_turn, wrist_turn, hand)


def _forearm_twist(fore_turn, forearm, palm, fore_rest):
    """(frames,) radians about the forearm that turn the palm, without jumps."""
    palm_rest = np.array([[0.0, -1.0, 0.0]])
    wanted = _frame(forearm, palm) @ _frame(fore_rest, palm_rest).transpose(0, 2, 1)
    turn = fore_turn.inv().as_matrix() @ wanted
    angle = np.unwrap(np.arctan2(turn[:, 2, 1], turn[:, 1, 1]))
    angle -= 2 * np.pi * np.round(np.median(angle) / (2 * np.pi))
    return smooth(np.clip(angle, -_TWIST_LIMIT, _TWIST_LIMIT)[:, None], 5)[:, 0]


def push_out_of_body(points: np.ndarray) -> np.ndarray:
    """How far (frames,) points must move forward to leave the head and the torso, metres."""
    x, y, z = (points - _HEAD_CENTRE).T / _HEAD_RADII[:, None]
    front = np.sqrt(np.clip(1 - x**2 - y**2, 0, None))
    head = np.clip(front - z, 0, None) * (x**2 + y**2 < 1) * _HEAD_RADII[2]
    head = head * (z > -1)
    x, z = (points[:, [0, 2]] - _TORSO_CENTRE[[0, 2]]).T / _TORSO_RADII[:, None]
    front = np.sqrt(np.clip(1 - x**2, 0, None))
    torso = np.clip(front - z, 0, None) * (np.abs(x) < 1) * (z > -1) * _TORSO_RADII[1]
    torso = torso * (points[:, 1] < _NECKLINE)
    return np.maximum(head, torso)


def clear_of_body(
    wrists: dict[str, np.ndarray], hands: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Shift wrists so that hands leave the head, the torso and each other.

    Args:
        wrists: by side, (frames, 3) metres in the chest frame.
        hands: by side, (frames, 3) direction from the wrist to the fingers.
    """
    shifts = {side: np.zeros_like(wrists[side]) for side in SIDES}
    for side in SIDES:
        points = [wrists[side] + along * hands[side] for along in _HAND_POINTS]
        shifts[side][:, 2] = np.max([push_out_of_body(p) for p in points], axis=0)
    middle = {side: wrists[side] + 0.08 * hands[side] + shifts[side] for side in SIDES}
    gap = middle["left"] - middle["right"]
    distance = np.linalg.norm(gap, axis=1, keepdims=True)
    missing = np.clip(_APART - distance, 0, None) / 2
    away = np.where(distance > 0.02, _unit(gap), [[1.0, 0.0, 0.0]])
    return {
        side: wrists[side] + _held(shifts[side] + sign * missing * away)
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True)
    }


def _held(shift: np.ndarray, width: int = 7) -> np.ndarray:
    """Let a shift begin before it is needed and fade after: no jumps, and never too little."""
    padded = np.pad(shift, ((width // 2, width // 2), (0, 0)), mode="edge")
    nearby = np.lib.stride_tricks.sliding_window_view(padded, width, axis=0)  # (frames, 3, width)
    largest = np.linalg.norm(nearby, axis=1).argmax(axis=1)
    return smooth(np.take_along_axis(nearby, largest[:, None, None], axis=2)[..., 0], width)
