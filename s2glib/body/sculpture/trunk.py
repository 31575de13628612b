"""The mannequin's trunk and legs: a knitted sweater, trousers, shoes, and the neck above them.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from matplotlib.colors import to_rgb

from s2glib.body.sculpture.rig import ARM, LEG, SPINE, Part, X, Y, Z, chain, ramp
from s2glib.body.sculpture.solids import Solid, loft, profile, ring, tube

SKIN, SWEATER, KNIT = "#d09a76", "#4477aa", "#356292"
TROUSERS, SHOES, SOLES = "#36414e", "#4a4a52", "#e9e5da"
HEM = -0.0895  # height where the knitted band of the sweater ends


def _stack(
    table: Sequence[tuple[float, ...]], heights: np.ndarray, *, sides: int, roundness: float
) -> Solid:
    """A loft of level rings; the table's columns are height, width, depth, middle x, middle z."""
    rings = [
        ring((x, y, z), depth * Z, width * X, sides=sides, roundness=roundness)
        for y, (width, depth, x, z) in zip(heights, profile(np.array(table), heights), strict=True)
    ]
    return loft(np.stack(rings))


def neck() -> Part:
    """A plain column from the collar into the skull."""
    y = np.array([0.44, 0.49, 0.505, 0.52, 0.535, 0.545, 0.555, 0.565, 0.62])
    places = (0.44, 0.49, 0.53, 0.57, 0.62)
    z = np.interp(y, places, (-0.03, -0.022, -0.012, -0.004, 0.0))
    radius = np.interp(y, places, (0.053, 0.0485, 0.0455, 0.046, 0.043))
    path = np.stack([0 * y, y, z], 1)
    column = tube(path, np.stack([0.97 * radius, radius], 1), second=X, sides=20)
    return Part("neck", column, SKIN, chain("spine3", *SPINE[3:]))


def sweater() -> Part:
    """The body of the sweater, with a hem."""
    table = [  # height, half width, half depth, middle x, middle z
        (-0.138, 0.155, 0.103, 0.0, -0.012),
        (-0.135, 0.1735, 0.1185, 0.0, -0.012),
        (-0.091, 0.1755, 0.1205, 0.0, -0.012),
        (-0.088, 0.1705, 0.1160, 0.0, -0.012),
        (0.0, 0.160, 0.108, 0.0, -0.006),
        (0.10, 0.149, 0.102, 0.0, -0.004),
        (0.20, 0.155, 0.108, 0.0, -0.006),
        (0.30, 0.166, 0.112, 0.0, -0.008),
        (0.37, 0.166, 0.104, 0.0, -0.014),
        (0.42, 0.150, 0.092, 0.0, -0.022),
        (0.450, 0.124, 0.079, 0.0, -0.026),
        (0.472, 0.087, 0.065, 0.0, -0.027),
        (0.488, 0.060, 0.052, 0.0, -0.026),
        (0.494, 0.045, 0.040, 0.0, -0.024),
    ]
    band = np.array([-0.138, -0.135, -0.115, -0.091, -0.088])
    shoulders = np.array([0.37, 0.395, 0.42, 0.44, 0.457, 0.473, 0.488, 0.494])
    heights = np.concatenate([band, np.linspace(-0.06, 0.335, 10), shoulders])
    fabric = _stack(table, heights, sides=26, roundness=2.3)
    return Part("sweater", fabric, _sweater_colors, _sweater_weights)


def _sweater_colors(points: Float[np.ndarray, "v 3"]) -> Float[np.ndarray, "v 3"]:
    return np.where(points[:, 1:2] < HEM, to_rgb(KNIT), to_rgb(SWEATER))


def _sweater_weights(points: Float[np.ndarray, "v 3"]) -> Float[np.ndarray, "v 55"]:
    """The spine carries the trunk; towards the shoulder it goes over to collar and arm."""
    spine, arm = chain("pelvis", *SPINE[:4])(points), chain("spine3", *ARM[:2])(points)
    share = ramp(points[:, 1], 0.31, 0.42)[:, None]
    return (1 - share) * spine + share * arm


def collar() -> Part:
    """A ring of fabric around the neck, lower at the throat than at the nape."""
    outline = [(-0.03, 0.066), (0.0, 0.0645), (0.012, 0.063), (0.018, 0.060)]
    outline += [(0.019, 0.053), (0.0185, 0.0498)]  # how far up, how far out
    rings = []
    for up, out in outline:
        level = ring((0.0, 0.494 + up, -0.022), out * Z, out * X, sides=24)
        level[:, 1] -= 0.22 * (level[:, 2] + 0.022)
        rings.append(level)
    return Part("collar", loft(np.stack(rings)), KNIT, chain("spine3", SPINE[3]))


def trousers() -> list[Part]:
    """The seat of the trousers and their left leg."""
    seat = [  # height, half width, half depth, middle x, middle z
        (-0.215, 0.06, 0.055, 0.0, -0.012),
        (-0.19, 0.125, 0.088, 0.0, -0.012),
        (-0.15, 0.155, 0.104, 0.0, -0.014),
        (-0.08, 0.160, 0.106, 0.0, -0.012),
    ]
    leg = [
        (-0.875, 0.049, 0.058, 0.103, -0.022),
        (-0.86, 0.051, 0.060, 0.103, -0.022),
        (-0.70, 0.055, 0.063, 0.100, -0.022),
        (-0.55, 0.057, 0.065, 0.097, -0.012),
        (-0.46, 0.060, 0.066, 0.095, 0.000),
        (-0.34, 0.068, 0.076, 0.091, -0.004),
        (-0.22, 0.076, 0.090, 0.086, -0.010),
        (-0.13, 0.078, 0.098, 0.083, -0.014),
        (-0.05, 0.065, 0.080, 0.078, -0.012),
    ]
    hips = np.array([-0.215, -0.20, -0.18, -0.15, -0.12, -0.08])
    shin = np.array([-0.875, -0.866, -0.84, -0.77, -0.68, -0.60, -0.54])
    knee = np.array([-0.505, -0.475, -0.445, -0.41, -0.35, -0.29, -0.24, -0.19, -0.15, -0.10])
    return [
        Part("seat", _stack(seat, hips, sides=24, roundness=2.2), TROUSERS, chain("pelvis")),
        Part(
            "leg",
            _stack(leg, np.concatenate([shin, knee]), sides=16, roundness=2.1),
            TROUSERS,
            chain("pelvis", *LEG[:3]),
        ),
    ]


def shoe() -> list[Part]:
    """A plain left shoe on a light sole."""
    table = np.array(
        [  # z, half width, height of the top, middle x
            (-0.095, 0.012, -0.925, 0.101),
            (-0.088, 0.027, -0.905, 0.101),
            (-0.07, 0.036, -0.885, 0.101),
            (-0.03, 0.041, -0.868, 0.103),
            (0.02, 0.042, -0.872, 0.107),
            (0.06, 0.045, -0.897, 0.112),
            (0.10, 0.048, -0.918, 0.117),
            (0.135, 0.044, -0.928, 0.120),
            (0.158, 0.031, -0.937, 0.121),
            (0.168, 0.012, -0.945, 0.121),
        ]
    )
    z = np.array([-0.095, -0.088, -0.07, -0.04, 0.0, 0.04, 0.08, 0.115, 0.14, 0.158, 0.168])
    width, top, x = profile(table, z).T
    middle = (top - 0.962) / 2
    upper = [
        ring((x[i], middle[i], z[i]), width[i] * X, (top[i] - middle[i]) * Y, sides=14)
        for i in range(len(z))
    ]
    follow = chain("left_ankle", LEG[3])
    return [
        Part("shoe", loft(np.stack(upper)), SHOES, follow),
        Part("sole", _sole(x, width, z), SOLES, follow),
    ]


def _sole(x: np.ndarray, width: np.ndarray, z: np.ndarray) -> Solid:
    """The outline of the shoe, a little larger, as a flat slab on the floor."""
    outline = np.concatenate([np.stack([x + width, z], 1), np.stack([x - width, z], 1)[::-1]])
    middle = outline.mean(0)
    levels = []
    for y, grow in ((-0.97, 0.97), (-0.967, 1.0), (-0.952, 1.0), (-0.949, 0.97)):
        level = middle + grow * np.array((1.08, 1.03)) * (outline - middle)
        levels.append(np.insert(level, 1, y, axis=1)[::-1])
    return loft(np.stack(levels))


def trunk_parts() -> list[Part]:
    """Neck, sweater without sleeves, trousers and shoes."""
    return [neck(), *trousers(), sweater(), collar(), *shoe()]
