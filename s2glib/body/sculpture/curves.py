"""How the mannequin's face moves: the share of the jaw, and one displacement per face curve.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np
from jaxtyping import Float

from s2glib.body.sculpture.rig import ramp
from s2glib.body.sculpture.skull import EYE, EYE_OPENING, EYE_RADIUS, MOUTH, around_eye, over_lips
from s2glib.body.skeleton import FACE_CURVES

Points = Float[np.ndarray, "v 3"]


def face_directions(points: Points) -> Float[np.ndarray, "v 3 12"]:
    """Metres that each point of the face moves when a curve of `FACE_CURVES` is 1."""
    moves = {
        "brow_raise": _brow_raise(points),
        "brow_furrow": _brow_furrow(points),
        "brow_sad": _brow_sad(points),
        "lid_close": _lids(points, 1.0, 1.0),
        "lid_wide": _lids(points, -0.25, -0.25),
        "smile": _smile(points),
        "frown": _frown(points),
        "smirk": 0.9 * _smile(points) * ramp(points[:, :1], -0.004, 0.016),  # left side only
        "nose_wrinkle": _nose_wrinkle(points),
        "lip_round": _lip_round(points),
        "lip_wide": _lip_wide(points),
        "lip_press": _lip_press(points),
    }
    return np.stack([moves[curve] for curve in FACE_CURVES], -1)


def jaw_share(points: Points) -> Float[np.ndarray, " v"]:
    """1 below the line of the lips, 0 above: a sharp step between the lips, soft in the cheeks."""
    x, z = np.abs(points[:, 0]), points[:, 2]
    blur = 0.0001 + 0.028 * ramp(x, 0.010, 0.050)
    return ramp(-over_lips(points), -blur, blur) * ramp(z, -0.005, 0.055)


def _near(points: Points, x: float, y: float, width: float, height: float) -> np.ndarray:
    """A soft patch (v, 1) on both sides of the face, 1 at its middle, 0 at the back."""
    side = (np.abs(points[:, 0]) - x) / width
    up = (points[:, 1] - y) / height
    return (np.exp(-0.5 * (side**2 + up**2)) * ramp(points[:, 2], 0.02, 0.06))[:, None]


def _step(points: Points, out: float, up: float, forward: float) -> Points:
    """The same step on both sides; `out` is away from the middle."""
    side = np.clip(points[:, 0] / 0.004, -1, 1)
    return np.stack([out * side, np.full_like(side, up), np.full_like(side, forward)], -1)


def _above_eye(points: Points) -> np.ndarray:
    return ramp(points[:, 1:2], 0.680, 0.692)


def _brow_raise(points: Points) -> Points:
    return _near(points, 0.034, 0.700, 0.030, 0.016) * _above_eye(points) * (0, 0.010, 0)


def _brow_furrow(points: Points) -> Points:
    inner = _near(points, 0.015, 0.694, 0.015, 0.012) * _above_eye(points)
    return inner * _step(points, -0.005, -0.006, 0.002)


def _brow_sad(points: Points) -> Points:
    inner = _near(points, 0.014, 0.694, 0.013, 0.014) * _step(points, -0.002, 0.009, 0.001)
    outer = _near(points, 0.055, 0.690, 0.013, 0.012) * (0, -0.005, 0)
    return (inner + outer) * _above_eye(points)


def _lids(points: Points, upper: float, lower: float) -> Points:
    """Slide the lids over the eyeball; 1 takes an edge to the line where closed lids meet."""
    x, y = np.abs(points[:, 0]) - EYE[0], points[:, 1] - EYE[1]
    share = (1 - ramp(around_eye(points), 1.0, 1.6)) * (points[:, 2] > 0.07)
    arc = EYE_OPENING[1] * np.sqrt(np.clip(1 - (x / EYE_OPENING[0]) ** 2, 0, 1))
    up = np.where(y > 0, -1.5 * upper, 0.5 * lower) * arc * share
    radius = EYE_RADIUS + 0.0016 + 0.0016 * np.clip(upper, 0, 1)
    lying = np.sqrt(np.clip(radius**2 - x**2 - (y + up) ** 2, 0, None))
    forward = np.maximum(lying - (points[:, 2] - EYE[2]), -0.004) * np.sqrt(share)
    return np.stack([0 * up, up, np.where(lying > 0, forward, 0)], -1)


def _corners(points: Points, out: float, up: float, back: float) -> Points:
    """Draw the corners of the mouth; the closer to the middle, the less (a bow, not a kink)."""
    bow = np.clip(np.abs(points[:, :1]) / 0.026, 0, 1) ** 2
    return _near(points, 0.026, 0.590, 0.0175, 0.0125) * bow * _step(points, out, up, -back)


def _smile(points: Points) -> Points:
    cheeks = _near(points, 0.043, 0.626, 0.016, 0.015) * _step(points, 0.001, 0.004, 0.0045)
    return _corners(points, 0.006, 0.009, 0.005) + cheeks + 0.35 * _lids(points, 0.0, 0.8)


def _frown(points: Points) -> Points:
    chin = _near(points, 0.0, 0.570, 0.016, 0.012) * (0, 0.0025, 0.002)
    return _corners(points, 0.001, -0.009, 0.001) + chin


def _nose_wrinkle(points: Points) -> Points:
    wings = _near(points, 0.012, 0.624, 0.008, 0.011) * _step(points, 0.001, 0.005, 0.001)
    upper = 1 - jaw_share(points)[:, None]
    lip = _near(points, 0.012, 0.599, 0.012, 0.008) * upper * (0, 0.0045, 0.001)
    return wings + lip + 0.6 * _brow_furrow(points)


def _on_lips(points: Points, width: float, height: float) -> np.ndarray:
    """The lips but not the cave behind them."""
    return _near(points, 0.0, MOUTH[1], width, height) * ramp(points[:, 2:], 0.072, 0.092)


def _lip_round(points: Points) -> Points:
    half = np.where(over_lips(points) > 0, 1.0, -1.0)
    pucker = np.stack([-0.48 * points[:, 0], 0.0022 * half, np.full_like(half, 0.009)], -1)
    return _on_lips(points, 0.026, 0.011) * pucker


def _lip_wide(points: Points) -> Points:
    x = points[:, 0]
    return _near(points, 0.0, MOUTH[1], 0.034, 0.012) * np.stack([0.26 * x, 0 * x, -3.5 * x**2], -1)


def _lip_press(points: Points) -> Points:
    over = over_lips(points)
    roll = np.stack([0 * over, -0.5 * over, np.full_like(over, -0.004)], -1)
    return _on_lips(points, 0.024, 0.007) * roll
