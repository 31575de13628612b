"""Assembly: parts of a person become one skinned, coloured surface whose face can move.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np
import torch
from matplotlib.colors import to_rgb

from s2glib.body.sculpture.arm import arm_parts
from s2glib.body.sculpture.curves import face_directions
from s2glib.body.sculpture.head import head_parts
from s2glib.body.sculpture.rig import Part
from s2glib.body.sculpture.solids import Surface, join, smooth
from s2glib.body.sculpture.trunk import trunk_parts
from s2glib.body.skeleton import FINGERS, JOINT_NAMES, PARENTS, REST_JOINTS
from s2glib.body.skinning import BodyModel

SOFT_SEAMS = (
    ("face", "neck"),
    ("sweater", "sleeve"),
    ("seat", "leg"),
    *(("palm", finger) for finger in FINGERS),
)
STIFF = ("hair", "ear", "neck", "teeth", "tongue")  # what shares a vertex with these stays put
SHORTEST_EDGE = 0.0015


def assemble() -> BodyModel:
    """Sculpt the mannequin: join the parts, soften seams, and ask each part what it knows."""
    parts = [*head_parts(), *arm_parts(), *trunk_parts()]
    surface = join([part.solid for part in parts], shortest=SHORTEST_EDGE)
    mirror = np.where(surface.vertices[:, :1] < 0, (-1, 1, 1), 1)
    softness = _softness(surface, [part.name for part in parts])
    weights = _weights(parts, surface, surface.vertices * mirror)
    weights = smooth(weights, surface.faces, 0.5 * softness, rounds=6)
    return BodyModel(
        vertices=_tensor(smooth(surface.vertices, surface.faces, 0.6 * softness, rounds=6)),
        faces=torch.tensor(surface.faces),
        weights=_tensor(_four_largest(_on_both_sides(weights, surface.vertices[:, :1]))),
        joints=_tensor(REST_JOINTS),
        parents=PARENTS,
        colors=_tensor(_colors(parts, surface, surface.vertices * mirror)),
        expression_directions=_tensor(_directions(parts, surface)),
    )


def _tensor(values: np.ndarray) -> torch.Tensor:
    return torch.tensor(values, dtype=torch.float32)


def _softness(surface: Surface, names: list[str]) -> np.ndarray:
    """1 on the seams that cloth and skin bridge smoothly, fading over the next few vertices."""
    seam = np.zeros(len(surface.vertices), dtype=bool)
    for pair in SOFT_SEAMS:
        seam |= surface.membership[:, [names.index(name) for name in pair]].all(1)
    half = np.full(len(seam), 0.5)
    spread = smooth(seam[:, None].astype(float), surface.faces, half, rounds=4)[:, 0]
    return np.clip(2 * spread, 0, 1)


def _colors(parts: list[Part], surface: Surface, left: np.ndarray) -> np.ndarray:
    """Each part's colour; a vertex on a seam takes that of the first part it belongs to."""
    colors = np.zeros_like(left)
    for part, mine in reversed(list(zip(parts, surface.membership.T, strict=True))):
        colors[mine] = part.color(left[mine]) if callable(part.color) else to_rgb(part.color)
    return colors


def _weights(parts: list[Part], surface: Surface, left: np.ndarray) -> np.ndarray:
    """Skin weights as if all points lay on the left; on a seam the mean over its parts."""
    weights = np.zeros((len(left), len(JOINT_NAMES)))
    for part, mine in zip(parts, surface.membership.T, strict=True):
        weights[mine] += part.weights(left[mine])
    return weights / weights.sum(1, keepdims=True)


def _on_both_sides(weights: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Hand the shares of points on the right to the right joints; the middle gets both."""
    swap = {"left": "right", "right": "left"}
    other = [
        JOINT_NAMES.index("_".join(swap.get(word, word) for word in name.split("_")))
        for name in JOINT_NAMES
    ]
    right_share = 0.5 - 0.5 * np.sign(x)
    return (1 - right_share) * weights + right_share * weights[:, other]


def _four_largest(weights: np.ndarray) -> np.ndarray:
    """Keep four joints a vertex, and none below a thousandth."""
    fourth = np.sort(weights, axis=1)[:, -4:-3]
    kept = np.where(weights >= np.maximum(fourth, 1e-3), weights, 0.0)
    return kept / kept.sum(1, keepdims=True)


def _directions(parts: list[Part], surface: Surface) -> np.ndarray:
    """The face curves, for skin and brows only."""
    names = [part.name for part in parts]
    skin = surface.membership[:, [names.index("face"), names.index("brow")]].any(axis=1)
    stiff = surface.membership[:, [names.index(name) for name in STIFF]].any(axis=1)
    return face_directions(surface.vertices) * np.where(skin & ~stiff, 1.0, 0.0)[:, None, None]
