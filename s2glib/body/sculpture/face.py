"""The mannequin's face: laid out flat so that loops of points ring eyes and mouth, then shaped.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np
from scipy.spatial import Delaunay, cKDTree

from s2glib.body.sculpture.rig import ramp
from s2glib.body.sculpture.skull import (
    BROW,
    CHIN,
    EYE,
    EYE_OPENING,
    EYE_RADIUS,
    MOUTH,
    MOUTH_ROUND,
    MOUTH_STRAIGHT,
    TOP,
    around_eye,
    around_mouth,
    corner_lift,
    hairline,
    relief,
    skull,
    skull_angle,
)
from s2glib.body.sculpture.solids import Solid, mirror

LAYOUT_RADIUS = 0.08  # metres per radian where the face is laid out flat
LID_SIZES = (1.0, 1.15, 1.32, 1.55)
LIP_LOOPS = np.array(  # size of a loop around the mouth, and half its height once closed
    [(1.0, 0.00012), (1.2, 0.0027), (1.4, 0.0054), (1.5, 0.0062), (1.85, 0.0100), (2.6, 0.0221)]
)
MOUTH_CAVE = ((0.004, 0.0016, 1.0), (0.008, 0.010, 0.98), (0.022, 0.013, 0.95), (0.036, 0.011, 0.8))


def face() -> Solid:
    """Skull, face, lids and mouth as one closed surface."""
    flat, lid, lip = _laid_out()
    triangles = Delaunay(flat).simplices
    hole = np.isin(triangles, lid).all(1) | np.isin(triangles, lip).all(1)
    triangles = triangles[~hole]
    a, b, c = flat[triangles].transpose(1, 2, 0)
    area = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]
    turned = np.where((area > 0)[:, None], triangles, triangles[:, ::-1])
    points, faces = [_shaped(flat)], [turned[np.abs(area) > 1e-10]]
    count = len(flat)
    bottom, top = (
        np.flatnonzero(flat[:, 1] == edge)[np.argsort(flat[flat[:, 1] == edge, 0])]
        for edge in (CHIN, TOP)
    )
    caves = _mouth_cave(points[0][lip])
    for edge, inner in ((lip, caves[0]), *((None, ring) for ring in caves[1:])):
        before = np.arange(count - len(inner), count) if edge is None else edge
        after = count + np.arange(len(inner))
        faces.append(np.stack([before[:-1], after[1:], after[:-1]], -1))
        faces.append(np.stack([before[:-1], before[1:], after[1:]], -1))
        points.append(inner)
        count += len(inner)
    last = np.arange(count - len(caves[-1]), count)
    throat = caves[-1].mean(0) * (0, 1, 1) + (0, 0, -0.004)
    fans = [
        (bottom, (0, CHIN, 0.04)),
        (top[::-1], (0, TOP + 0.001, 0)),
        (np.append(lid, lid[0])[::-1], EYE + (0, 0, 0.002)),
        (last[::-1], throat),
    ]
    for edge, pole in fans:
        faces.append(np.stack([edge[1:], edge[:-1], np.full(len(edge) - 1, count)], -1))
        points.append(np.array([pole]))
        count += 1
    return mirror(Solid(np.concatenate(points), np.concatenate(faces)))


def _laid_out() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of the left half as (angle * radius, height); which ring the eye; which the mouth."""
    lids = _lid_loops()
    lips = _lip_loops()
    front = np.concatenate([*lids, *lips, _nose_points(), _brow_points()])
    front[:, 0] = skull_angle(front[:, 0], front[:, 1]) * LAYOUT_RADIUS
    angle = np.linspace(0, np.pi, 29)
    under_hair = np.stack([angle * LAYOUT_RADIUS, hairline(angle) - 0.004], -1)
    first_lip = sum(map(len, lids))
    lid, lip = np.arange(len(lids[0])), first_lip + np.arange(len(lips[0]))
    return _filled(np.concatenate([front, under_hair])), lid, lip


def _lid_loops() -> list[np.ndarray]:
    turn = np.arange(20) * 2 * np.pi / 20
    circle = np.stack([np.cos(turn), np.sin(turn)], -1)
    return [EYE[:2] + size * EYE_OPENING * circle for size in LID_SIZES]


def _lip_loops() -> list[np.ndarray]:
    """Half loops from the middle of the lower lip around the corner to the upper lip."""
    turn = np.linspace(-np.pi / 2, np.pi / 2, 9)
    circle = np.stack([np.cos(turn), np.sin(turn)], -1)
    loops = []
    for size in LIP_LOOPS[:-1, 0]:
        corner = MOUTH + (MOUTH_STRAIGHT, 0) + size * MOUTH_ROUND * circle
        x = np.array([0.0, MOUTH_STRAIGHT / 2])
        low, high = (np.stack([x, np.full(2, corner[end, 1])], -1) for end in (0, -1))
        loops.append(np.concatenate([low, corner, high[::-1]]))
    return loops


def _nose_points() -> np.ndarray:
    columns = [0.0, 0.0045, 0.009, 0.0135, 0.0185]
    rows = [0.609, 0.6145, 0.620, 0.628, 0.638, 0.650, 0.662]
    grid = np.stack(np.meshgrid(columns, rows), -1).reshape(-1, 2)
    return grid[(around_eye(grid) > 1.75) & (around_mouth(grid) > 2.1)]


def _brow_points() -> np.ndarray:
    """Skin close to the brow on all sides, so that its edge stays crisp."""
    x, y, thick = BROW[::2].T
    sides = [np.stack([x, y + side * (thick + 0.002)], -1) for side in (-1, 1)]
    ends = [(0.0085, 0.6885), (0.0085, 0.6930), (0.0090, 0.6975), (0.0600, 0.6880)]
    ends += [(0.0, 0.675), (0.0, 0.684), (0.0, 0.693), (0.0, 0.702)]
    return np.concatenate([*sides, np.array(ends)])


def _filled(points: np.ndarray) -> np.ndarray:
    """Add a grid of points, wide apart where hair will hide them, wherever there is room."""
    end = np.pi * LAYOUT_RADIUS
    for spacing, reach in ((0.0124, 0.12), (0.028, end)):
        columns = np.linspace(0, reach, round(reach / spacing) + 1)
        rows = np.linspace(CHIN + 0.0085, TOP, round((TOP - CHIN) / spacing) + 1)
        for number, row in enumerate([CHIN, *rows]):
            between = number % 2 == 0 and 0 < number < len(rows)
            across = columns[:-1] + spacing / 2 if between else columns
            across = np.unique(np.concatenate([[0, end], across]))
            new = np.stack([across, np.full(len(across), row)], -1)
            seen = skull(new[:, 0] / LAYOUT_RADIUS, new[:, 1])
            room = cKDTree(points).query(new)[0] > 0.62 * spacing
            opening = np.minimum(around_eye(seen), around_mouth(seen)) < 1.5
            points = np.concatenate([points, new[room & ~(opening & (seen[:, 2] > 0))]])
    return points


def _shaped(flat: np.ndarray) -> np.ndarray:
    """From the layout to space: close the lips, add the relief, lay the lids on the eye."""
    laid = skull(flat[:, 0] / LAYOUT_RADIUS, flat[:, 1])
    points = skull(flat[:, 0] / LAYOUT_RADIUS, _closed(laid))
    points[:, 0] = np.where(np.isin(flat[:, 0], (0, np.pi * LAYOUT_RADIUS)), 0.0, laid[:, 0])
    front = points[:, 2] > 0
    lips = 0.0034 * np.exp(-0.5 * ((around_mouth(laid) - 1.22) / 0.2) ** 2)
    lips *= 1 - ramp(points[:, 0], 0.006, 0.027)
    points[:, 2] += np.where(front, relief(points) + lips, 0.0)
    return np.where(front[:, None], _on_the_eye(points), points)


def _closed(laid: np.ndarray) -> np.ndarray:
    """Heights with the mouth shut, which is laid out open so that its two lips stay apart."""
    size, height = LIP_LOOPS.T
    share = np.stack([size, height / (MOUTH_ROUND * size)], -1)
    share = np.interp(around_mouth(laid), *share.T)
    fade = np.exp(-0.5 * ((laid[:, 0] / 0.03) ** 2 + ((laid[:, 1] - MOUTH[1]) / 0.012) ** 2))
    lift = corner_lift(laid[:, 0]) * fade * (laid[:, 2] > 0)
    return np.where(laid[:, 2] > 0, MOUTH[1] + (laid[:, 1] - MOUTH[1]) * share, laid[:, 1]) + lift


def _on_the_eye(points: np.ndarray) -> np.ndarray:
    """Edges of the lids lie on the eyeball, and no skin lies below it."""
    aside = ((points[:, :2] - EYE[:2]) ** 2).sum(1)
    lying = EYE[2] + np.sqrt(np.clip((EYE_RADIUS + 0.0016) ** 2 - aside, 0, None))
    edge = 1 - ramp(around_eye(points), 1.0, 1.6)
    z = points[:, 2] + edge * (lying - points[:, 2])
    points[:, 2] = np.where(lying > EYE[2], np.maximum(z, lying), points[:, 2])
    return points


def _mouth_cave(lip: np.ndarray) -> list[np.ndarray]:
    """From the edge of the lips inwards: their inner side, then a cave with room for teeth."""
    up = np.sin(np.linspace(-np.pi / 2, np.pi / 2, len(lip)))[:, None]
    return [
        lip * (narrow, 1, 1) + up * (0, spread, 0) - (0, 0, back)
        for back, spread, narrow in MOUTH_CAVE
    ]
