"""Drawing skinned bodies without a GPU: shaded triangles, the far ones first.

Paper:    AM Fig. A.8-A.10
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from s2glib.body import BodyModel, Motion, skin_motion

LIGHT = np.array([0.35, 0.5, 0.8])  # where it comes from: above, in front, the body's left
AMBIENT = 0.45  # brightness of what the light does not reach
CLAY = 0.72  # red, green and blue of a body without colours


def draw_surface(
    axes: Axes,
    vertices: Float[np.ndarray, "v 3"],
    faces: Int[np.ndarray, "f 3"],
    colors: Float[np.ndarray, "v 3"],
    *,
    turn: float = 0.0,
    shift: float = 0.0,
) -> Axes:
    """Draw a surface as seen from the front, in metres.

    Args:
        axes: where to draw.
        vertices: points of the posed surface.
        faces: three vertex numbers a triangle, counter-clockwise seen from outside.
        colors: red, green and blue of each vertex in [0, 1].
        turn: radians by which the body turns to its left before it is drawn.
        shift: metres to move the drawing to the right.
    """
    cosine, sine = np.cos(turn), np.sin(turn)
    seen = vertices @ np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
    corners = seen[faces]  # (f, 3, 3)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    front = np.flatnonzero(normals[:, 2] > 0)
    front = front[corners[front, :, 2].mean(axis=1).argsort()]
    facing = normals[front] / np.linalg.norm(normals[front], axis=1, keepdims=True)
    light = np.clip(facing @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)
    shade = AMBIENT + (1 - AMBIENT) * light
    paint = np.clip(colors[faces[front]].mean(axis=1) * shade[:, None], 0, 1)
    flat = corners[front, :, :2] + (shift, 0.0)
    axes.add_collection(
        PolyCollection(flat, facecolors=paint, edgecolors=paint, linewidths=0.3),
        autolim=False,
    )
    axes.set_aspect("equal")
    return axes


def draw_bodies(
    axes: Axes,
    motion: Motion,
    body: BodyModel,
    times: Sequence[float],
    *,
    turn: float = 0.0,
    spacing: float = 1.35,
) -> Axes:
    """Draw a body at the given seconds, from left to right, hips to head.

    Args:
        axes: where to draw.
        motion: what the body does.
        body: who does it.
        times: seconds; a time after the end shows the last frame.
        turn: radians by which the body turns to its left before it is drawn.
        spacing: metres between bodies.
    """
    frames = [min(round(time * motion.fps), motion.frames - 1) for time in times]
    tracks = (motion.poses[frames], motion.trans[frames], motion.expression[frames])
    surfaces = skin_motion(Motion(*tracks, motion.fps), body).vertices.numpy()
    faces = body.faces.numpy()
    colors = np.full(surfaces[0].shape, CLAY) if body.colors is None else body.colors.numpy()
    for place, surface in enumerate(surfaces):
        draw_surface(axes, surface, faces, colors, turn=turn, shift=place * spacing)
    places = spacing * np.arange(len(times))
    axes.set_xticks(places, [f"{time:.1f}" for time in times])
    axes.set(xlim=(-0.7, places[-1] + 0.7), ylim=(0.75, 1.85))
    axes.set(xlabel="time (s)", ylabel="height (m)")
    return axes
