"""Drawing decoupled motion: groups of keypoints, weight maps, flows, occlusion masks.

Paper:    MDD 3.2, B.1, B.5
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

from s2glib.viz.warps import DRIVING, draw_flow, draw_picture

GROUPS = (  # Okabe and Ito's colours, and two greys; one for each group of keypoints, by turns
    *("#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442", "#000000"),
    *("#666666", "#AAAAAA"),
)
MARKERS = "osD^vP*X<>"  # so that groups stay apart without colours
STILL = "#FFFFFF"  # where the background's map counts


def group_colours(groups: int) -> Float[np.ndarray, "groups 3"]:
    """Red, green and blue in [0, 1] of so many groups."""
    return np.array([to_rgb(GROUPS[k % len(GROUPS)]) for k in range(groups)])


def draw_keypoint_groups(
    axes: Axes,
    image: Float[np.ndarray, "3 height width"],
    keypoints: Float[np.ndarray, "groups points 2"],
) -> Axes:
    """Mark keypoints on a picture; each group has a colour and a shape of its own."""
    draw_picture(axes, 0.5 + 0.5 * np.clip(image, 0, 1))  # pale, so that the points stand out
    for k, (group, colour) in enumerate(zip(keypoints, group_colours(len(keypoints)), strict=True)):
        axes.plot(
            *group.T,
            MARKERS[k % len(MARKERS)],
            color=colour,
            markersize=6,
            markeredgecolor="white",
            markeredgewidth=0.5,
            label=f"group {k + 1}",
        )
    return axes


def draw_weight_maps(
    axes: Axes, contributions: Float[np.ndarray, "groups_and_background height width"]
) -> Axes:
    """Mix the groups' colours at every pixel as their warps are mixed; the background's is white.

    Args:
        axes: where to draw.
        contributions: weights of the background and of the K warps, which sum to 1.
    """
    colours = np.vstack([to_rgb(STILL), group_colours(len(contributions) - 1)])
    return draw_picture(axes, np.einsum("khw,kc->chw", contributions, colours))


def draw_moving_flow(
    axes: Axes,
    image: Float[np.ndarray, "3 height width"],
    flow: Float[np.ndarray, "flow_height flow_width 2"],
    *,
    every: int = 2,
) -> Axes:
    """Draw a backward flow over a pale picture, as `draw_flow` does; the two may differ in size."""
    draw_picture(axes, 0.7 + 0.3 * np.clip(image, 0, 1))
    return draw_flow(axes, flow, every=every)


def draw_occlusion(
    axes: Axes,
    image: Float[np.ndarray, "3 height width"],
    visible: Float[np.ndarray, "mask_height mask_width"],
) -> Axes:
    """Cover with vermilion what an occlusion mask hides: 1 = visible, 0 = to be painted.

    The mask may be coarser than the picture; one sees its pixels.
    """
    draw_picture(axes, np.broadcast_to(image.mean(0), image.shape))
    cover = np.empty((*visible.shape, 4))
    cover[..., :3], cover[..., 3] = to_rgb(DRIVING), 1 - np.clip(visible, 0, 1)
    axes.imshow(cover, extent=axes.images[0].get_extent())
    return axes
