"""Sculpting: rings of points become solids, solids become one joined, mirror-symmetric surface.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.interpolate import PchipInterpolator
from scipy.sparse import coo_matrix, diags
from scipy.sparse.csgraph import connected_components


class Solid(NamedTuple):
    """A closed triangle mesh; faces turn counter-clockwise when seen from outside."""

    vertices: Float[np.ndarray, "v 3"]
    faces: Int[np.ndarray, "f 3"]


class Surface(NamedTuple):
    """The union of several solids, and from which of them each vertex came."""

    vertices: Float[np.ndarray, "v 3"]
    faces: Int[np.ndarray, "f 3"]
    membership: Bool[np.ndarray, "v parts"]  # a vertex on a seam belongs to several parts


def profile(table: Float[np.ndarray, "k c"], at: Float[np.ndarray, " n"]) -> np.ndarray:
    """Read a table (first column: where; others: values) at other places, without overshoot."""
    return PchipInterpolator(table[:, 0], table[:, 1:])(at)


def ring(
    center: Sequence[float] | np.ndarray,
    first: np.ndarray,
    second: np.ndarray,
    *,
    sides: int,
    roundness: float = 2.0,
) -> Float[np.ndarray, "sides 3"]:
    """A superellipse around `center`, from axis `first` towards axis `second` (lengths = radii)."""
    angle = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    power = 2 / roundness
    return (
        np.asarray(center)
        + np.sign(cos) * np.abs(cos) ** power * np.asarray(first)
        + np.sign(sin) * np.abs(sin) ** power * np.asarray(second)
    )


def loft(rings: Float[np.ndarray, "k sides 3"]) -> Solid:
    """Skin a row of rings and close both ends with a fan around the middle of the end ring.

    The rings turn counter-clockwise when looked at against the direction they advance in.
    """
    rings = np.asarray(rings)
    count, sides, _ = rings.shape
    index = np.arange(count * sides).reshape(count, sides)
    here, after = index, np.roll(index, -1, axis=1)
    a, b, c, d = here[:-1], after[:-1], after[1:], here[1:]
    walls = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    start, end = count * sides, count * sides + 1
    lid = np.stack([after[0], here[0], np.full(sides, start)], -1)
    base = np.stack([here[-1], after[-1], np.full(sides, end)], -1)
    poles = np.stack([rings[0].mean(0), rings[-1].mean(0)])
    return Solid(np.concatenate([rings.reshape(-1, 3), poles]), np.concatenate([walls, lid, base]))


def tube(
    path: Float[np.ndarray, "k 3"],
    radii: Float[np.ndarray, "k 2"],
    *,
    second: np.ndarray,
    sides: int,
    roundness: float = 2.0,
) -> Solid:
    """A loft along a path whose rings stand across it; `second` points along the second radius."""
    path, radii = np.asarray(path, float), np.asarray(radii, float)
    forward = np.gradient(path, axis=0)
    first = np.cross(second, forward)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    across = np.cross(forward, first)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return loft(
        np.stack(
            [
                ring(p, a * u, b * w, sides=sides, roundness=roundness)
                for p, u, w, (a, b) in zip(path, first, across, radii, strict=True)
            ]
        )
    )


def join(parts: list[Solid], *, shortest: float) -> Surface:
    """Union the parts (those beside the body's middle: left side only) and mirror the left half.

    Edges below `shortest` metres, the splinters that a union leaves along its seams, collapse.
    """
    from manifold3d import Manifold, Mesh

    first = Manifold.reserve_ids(len(parts))
    whole = Manifold()
    for identity, (vertices, faces) in enumerate(parts, start=first):
        whole += Manifold(
            Mesh(
                vertices.astype(np.float32),
                faces.astype(np.uint32),
                run_index=np.array([0, 3 * len(faces)], dtype=np.uint32),
                run_original_id=np.array([identity], dtype=np.uint32),
            )
        )
    half = whole.trim_by_plane((1.0, 0.0, 0.0), 0.0).to_mesh()
    part = np.repeat(half.run_original_id, np.diff(half.run_index) // 3).astype(int) - first
    vertices = np.asarray(half.vert_properties[:, :3], dtype=float)
    vertices[np.abs(vertices[:, 0]) < 1e-5, 0] = 0.0
    faces = np.asarray(half.tri_verts, dtype=np.int64)
    vertices, faces, part = _weld(vertices, faces, part, shortest)
    outside = _largest_component(faces, len(vertices))
    faces, part = faces[outside], part[outside]
    is_cut = (vertices[faces, 0] == 0).all(axis=1)
    solid = mirror(Solid(vertices, faces[~is_cut]))
    membership = np.zeros((len(solid.vertices), len(parts)), dtype=bool)
    owner = np.concatenate([part[~is_cut]] * 2)
    membership[solid.faces.ravel(), np.repeat(owner, 3)] = True
    return Surface(*solid, membership)


def _weld(
    vertices: np.ndarray, faces: np.ndarray, part: np.ndarray, shortest: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Collapse short edges at seams, one after the other, where the surface stays sound."""
    around: list[set[int]] = [set() for _ in vertices]
    for number, face in enumerate(faces):
        for corner in face:
            around[corner].add(number)
    alive = np.ones(len(faces), dtype=bool)
    for keep, drop in _short_seam_edges(vertices, faces, part, shortest):
        shared = around[keep] & around[drop]
        if len(shared) != 2:
            continue
        common = set(faces[list(around[keep])].flat) & set(faces[list(around[drop])].flat)
        moving = np.array(sorted(around[drop] - shared), dtype=np.int64)
        moved = np.where(faces[moving] == drop, keep, faces[moving])
        if len(common) != 4 or _turns(vertices, faces[moving], moved):
            continue
        faces[moving] = moved
        alive[list(shared)] = False
        around[keep] |= around[drop]
        around[drop] = set()
        for number in shared:
            for corner in faces[number]:
                around[corner].discard(number)
    used, faces = np.unique(faces[alive], return_inverse=True)
    return vertices[used], faces.reshape(-1, 3), part[alive]


def _largest_component(faces: np.ndarray, count: int) -> np.ndarray:
    """Which faces belong to the largest connected surface: not to bubbles inside, not to crumbs."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_matrix((np.ones(len(edges)), edges.T), shape=(count, count))
    label = connected_components(graph, directed=False)[1][faces[:, 0]]
    return label == np.bincount(label).argmax()


def _short_seam_edges(
    vertices: np.ndarray, faces: np.ndarray, part: np.ndarray, shortest: float
) -> Int[np.ndarray, "e 2"]:
    """Short edges as (vertex to keep, to drop), shortest first; the middle plane is kept."""
    members = np.zeros((len(vertices), part.max() + 2), dtype=bool)
    members[faces.ravel(), np.repeat(part, 3)] = True
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = np.unique(np.sort(edges, axis=1), axis=0)
    length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    worth = 2 * (vertices[:, 0] == 0) + (members.sum(1) > 1)
    edges = np.take_along_axis(edges, np.argsort(-worth[edges], axis=1, kind="stable"), axis=1)
    both_free = (vertices[edges[:, 1], 0] != 0) & (worth[edges[:, 0]] > 0)
    edges, length = edges[both_free], length[both_free]
    return edges[np.argsort(length, kind="stable")][: (length < shortest).sum()]


def _turns(vertices: np.ndarray, before: np.ndarray, after: np.ndarray) -> bool:
    """Whether a triangle would turn over, or nearly."""
    normals = []
    for faces in (before, after):
        a, b, c = vertices[faces].transpose(1, 0, 2)
        normal = np.cross(b - a, c - a)
        normals.append(normal / (np.linalg.norm(normal, axis=1, keepdims=True) + 1e-15))
    return bool(((normals[0] * normals[1]).sum(1) < 0.6).any())


def mirror(half: Solid) -> Solid:
    """Close a left half, open at x = 0, with its mirror image."""
    used, faces = np.unique(half.faces, return_inverse=True)
    vertices, faces = half.vertices[used], faces.reshape(-1, 3)
    aside = np.flatnonzero(vertices[:, 0] != 0)
    twin = np.arange(len(vertices))
    twin[aside] = len(vertices) + np.arange(len(aside))
    both = np.concatenate([vertices, vertices[aside] * (-1, 1, 1)])
    return Solid(both, np.concatenate([faces, twin[faces][:, ::-1]]))


def smooth(
    values: Float[np.ndarray, "v c"],
    faces: Int[np.ndarray, "f 3"],
    amount: Float[np.ndarray, " v"],
    *,
    rounds: int,
) -> Float[np.ndarray, "v c"]:
    """Pull each vertex's values towards the mean of its neighbours, `amount` in [0, 1] a round."""
    count = len(values)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ones = np.ones(len(edges))
    graph = coo_matrix((ones, edges.T), shape=(count, count))
    graph = ((graph + graph.T) > 0).astype(float)
    mean = diags(1 / np.asarray(graph.sum(1)).ravel()) @ graph
    for _ in range(rounds):
        values = values + amount[:, None] * (mean @ values - values)
    return values
