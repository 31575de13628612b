"""The skeleton all three papers share: 55 SMPL-X joints, their tree, and our own rest pose.

Paper:    PT A.2, AM C.2 (SMPL-X bodies)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np

FINGERS = ("index", "middle", "pinky", "ring", "thumb")  # SMPL-X's order

_BODY = {  # joint: (parent, offset from the parent in metres, T-pose)
    "pelvis": (None, (0.0, 0.0, 0.0)),
    "left_hip": ("pelvis", (0.065, -0.085, 0.0)),
    "right_hip": ("pelvis", (-0.065, -0.085, 0.0)),
    "spine1": ("pelvis", (0.0, 0.11, -0.015)),
    "left_knee": ("left_hip", (0.03, -0.39, 0.0)),
    "right_knee": ("right_hip", (-0.03, -0.39, 0.0)),
    "spine2": ("spine1", (0.0, 0.13, 0.0)),
    "left_ankle": ("left_knee", (0.005, -0.40, -0.03)),
    "right_ankle": ("right_knee", (-0.005, -0.40, -0.03)),
    "spine3": ("spine2", (0.0, 0.06, 0.015)),
    "left_foot": ("left_ankle", (0.02, -0.06, 0.12)),
    "right_foot": ("right_ankle", (-0.02, -0.06, 0.12)),
    "neck": ("spine3", (0.0, 0.19, -0.025)),
    "left_collar": ("spine3", (0.05, 0.11, -0.02)),
    "right_collar": ("spine3", (-0.05, 0.11, -0.02)),
    "head": ("neck", (0.0, 0.11, 0.03)),
    "left_shoulder": ("left_collar", (0.12, 0.02, -0.015)),
    "right_shoulder": ("right_collar", (-0.12, 0.02, -0.015)),
    "left_elbow": ("left_shoulder", (0.26, 0.0, -0.015)),
    "right_elbow": ("right_shoulder", (-0.26, 0.0, -0.015)),
    "left_wrist": ("left_elbow", (0.25, 0.0, 0.0)),
    "right_wrist": ("right_elbow", (-0.25, 0.0, 0.0)),
    "jaw": ("head", (0.0, 0.0, 0.02)),
    "left_eye": ("head", (0.032, 0.07, 0.075)),
    "right_eye": ("head", (-0.032, 0.07, 0.075)),
}
_FINGER_BASES = {  # finger: (base from the wrist, step from joint to joint), left hand
    "index": ((0.098, 0.0, 0.025), (0.032, 0.0, 0.0)),
    "middle": ((0.103, 0.0, 0.003), (0.033, 0.0, 0.0)),
    "pinky": ((0.086, 0.0, -0.036), (0.022, 0.0, 0.0)),
    "ring": ((0.096, 0.0, -0.018), (0.031, 0.0, 0.0)),
    "thumb": ((0.035, -0.01, 0.028), (0.028, -0.002, 0.018)),
}


def _with_hands() -> dict[str, tuple[str | None, tuple[float, float, float]]]:
    joints = dict(_BODY)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for finger in FINGERS:
            base, step = _FINGER_BASES[finger]
            parent = f"{side}_wrist"
            for knuckle, (x, y, z) in enumerate((base, step, step), start=1):
                name = f"{side}_{finger}{knuckle}"
                joints[name] = (parent, (sign * x, y, z))
                parent = name
    return joints


_JOINTS = _with_hands()

JOINT_NAMES: tuple[str, ...] = tuple(_JOINTS)
"""The 55 joints in SMPL-X order: 22 of the body, jaw, eyes, then the left and the right hand."""

PARENTS: tuple[int, ...] = tuple(
    -1 if parent is None else JOINT_NAMES.index(parent) for parent, _ in _JOINTS.values()
)
"""Parent of each joint; the root has -1, and a parent always comes before its children."""

REST_OFFSETS = np.array([offset for _, offset in _JOINTS.values()])
"""(55, 3) metres: each joint from its parent in the rest pose, arms out to the sides."""

REST_JOINTS = REST_OFFSETS.copy()
"""(55, 3) metres: joint positions of the rest pose, pelvis at the origin."""
for _joint, _parent in enumerate(PARENTS):
    if _parent >= 0:
        REST_JOINTS[_joint] += REST_JOINTS[_parent]

PELVIS_HEIGHT = 0.97
"""Metres from the floor to the pelvis when our rest body stands."""

FACE_CURVES: tuple[str, ...] = (
    "brow_raise",
    "brow_furrow",
    "brow_sad",
    "lid_close",
    "lid_wide",
    "smile",
    "frown",
    "smirk",
    "nose_wrinkle",
    "lip_round",
    "lip_wide",
    "lip_press",
)
"""Our own face curves, each in [0, 1]: the first columns of `Motion.expression`."""


def joint(name: str) -> int:
    """The index of a joint.

    Raises:
        ValueError: if no joint has that name.
    """
    if name not in JOINT_NAMES:
        raise ValueError(f"no joint is called {name!r}; the names are in s2glib.body.JOINT_NAMES")
    return JOINT_NAMES.index(name)
