"""The mannequin's head around its face: eyes, brows, ears, hair, teeth, and their colours.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np
from jaxtyping import Float
from matplotlib.colors import to_rgb

from s2glib.body.sculpture.curves import jaw_share
from s2glib.body.sculpture.face import face
from s2glib.body.sculpture.rig import Part, X, Y, Z, chain, ramp
from s2glib.body.sculpture.skull import (
    BROW,
    DOME,
    EYE,
    EYE_RADIUS,
    MIDDLE,
    TOP,
    around_eye,
    hairline,
    over_lips,
    relief,
    skull,
    skull_angle,
)
from s2glib.body.sculpture.solids import Solid, loft, ring, tube
from s2glib.body.sculpture.trunk import SKIN
from s2glib.body.skeleton import joint

HAIR, LIPS, LASHES, CAVITY = "#3b2a25", "#b0695a", "#5a3a2e", "#4d2426"
WHITE, IRIS, PUPIL, SPARK = "#f4f1ea", "#6b4a33", "#1c1a1c", "#ffffff"
TEETH, TONGUE = "#f0ebe0", "#b8606a"
PUPIL_ANGLE, IRIS_ANGLE = 0.23, 0.57  # radians from the eye's axis


def head_parts() -> list[Part]:
    """Everything above the neck; seams take the colour of the part that comes first."""
    skin = Part("face", face(), _face_colors, _face_weights)
    return [brow(), hair(), skin, *eye(), ear(), *teeth()]


def _face_weights(points: Float[np.ndarray, "v 3"]) -> Float[np.ndarray, "v 55"]:
    """The head carries the face; the jaw takes its share below the line of the lips."""
    weights = chain("head")(points)
    share = jaw_share(points)
    weights[:, joint("head")], weights[:, joint("jaw")] = 1 - share, share
    return weights


def _face_colors(points: Float[np.ndarray, "v 3"]) -> Float[np.ndarray, "v 3"]:
    """Skin; lips; a line of lashes on the upper lid; the dark inside of the mouth."""
    x, y, z = np.abs(points[:, 0]), points[:, 1], points[:, 2]
    over = over_lips(points)
    depth = relief(points) + skull(skull_angle(x, y), np.clip(y, None, TOP))[:, 2] - z
    colors = np.tile(to_rgb(SKIN), (len(points), 1))
    colors[(x < 0.0247) & (over < 0.0053) & (over > -0.0060) & (z > 0.06)] = to_rgb(LIPS)
    colors[(x < 0.03) & (np.abs(over) < 0.02) & (z > 0.03) & (depth > 0.0055)] = to_rgb(CAVITY)
    colors[(around_eye(points) < 1.06) & (y > EYE[1]) & (z > 0.05)] = to_rgb(LASHES)
    return colors


def eye() -> list[Part]:
    """The left eye: ball with iris and pupil, and the light in it."""
    thin = 0.014  # a narrow ring on each side of a border of colours keeps it crisp
    borders = [angle + side * thin for angle in (PUPIL_ANGLE, IRIS_ANGLE) for side in (-1, 1)]
    polar = np.array([0.06, *borders, 0.85, 1.15, 2.4])
    rings = [
        ring(
            EYE + EYE_RADIUS * np.cos(angle) * Z,
            EYE_RADIUS * np.sin(angle) * X,
            EYE_RADIUS * np.sin(angle) * Y,
            sides=16,
        )
        for angle in polar[::-1]
    ]
    spark = EYE + EYE_RADIUS * 0.97 * np.array([0.14, 0.24, 0.96])
    follow = chain("left_eye")
    return [
        Part("eye", loft(np.stack(rings)), _eye_colors, follow),
        Part("spark", _ellipsoid(spark, (0.0021, 0.0021, 0.0012), sides=8), SPARK, follow),
    ]


def _eye_colors(points: Float[np.ndarray, "v 3"]) -> Float[np.ndarray, "v 3"]:
    """White, a ring of iris, a dark pupil in front."""
    angle = np.arccos(np.clip((points - EYE)[:, 2] / EYE_RADIUS, -1, 1))[:, None]
    colored = np.where(angle < PUPIL_ANGLE, to_rgb(PUPIL), to_rgb(IRIS))
    return np.where(angle < IRIS_ANGLE, colored, to_rgb(WHITE))


def _ellipsoid(center: np.ndarray, radii: tuple[float, float, float], *, sides: int) -> Solid:
    """A round solid whose rings stack towards +z."""
    a, b, c = radii
    polar = np.linspace(np.pi, 0, sides // 2 + 2)[1:-1]
    rings = [
        ring(center + c * np.cos(p) * Z, a * np.sin(p) * X, b * np.sin(p) * Y, sides=sides)
        for p in polar
    ]
    return loft(np.stack(rings))


def brow() -> Part:
    """The left brow, a curved stroke on the face."""
    x, y, thick = BROW.T
    skin = skull(skull_angle(x, y), y)
    path = np.stack([x, y, skin[:, 2] + relief(skin) + 0.0012], -1)
    radii = np.stack([0.05 * np.sqrt(thick), thick], -1)
    return Part("brow", tube(path, radii, second=Y, sides=8), HAIR, chain("head"))


def ear() -> Part:
    """The left ear: a leaning shell with a dent."""
    shell = _ellipsoid(np.zeros(3), (0.0085, 0.028, 0.0165), sides=12)
    x, y, z = shell.vertices.T
    dent = 0.0054 * np.exp(-0.5 * ((z - 0.002) ** 2 + (y - 0.004) ** 2) / 0.007**2)
    x = x + 0.25 * np.clip(-z, -0.004, None) - dent * (x > 0)
    leaning = np.stack([x, y, z - 0.18 * y], -1) + (0.081, 0.648, -0.012)
    return Part("ear", Solid(leaning, shell.faces), SKIN, chain("head"))


def hair() -> Part:
    """Short hair: from the hairline over the crown to the nape, fuller on top."""
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    edge = (hairline(angle) - MIDDLE) / DOME
    first = np.where(edge > 0, np.arcsin(np.clip(edge, 0, 1)), edge)
    rings = [_strands(angle, first)[0] * (0.55, 1, 0.55)]
    for share in np.array([[0.0], [0.04], [0.15], [0.3], [0.47], [0.64], [0.8], [0.93]]):
        lift = first + share * (np.pi / 2 - first)
        skin, outwards = _strands(angle, lift)
        quiff = 0.009 * np.exp(-0.5 * ((lift - 1.05) / 0.35) ** 2) * np.clip(np.cos(angle), 0, 1)
        thick = 0.0042 + 0.0080 * ramp(share, 0.0, 0.4) + quiff
        rings.append(skin + thick[:, None] * outwards)
    return Part("hair", loft(np.stack(rings)), HAIR, chain("head"))


def _strands(angle: np.ndarray, lift: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where hair grows at an angle and an elevation, and the direction that it stands out in."""
    height = MIDDLE + DOME * np.where(lift > 0, np.sin(lift), lift)
    skin = skull(angle, np.minimum(height, TOP))
    out = skin - np.stack([0 * height, np.minimum(height, MIDDLE), 0 * height], -1)
    return skin, out / np.linalg.norm(out, axis=1, keepdims=True)


def teeth() -> list[Part]:
    """The upper row of teeth, and a tongue that lies on the floor of the mouth."""
    x = np.linspace(-0.02, 0.02, 9)
    path = np.stack([x, np.full(9, 0.594), 0.0925 - 14 * x**2], -1)
    row = tube(path, np.tile([0.0062, 0.0025], (9, 1)), second=Z, sides=8, roundness=4.0)
    tongue = _ellipsoid(np.array([0, 0.5775, 0.078]), (0.0155, 0.005, 0.016), sides=12)
    return [
        Part("teeth", row, TEETH, chain("head")),
        Part("tongue", tongue, TONGUE, chain("jaw")),
    ]
