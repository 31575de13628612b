"""Landmarks: places on the head, and where each face curve moves them.

A blendshape with some forty points: point = rest + sum of curves x pull, on the head bone. The
jaw's angle, in radians, acts like one more curve.

Paper:    -
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import numpy as np

from s2glib.body.skeleton import FACE_CURVES

JAW = "jaw"
_Vector = tuple[float, float, float]
_Pulls = dict[str, _Vector]
_Landmark = tuple[_Vector, _Pulls]

# Places on the head bone, metres, and where a full curve moves them; the jaw is per radian.
_MIDLINE: dict[str, _Landmark] = {
    "cranium": ((0.0, 0.092, -0.008), {}),
    "forehead": ((0.0, 0.148, 0.062), {}),
    "bridge": ((0.0, 0.064, 0.090), {}),
    "nose": ((0.0, 0.026, 0.122), {"nose_wrinkle": (0.0, 0.004, 0.0)}),
    "lip_top": (
        (0.0, -0.003, 0.098),
        {
            "lip_press": (0.0, -0.004, -0.003),
            "lip_round": (0.0, 0.003, 0.010),
            "frown": (0.0, 0.003, 0.0),
        },
    ),
    "mouth_top": (
        (0.0, -0.0105, 0.097),
        {"lip_round": (0.0, 0.003, 0.006), "smile": (0.0, -0.003, 0.0), "frown": (0.0, 0.003, 0.0)},
    ),
    "mouth_bottom": (
        (0.0, -0.0125, 0.097),
        {
            "lip_round": (0.0, -0.003, 0.006),
            "smile": (0.0, -0.006, 0.0),
            "frown": (0.0, 0.003, 0.0),
            "lip_press": (0.0, 0.002, 0.0),
            JAW: (0.0, -0.085, -0.02),
        },
    ),
    "lip_bottom": (
        (0.0, -0.022, 0.094),
        {
            "lip_round": (0.0, -0.004, 0.010),
            "smile": (0.0, -0.004, 0.0),
            "frown": (0.0, 0.002, 0.0),
            "lip_press": (0.0, 0.005, -0.003),
            JAW: (0.0, -0.085, -0.02),
        },
    ),
    "chin": ((0.0, -0.052, 0.072), {JAW: (0.0, -0.075, -0.03)}),
}
_LEFT_SIDE: dict[str, _Landmark] = {
    "temple": ((0.074, 0.112, 0.0), {}),
    "hairline": ((0.050, 0.140, 0.044), {}),
    "sideburn": ((0.072, 0.085, 0.012), {}),
    "ear": ((0.080, 0.060, -0.012), {}),
    "cheek": ((0.073, 0.050, 0.026), {}),
    "jaw_corner": ((0.061, -0.006, 0.028), {JAW: (0.0, -0.020, 0.0)}),
    "chin_side": ((0.034, -0.043, 0.060), {JAW: (0.0, -0.065, -0.025)}),
    "blush": ((0.046, 0.024, 0.072), {"smile": (0.0, 0.004, 0.0)}),
    "nostril": ((0.0125, 0.019, 0.098), {"nose_wrinkle": (0.003, 0.005, 0.0)}),
    "brow_inner": (
        (0.014, 0.094, 0.086),
        {
            "brow_raise": (0.0, 0.014, 0.0),
            "brow_furrow": (-0.006, -0.013, 0.0),
            "brow_sad": (-0.002, 0.013, 0.0),
        },
    ),
    "brow_middle": (
        (0.033, 0.101, 0.080),
        {
            "brow_raise": (0.0, 0.017, 0.0),
            "brow_furrow": (-0.002, -0.007, 0.0),
            "brow_sad": (0.0, 0.001, 0.0),
        },
    ),
    "brow_outer": (
        (0.055, 0.094, 0.060),
        {
            "brow_raise": (0.0, 0.012, 0.0),
            "brow_furrow": (0.0, 0.001, 0.0),
            "brow_sad": (0.0, -0.008, 0.0),
        },
    ),
    "eye_inner": ((0.0155, 0.068, 0.080), {}),
    "eye_outer": ((0.050, 0.071, 0.066), {"smile": (0.0, -0.001, 0.0)}),
    "lid_top": (
        (0.033, 0.0815, 0.081),
        {
            "lid_close": (0.0, -0.0165, 0.0),
            "lid_wide": (0.0, 0.0075, 0.0),
            "brow_furrow": (0.0, -0.003, 0.0),
            "nose_wrinkle": (0.0, -0.003, 0.0),
        },
    ),
    "lid_bottom": (
        (0.032, 0.058, 0.081),
        {
            "lid_close": (0.0, 0.003, 0.0),
            "lid_wide": (0.0, -0.002, 0.0),
            "smile": (0.0, 0.004, 0.0),
            "nose_wrinkle": (0.0, 0.004, 0.0),
        },
    ),
    "mouth_corner": (
        (0.026, -0.0095, 0.084),
        {
            "smile": (0.007, 0.011, -0.003),
            "frown": (0.001, -0.009, 0.0),
            "smirk": (0.006, 0.013, -0.003),
            "lip_round": (-0.012, 0.0, 0.010),
            "lip_wide": (0.009, 0.001, -0.004),
            "lip_press": (0.003, 0.0, 0.0),
            JAW: (-0.008, -0.036, -0.005),
        },
    ),
}


def _mirrored(pulls: _Pulls) -> _Pulls:
    """The other side's pulls; a smirk lifts the left corner only."""
    return {name: (-x, y, z) for name, (x, y, z) in pulls.items() if name != "smirk"}


def _head_landmarks() -> dict[str, _Landmark]:
    landmarks = dict(_MIDLINE)
    for name, ((x, y, z), pulls) in _LEFT_SIDE.items():
        landmarks[f"left_{name}"] = ((x, y, z), pulls)
        landmarks[f"right_{name}"] = ((-x, y, z), _mirrored(pulls))
    return landmarks


_HEAD = _head_landmarks()
CURVES = (*FACE_CURVES, JAW)
HEAD_NAMES = tuple(_HEAD)
HEAD_REST = np.array([rest for rest, _ in _HEAD.values()])
HEAD_PULLS = np.zeros((len(CURVES), len(_HEAD), 3))  # metres for a full curve
for _place, (_, _pulls) in enumerate(_HEAD.values()):
    for _curve, _pull in _pulls.items():
        HEAD_PULLS[CURVES.index(_curve), _place] = _pull
