"""The puppet's pose: every point that is drawn, frame by frame, and the keypoints among them.

Points are carried by the bones of the body; the face curves pull those of the face. Head and hands
are drawn a little larger than life so that they can be read in a small picture.

Paper:    MDD C (13 points of the body and 21 of each hand)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float

from s2glib.body.kinematics import forward_kinematics
from s2glib.body.motion import Motion
from s2glib.body.rotations import axis_angle_to_matrix
from s2glib.body.skeleton import (
    FACE_CURVES,
    JOINT_NAMES,
    PARENTS,
    REST_JOINTS,
    REST_OFFSETS,
    joint,
)
from s2glib.corpus.appearance import HAIRS, SKINS, Appearance, Color
from s2glib.corpus.puppet.drawing import Camera, Canvas, Part, Point
from s2glib.corpus.puppet.landmarks import HEAD_NAMES, HEAD_PULLS, HEAD_REST

HEAD_SCALE, HAND_SCALE = 1.3, 1.15
_HEAD_PIVOT = np.array([0.0, 0.04, 0.0])  # on the head bone: grows down onto the neck as well
_EYE_RADIUS = 0.011
_PICTURES_AWAY = 8  # what has left the picture by more is drawn no farther off

SIDES = ("left", "right")
HAND_ORDER = ("thumb", "index", "middle", "ring", "pinky")
_TIPS = tuple(f"{side}_{finger}_tip" for side in SIDES for finger in HAND_ORDER)
_LAST_JOINTS = [joint(tip.replace("_tip", "3")) for tip in _TIPS]
_IRISES = ("left_iris", "right_iris")
_EYES = [joint("left_eye"), joint("right_eye")]
POINT_NAMES: tuple[str, ...] = (*JOINT_NAMES, *_TIPS, *_IRISES, *HEAD_NAMES)
"""The joints of the body, then finger tips, irises and the landmarks of the head."""

_HEAD_POINTS = [*_EYES, *(POINT_NAMES.index(name) for name in (*_IRISES, *HEAD_NAMES))]
_HAND_POINTS = {
    side: [
        place
        for place, name in enumerate(POINT_NAMES)
        if name.startswith(tuple(f"{side}_{finger}" for finger in HAND_ORDER))
    ]
    for side in SIDES
}


def _hand_keypoints(side: str) -> list[str]:
    """Wrist, then thumb to little finger from the base to the tip."""
    joints = ("1", "2", "3", "_tip")
    return [f"{side}_wrist"] + [f"{side}_{finger}{j}" for finger in HAND_ORDER for j in joints]


KEYPOINT_NAMES: tuple[str, ...] = (
    "nose",
    *(
        f"{side}_{name}"
        for name in ("eye", "ear", "shoulder", "elbow", "wrist", "hip")
        for side in SIDES
    ),
    *_hand_keypoints("left"),
    *_hand_keypoints("right"),
)
"""55 keypoints as MDD C counts them: 13 of the body, then 21 of the left and of the right hand.

A hand starts at its wrist and goes from the thumb to the little finger, base to tip.
"""
KEYPOINT_POINTS = [POINT_NAMES.index(name) for name in KEYPOINT_NAMES]


def _own_parts(keypoint: str) -> set[Part]:
    """The parts that a keypoint lies on."""
    if keypoint in ("nose", "left_eye", "right_eye", "left_ear", "right_ear"):
        return {Part.FACE}
    side, _, name = keypoint.partition("_")
    arm, hand = Part[f"{side}_arm".upper()], Part[f"{side}_hand".upper()]
    body = {
        "shoulder": {Part.TRUNK, arm},
        "elbow": {arm},
        "wrist": {arm, hand},
        "hip": {Part.TRUNK},
    }
    return body.get(name, {hand})


OWN_PARTS = np.array([[part in _own_parts(name) for part in Part] for name in KEYPOINT_NAMES])
"""(55, parts): whether a keypoint lies on a part, so that seeing this part means seeing it."""


class Frame(NamedTuple):
    """One frame of the puppet as the camera sees it."""

    place: dict[str, Point]  # canvas pixels
    scale: dict[str, float]  # pixels per metre there
    depth: dict[str, float]  # metres towards the camera
    turn: Float[np.ndarray, "55 3 3"]

    def between(self, first: str, second: str, share: float) -> Point:
        """A point on the way from one landmark to another."""
        return self.place[first] + share * (self.place[second] - self.place[first])


class Sketch(NamedTuple):
    """What a painter holds: the canvas, the frame to paint, and how the speaker looks."""

    canvas: Canvas
    frame: Frame
    look: Appearance

    @property
    def skin(self) -> Color:
        """The speaker's skin."""
        return SKINS[self.look.person.skin]

    @property
    def hair(self) -> Color:
        """The speaker's hair or headscarf."""
        return HAIRS[self.look.person.hair]


class Puppet(NamedTuple):
    """All points of all frames, metres, and the turns of the bones that carry them."""

    points: Float[np.ndarray, "frames points 3"]
    rotations: Float[np.ndarray, "frames 55 3 3"]

    def frames(self, camera: Camera) -> Iterator[Frame]:
        """Each frame as the camera sees it."""
        limit = _PICTURES_AWAY * camera.size
        places = camera.project(self.points).clip(-limit, limit)
        scales = camera.pixels_per_metre(self.points)
        for place, scale, points, turns in zip(
            places, scales, self.points, self.rotations, strict=True
        ):
            yield Frame(
                place=dict(zip(POINT_NAMES, place, strict=True)),
                scale=dict(zip(POINT_NAMES, scale.tolist(), strict=True)),
                depth=dict(zip(POINT_NAMES, points[:, 2].tolist(), strict=True)),
                turn=turns,
            )


def pose_puppet(motion: Motion) -> Puppet:
    """Where every drawn point is in every frame."""
    rest = torch.as_tensor(REST_JOINTS, dtype=torch.float64)
    local = axis_angle_to_matrix(motion.poses.double())
    kinematics = forward_kinematics(local, rest, PARENTS)
    turns = kinematics.rotations.numpy()
    joints = (kinematics.positions + motion.trans.double()[:, None]).numpy()
    return Puppet(_all_points(joints, turns, _curves(motion)), turns)


def _curves(motion: Motion) -> Float[np.ndarray, "frames curves"]:
    """The face curves and the jaw, kept where a face can follow."""
    face = motion.expression[:, : len(FACE_CURVES)].double().clamp(0, 1)
    jaw = motion.poses[:, joint("jaw"), :1].double().clamp(-0.05, 0.5)
    return torch.cat([face, jaw], dim=-1).numpy()


def _all_points(joints: np.ndarray, turns: np.ndarray, curves: np.ndarray) -> np.ndarray:
    """The points of `POINT_NAMES`, (t, points, 3), heads and hands enlarged."""
    tips = joints[:, _LAST_JOINTS] + 0.85 * np.einsum(
        "tjab,jb->tja", turns[:, _LAST_JOINTS], REST_OFFSETS[_LAST_JOINTS]
    )
    irises = joints[:, _EYES] + _EYE_RADIUS * turns[..., 2][:, _EYES]
    head, head_turn = joints[:, joint("head")], turns[:, joint("head")]
    face = HEAD_REST + np.einsum("tc,cnd->tnd", curves, HEAD_PULLS)
    face = head[:, None] + np.einsum("tab,tnb->tna", head_turn, face)
    points = np.concatenate([joints, tips, irises, face], axis=1)
    _enlarge(points, _HEAD_POINTS, head + head_turn @ _HEAD_PIVOT, HEAD_SCALE)
    for side, hand in _HAND_POINTS.items():
        _enlarge(points, hand, joints[:, joint(f"{side}_wrist")], HAND_SCALE)
    return points


def _enlarge(points: np.ndarray, which: list[int], pivot: np.ndarray, factor: float) -> None:
    points[:, which] += (factor - 1) * (points[:, which] - pivot[:, None])
