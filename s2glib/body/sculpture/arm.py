"""The mannequin's arm: a sleeve with a cuff, a palm and five fingers that bend.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np
from jaxtyping import Float
from matplotlib.colors import to_rgb

from s2glib.body.sculpture.rig import ARM, Bend, Part, Y, Z, at, chain, ramp
from s2glib.body.sculpture.solids import loft, profile, ring, tube
from s2glib.body.sculpture.trunk import KNIT, SKIN, SWEATER
from s2glib.body.skeleton import FINGERS

CUFF = 0.6265  # x where the knitted end of the sleeve begins
THICKNESS = {"index": 0.0092, "middle": 0.0095, "ring": 0.0091, "pinky": 0.0079, "thumb": 0.0112}


def sleeve() -> Part:
    """The left sleeve, out of the chest down to its cuff."""
    table = np.array(
        [  # x, half height, half depth, middle height
            (0.06, 0.054, 0.058, 0.408),
            (0.13, 0.058, 0.062, 0.412),
            (0.17, 0.0585, 0.063, 0.4155),
            (0.21, 0.0565, 0.060, 0.421),
            (0.27, 0.0530, 0.056, 0.428),
            (0.36, 0.048, 0.050, 0.430),
            (0.43, 0.045, 0.046, 0.430),
            (0.50, 0.045, 0.047, 0.430),
            (0.58, 0.041, 0.043, 0.430),
            (0.625, 0.0365, 0.0395, 0.430),
            (0.628, 0.0385, 0.0420, 0.430),
            (0.645, 0.0365, 0.0405, 0.430),
            (0.663, 0.0340, 0.0390, 0.430),
            (0.667, 0.0310, 0.0360, 0.430),
            (0.668, 0.0220, 0.0270, 0.430),
        ]
    )
    shoulder = np.array([0.06, 0.10, 0.13, 0.155, 0.18, 0.205, 0.235, 0.275, 0.325, 0.375])
    elbow = np.array([0.40, 0.415, 0.43, 0.445, 0.46, 0.485, 0.53, 0.58])
    x = np.concatenate([shoulder, elbow, table[-6:, 0]])
    height, depth, y = profile(table, x).T
    z = np.interp(
        x, (0.17, 0.43, 0.68), [at(f"left_{j}")[2] for j in ("shoulder", "elbow", "wrist")]
    )
    fabric = tube(np.stack([x, y, z], 1), np.stack([height, depth], 1), second=Z, sides=14)
    return Part("sleeve", fabric, _sleeve_colors, chain("spine3", *ARM))


def _sleeve_colors(points: Float[np.ndarray, "v 3"]) -> Float[np.ndarray, "v 3"]:
    return np.where(points[:, :1] > CUFF, to_rgb(KNIT), to_rgb(SWEATER))


def palm() -> Part:
    """The left wrist and the palm, flat and widening towards the knuckles."""
    wrist = at("left_wrist")
    table = np.array(
        [  # x from the wrist, half height, half width, middle y, middle z
            (-0.05, 0.018, 0.024, 0.0, 0.0),
            (-0.012, 0.018, 0.0245, 0.0, 0.0),
            (0.01, 0.0175, 0.027, -0.001, 0.0),
            (0.035, 0.0165, 0.034, -0.002, -0.002),
            (0.065, 0.0150, 0.0395, -0.002, -0.005),
            (0.088, 0.0128, 0.0405, -0.001, -0.006),
            (0.098, 0.0105, 0.0375, -0.001, -0.006),
            (0.103, 0.0060, 0.0300, -0.001, -0.006),
        ]
    )
    along = np.array([-0.05, -0.015, -0.005, 0.005, 0.015, 0.03, 0.05, 0.07, 0.086, 0.096, 0.103])
    slant = 0.35 * ramp(along, 0.05, 0.1)  # the knuckles lie aslant
    rings = []
    shapes = zip(along, slant, profile(table, along), strict=True)
    for x, aslant, (height, width, y, z) in shapes:
        level = ring(wrist + (x, y, z), height * Y, width * Z, sides=16, roundness=2.4)
        towards_pinky = np.clip(wrist[2] - 0.008 - level[:, 2], 0, None)
        level[:, 0] -= towards_pinky * aslant
        rings.append(level)
    return Part("palm", loft(np.stack(rings)), SKIN, chain("left_elbow", ARM[3]))


def finger(name: str) -> Part:
    """One left finger: three bones, rings close together at its joints, a round tip."""
    knuckles = [at(f"left_{name}{number}") for number in (1, 2, 3)]
    length = np.linalg.norm(knuckles[2] - knuckles[1])
    forward = (knuckles[2] - knuckles[1]) / length
    shape = [(0.0, 1.06), (0.2, 1.04), (0.8, 0.99), (1.0, 1.02), (1.2, 0.99), (1.8, 0.95)]
    shape = [(-0.6, 1.08), (-0.18, 1.08), *shape, (2.0, 0.97), (2.25, 0.94)]
    if name == "thumb":  # its ball reaches back into the palm
        ball = [(-1.0, 0.5), (-0.85, 1.0), (-0.5, 1.4), (-0.18, 1.5), (0.0, 1.42), (0.2, 1.32)]
        shape = [
            *ball,
            (0.8, 1.1),
            (1.0, 1.06),
            (1.2, 1.02),
            (1.8, 0.98),
            (2.0, 0.99),
            (2.25, 0.96),
        ]
    shape += [(2.55, 0.86), (2.80, 0.60), (2.92, 0.2)]
    along, swell = np.array(shape).T
    radius = THICKNESS[name] * swell
    across = np.cross(forward, Y)
    solid = tube(
        knuckles[0] + along[:, None] * length * forward,
        np.stack([0.96 * radius, radius], 1),
        second=across / np.linalg.norm(across),
        sides=8,
    )
    bends = [
        Bend(f"left_{name}{number}", forward, width)
        for number, width in ((1, 0.009), (2, 0.006), (3, 0.005))
    ]
    return Part(name, solid, SKIN, chain("left_wrist", *bends))


def arm_parts() -> list[Part]:
    """Hand and sleeve; the hand first, so that seams between the two take its colour."""
    return [palm(), *(finger(name) for name in FINGERS), sleeve()]
