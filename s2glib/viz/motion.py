"""Drawing bodies: a stick figure seen from the front or the side, and strips of poses.

Paper:    AM Fig. A.8-A.10
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from s2glib.body.skeleton import JOINT_NAMES, PARENTS

LEFT, RIGHT, MIDDLE = "#0072B2", "#D55E00", "#333333"  # Okabe and Ito's blue and vermilion
_VIEWS = {"front": (0, 1), "side": (2, 1)}
_EYES = ("left_eye", "right_eye")


def _colour(name: str) -> str:
    return LEFT if name.startswith("left") else RIGHT if name.startswith("right") else MIDDLE


def draw_pose(
    axes: Axes, positions: Float[np.ndarray, "55 3"], *, view: str = "front", shift: float = 0.0
) -> Axes:
    """Draw one pose as bones; the body's left is blue, its right vermilion.

    Args:
        axes: where to draw.
        positions: joint positions in metres.
        view: "front" (x to the viewer's right) or "side" (z to the right).
        shift: metres to move the figure to the right.
    """
    if view not in _VIEWS:
        raise ValueError(f"a pose is drawn from the front or the side, got {view!r}")
    flat = positions[:, _VIEWS[view]] + (shift, 0.0)
    bones = [j for j, parent in enumerate(PARENTS) if parent >= 0 and JOINT_NAMES[j] not in _EYES]
    axes.add_collection(
        LineCollection(
            [flat[[PARENTS[j], j]] for j in bones],
            colors=[_colour(JOINT_NAMES[j]) for j in bones],
            linewidths=[0.8 if j > 24 else 2.2 for j in bones],
            capstyle="round",
        )
    )
    head = flat[JOINT_NAMES.index("head")] + (0.0, 0.07)
    axes.scatter(head[0], head[1], s=60, color=MIDDLE, zorder=3)
    return axes


def draw_strip(
    axes: Axes,
    positions: Float[np.ndarray, "frames 55 3"],
    fps: float | int,
    times: Sequence[float | int],
    *,
    view: str = "front",
    spacing: float = 1.3,
) -> Axes:
    """Draw a strip of poses at the given seconds, from left to right.

    Args:
        axes: where to draw.
        positions: joint positions in metres, frame by frame.
        fps: frames per second.
        times: seconds; a time after the end shows the last frame.
        view: "front" or "side".
        spacing: metres between figures.
    """
    for place, time in enumerate(times):
        frame = min(round(time * fps), len(positions) - 1)
        draw_pose(axes, positions[frame], view=view, shift=place * spacing)
    axes.set_xlim(-0.7, (len(times) - 1) * spacing + 0.7)
    axes.set_ylim(0.55, 2.05)
    axes.set_aspect("equal")
    axes.set_xticks([place * spacing for place in range(len(times))])
    axes.set_xticklabels([f"{time:.1f} s" for time in times])
    axes.set_yticks([])
    return axes
