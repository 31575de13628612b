"""Parts of the mannequin: a solid, its colour, and how its points follow the skeleton.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from s2glib.body.sculpture.solids import Solid
from s2glib.body.skeleton import JOINT_NAMES, REST_JOINTS, joint

X, Y, Z = np.eye(3)
Field = Callable[[np.ndarray], np.ndarray]


class Part(NamedTuple):
    """One solid of the mannequin; what lies beside the middle is made for the left side only."""

    name: str
    solid: Solid
    color: str | Field  # of the whole, or (v, 3) -> (v, 3)
    weights: Field  # (v, 3) -> (v, 55)


class Bend(NamedTuple):
    """Where a chain goes over to its next joint: across a plane, within `width` on both sides."""

    joint: str
    direction: np.ndarray
    width: float


SPINE = (
    Bend("spine1", Y, 0.06),
    Bend("spine2", Y, 0.06),
    Bend("spine3", Y, 0.05),
    Bend("neck", Y, 0.04),
    Bend("head", Y, 0.05),
)
ARM = (
    Bend("left_collar", X, 0.05),
    Bend("left_shoulder", X, 0.065),
    Bend("left_elbow", X, 0.032),
    Bend("left_wrist", X, 0.022),
)
LEG = (
    Bend("left_hip", -Y, 0.08),
    Bend("left_knee", -Y, 0.05),
    Bend("left_ankle", -Y, 0.03),
    Bend("left_foot", Z, 0.03),
)


def at(name: str) -> Float[np.ndarray, " 3"]:
    """Rest position of a joint, metres."""
    return REST_JOINTS[joint(name)]


def ramp(value: np.ndarray, start: float | np.ndarray, end: float | np.ndarray) -> np.ndarray:
    """0 before `start`, 1 after `end`, smooth between."""
    share = np.clip((value - start) / (end - start), 0.0, 1.0)
    return share * share * (3 - 2 * share)


def chain(start: str, *bends: Bend) -> Field:
    """Skin weights along a chain: each bend hands the share beyond its plane to the next joint."""

    def weights(points: np.ndarray) -> np.ndarray:
        shares = np.zeros((len(points), len(JOINT_NAMES)))
        rest, holder = np.ones(len(points)), joint(start)
        for bend in bends:
            beyond = ramp((points - at(bend.joint)) @ bend.direction, -bend.width, bend.width)
            shares[:, holder] = rest * (1 - beyond)
            rest, holder = rest * beyond, joint(bend.joint)
        shares[:, holder] = rest
        return shares

    return weights
