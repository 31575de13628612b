"""The mannequin's skull and the relief of its face, with the places of eyes, brows and mouth.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np
from jaxtyping import Float

from s2glib.body.sculpture.rig import at
from s2glib.body.sculpture.solids import profile

EYE = at("left_eye") + (0.0, 0.0, -0.001)
EYE_RADIUS = 0.0178
EYE_OPENING = np.array([0.0172, 0.0087])  # half width, half height
MOUTH = np.array([0.0, 0.5885])
MOUTH_STRAIGHT, MOUTH_ROUND = 0.0155, 0.0085  # laid out open: half a straight side, end radius
BROW = np.array(  # x, height, half thickness
    [
        (0.0125, 0.6930, 0.0013),
        (0.0145, 0.6934, 0.0026),
        (0.0190, 0.6945, 0.0031),
        (0.0260, 0.6960, 0.0031),
        (0.0340, 0.6968, 0.0029),
        (0.0420, 0.6962, 0.0026),
        (0.0490, 0.6940, 0.0021),
        (0.0540, 0.6915, 0.0015),
        (0.0565, 0.6900, 0.0007),
    ]
)
CHIN, MIDDLE, DOME = 0.552, 0.69, 0.108  # lowest ring, where the dome begins, the dome's height
_DOME_ANGLES = np.radians([15, 30, 45, 60, 75, 85])
_SKULL = np.array(
    [  # height, half width, front, back
        (0.552, 0.021, 0.069, 0.002),
        (0.558, 0.040, 0.084, 0.014),
        (0.570, 0.0545, 0.091, 0.035),
        (0.590, 0.066, 0.094, 0.060),
        (0.620, 0.075, 0.096, 0.082),
        (0.650, 0.080, 0.098, 0.091),
        (0.690, 0.083, 0.100, 0.096),
        *(
            (MIDDLE + DOME * np.sin(a), *(np.array((0.083, 0.1, 0.096)) * np.cos(a) ** 0.7))
            for a in _DOME_ANGLES
        ),
    ]
)
TOP = _SKULL[-1, 0]
_FRONT_SQUARE, _BACK_SQUARE = 2 / 2.25, 1.0  # exponents: the front is a little squarer
_HAIRLINE = np.array(  # degrees from straight ahead, height
    [
        (0, 0.748),
        (28, 0.750),
        (48, 0.738),
        (62, 0.712),
        (72, 0.675),
        (80, 0.652),
        (92, 0.655),
        (103, 0.650),
        (118, 0.615),
        (140, 0.594),
        (180, 0.590),
    ]
)
_NOSE = np.array(  # height, how far out, half width
    [
        (0.50, 0.0, 0.012),
        (0.602, 0.0, 0.012),
        (0.609, 0.0035, 0.012),
        (0.6145, 0.015, 0.0115),
        (0.620, 0.0205, 0.0105),
        (0.628, 0.0185, 0.0098),
        (0.645, 0.0108, 0.0088),
        (0.662, 0.0065, 0.0095),
        (0.676, 0.0035, 0.0120),
        (0.692, 0.0008, 0.0150),
        (0.72, 0.0, 0.02),
        (0.82, 0.0, 0.02),
    ]
)
_HILLS = (  # how far out, x, height, half width, half height
    (0.0065, 0.0125, 0.6165, 0.0055, 0.0050),  # wing of the nose
    (-0.0080, EYE[0], EYE[1], 0.016, 0.012),  # eye socket
    (0.0022, 0.030, 0.699, 0.032, 0.010),  # bone of the brow
    (0.0040, 0.046, 0.630, 0.016, 0.016),  # cheek
    (0.0050, 0.0, 0.590, 0.024, 0.018),  # lips
    (-0.0040, 0.0, 0.5725, 0.022, 0.006),  # dent below them
    (0.0055, 0.0, 0.559, 0.017, 0.010),  # chin
)


def skull(angle: np.ndarray, height: np.ndarray) -> np.ndarray:
    """The plain head, at an angle from straight ahead (towards its left) and a height."""
    width, front, back = np.moveaxis(profile(_SKULL, height), -1, 0)
    sin, cos = np.sin(angle), np.cos(angle)
    square = np.where(cos > 0, _FRONT_SQUARE, _BACK_SQUARE)
    x = width * np.sign(sin) * np.abs(sin) ** square
    z = np.where(cos > 0, front, back) * np.sign(cos) * np.abs(cos) ** square
    return np.stack([x, height, z], -1)


def skull_angle(x: np.ndarray, height: np.ndarray) -> np.ndarray:
    """The angle at which the front of `skull` has this x."""
    width = profile(_SKULL, np.clip(height, CHIN, TOP))[..., 0]
    return np.arcsin(np.clip(np.abs(x) / width, 0, 1) ** (1 / _FRONT_SQUARE))


def hairline(angle: np.ndarray) -> np.ndarray:
    """Height at which the hair begins, at an angle from straight ahead."""
    degrees = np.degrees(np.abs((angle + np.pi) % (2 * np.pi) - np.pi))
    return np.interp(degrees, *_HAIRLINE.T)


def relief(points: Float[np.ndarray, "v 3"]) -> Float[np.ndarray, " v"]:
    """How far the face stands out of the skull: nose, brow, sockets, cheeks, lips, chin."""
    x, y = np.abs(points[:, 0]), points[:, 1]
    nose, width = profile(_NOSE, y).T
    out = nose * np.exp(-0.5 * (x / width) ** 2)
    for height, x0, y0, wide, high in _HILLS:
        out += height * np.exp(-0.5 * (((x - x0) / wide) ** 2 + ((y - y0) / high) ** 2))
    return out


def around_eye(points: np.ndarray) -> np.ndarray:
    """Size of the ellipse around its eye that goes through a point; 1 is the edge of the lids."""
    aside = (np.abs(points[:, 0]) - EYE[0]) / EYE_OPENING[0]
    return np.hypot(aside, (points[:, 1] - EYE[1]) / EYE_OPENING[1])


def around_mouth(points: np.ndarray) -> np.ndarray:
    """The same for the mouth as laid out open; 1 is the edge of the lips."""
    beyond = np.clip(np.abs(points[:, 0]) - MOUTH_STRAIGHT, 0, None)
    return np.hypot(beyond, points[:, 1] - MOUTH[1]) / MOUTH_ROUND


def over_lips(points: np.ndarray) -> np.ndarray:
    """Height over the line where the closed lips meet, which rises towards its corners."""
    return points[:, 1] - MOUTH[1] - corner_lift(points[:, 0])


def corner_lift(x: np.ndarray) -> np.ndarray:
    """How much the line of the lips rises: a first hint of a smile."""
    return 9.0 * np.clip(np.abs(x) - 0.007, 0, 0.018) ** 2
