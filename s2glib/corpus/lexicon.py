"""The lexicon: what hands do for a word, as key positions in front of the chest.

Positions are in arm lengths from the shoulder: out to the hand's own side, up, forward.

Paper:    AM E (beat, iconic, deictic and metaphoric gestures)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from typing import NamedTuple

import numpy as np

from s2glib.body.skeleton import FINGERS

HAND_SHAPES = {  # flexion of index, middle, ring, pinky and thumb (0 open, 1 fist), then spread
    "relax": (0.25, 0.30, 0.35, 0.40, 0.20, 0.00),
    "open": (0.02, 0.02, 0.03, 0.05, 0.00, 0.25),
    "point": (0.00, 0.90, 0.95, 0.95, 0.60, 0.00),
    "fist": (1.00, 1.00, 1.00, 1.00, 0.70, 0.00),
    "pinch": (0.55, 0.60, 0.40, 0.35, 0.50, 0.05),
    "flat": (0.05, 0.05, 0.05, 0.05, 0.10, 0.00),
    "cup": (0.30, 0.28, 0.28, 0.30, 0.15, 0.05),
}

PALMS = {  # where the palm faces: out, up, forward
    "in": (-1.0, -0.15, 0.0),
    "up": (0.0, 1.0, 0.0),
    "down": (0.0, -1.0, 0.0),
    "forward": (0.0, 0.0, 1.0),
}

SEMANTIC_WEIGHT = {"beat": 0.15, "iconic": 0.8, "deictic": 0.7, "metaphoric": 0.6}


class Gesture(NamedTuple):
    """One entry: a stroke from `start` to `end`, along a line, a hop or a circle."""

    kind: str
    hands: str  # "one" or "both"
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    palm: str
    shape: str
    path: str = "line"
    repeats: int = 1


GESTURES = {
    "beat": Gesture("beat", "one", (0.05, -0.30, 0.50), (0.08, -0.50, 0.58), "in", "relax"),
    "big": Gesture("iconic", "both", (-0.10, -0.25, 0.60), (0.55, -0.15, 0.55), "in", "open"),
    "small": Gesture(
        "iconic", "one", (0.05, -0.25, 0.62), (0.05, -0.18, 0.65), "in", "pinch", repeats=2
    ),
    "up": Gesture("iconic", "one", (0.15, -0.55, 0.45), (0.25, 0.30, 0.50), "in", "flat"),
    "round": Gesture(
        "iconic", "one", (0.15, -0.20, 0.58), (0.15, -0.20, 0.58), "in", "cup", "circle", 2
    ),
    "box": Gesture("iconic", "both", (0.18, -0.25, 0.55), (0.18, -0.50, 0.60), "in", "flat"),
    "down": Gesture("iconic", "one", (0.15, -0.10, 0.55), (0.20, -0.60, 0.55), "down", "flat"),
    "walk": Gesture(
        "iconic", "one", (-0.10, -0.35, 0.50), (0.45, -0.25, 0.62), "down", "flat", "hop"
    ),
    "hug": Gesture("iconic", "both", (0.50, -0.10, 0.50), (-0.05, -0.25, 0.46), "in", "cup"),
    "push": Gesture("iconic", "both", (0.12, -0.25, 0.34), (0.15, -0.15, 0.78), "forward", "open"),
    "break": Gesture("iconic", "both", (0.05, -0.25, 0.52), (0.30, -0.40, 0.50), "down", "fist"),
    "self": Gesture("deictic", "one", (0.00, -0.45, 0.45), (-0.20, -0.28, 0.26), "in", "flat"),
    "you": Gesture("deictic", "one", (0.10, -0.35, 0.35), (0.05, -0.12, 0.85), "down", "point"),
    "there": Gesture("deictic", "one", (0.15, -0.25, 0.40), (0.70, 0.02, 0.50), "down", "point"),
    "here": Gesture(
        "deictic", "one", (0.10, -0.10, 0.50), (0.10, -0.55, 0.60), "down", "point", repeats=2
    ),
    "offer": Gesture("metaphoric", "both", (0.05, -0.40, 0.40), (0.32, -0.38, 0.62), "up", "open"),
    "cycle": Gesture(
        "metaphoric", "both", (0.10, -0.35, 0.50), (0.10, -0.35, 0.50), "in", "cup", "circle", 2
    ),
    "count": Gesture(
        "metaphoric", "both", (0.02, -0.30, 0.52), (0.02, -0.38, 0.54), "in", "point", repeats=3
    ),
    "stop": Gesture(
        "metaphoric", "one", (0.10, -0.30, 0.34), (0.08, 0.02, 0.72), "forward", "open"
    ),
    "cut": Gesture("metaphoric", "both", (-0.10, -0.32, 0.52), (0.50, -0.36, 0.52), "down", "flat"),
    "sweep": Gesture("metaphoric", "one", (-0.25, -0.30, 0.55), (0.60, -0.15, 0.50), "up", "open"),
    "away": Gesture("metaphoric", "one", (0.00, -0.25, 0.40), (0.45, 0.05, 0.60), "in", "flat"),
    "hold": Gesture("metaphoric", "both", (0.12, -0.35, 0.52), (0.12, -0.42, 0.55), "in", "cup"),
}  # fmt: skip

_SHAPE_COLUMNS = {"index": 0, "middle": 1, "ring": 2, "pinky": 3}
_SPREAD = {"index": -0.5, "middle": -0.1, "ring": 0.2, "pinky": 0.55}
_KNUCKLES = (1.1, 1.5, 1.0)  # radians of each joint in a fist


def finger_poses(shapes: np.ndarray, side: str) -> np.ndarray:
    """Axis-angle of a hand's 15 joints for hand shapes over time.

    Args:
        shapes: (frames, 6) flexions and spread as in `HAND_SHAPES`.
        side: "left" or "right".

    Returns:
        (frames, 15, 3) radians, in SMPL-X order.
    """
    sign = 1.0 if side == "left" else -1.0
    poses = np.zeros((len(shapes), 15, 3))
    for finger, name in enumerate(FINGERS[:4]):
        base = 3 * finger
        flexion = shapes[:, _SHAPE_COLUMNS[name], None]
        poses[:, base : base + 3, 2] = -sign * flexion * _KNUCKLES
        poses[:, base, 1] = sign * shapes[:, 5] * _SPREAD[name]
    thumb = shapes[:, 4]
    poses[:, 12, 1] = sign * thumb * 0.6
    poses[:, 12, 2] = -sign * thumb * 0.5
    poses[:, 13, 1] = sign * thumb * 0.6
    poses[:, 14, 1] = sign * thumb * 0.7
    return poses
