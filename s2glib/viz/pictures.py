"""Drawing what is right and wrong in pictures: masks, boxes, Gram matrices, receptive fields.

Paper:    MDD B.3
Notebook: notebooks/04_repairing_pixels.ipynb
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch, Rectangle

from s2glib.viz.warps import draw_picture

COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7")  # Okabe and Ito's
STROKES = ("-", "--", "-.", ":")


def draw_masks(
    axes: Axes,
    image: Float[np.ndarray, "3 height width"],
    masks: Mapping[str, Bool[np.ndarray, "height width"]],
) -> Axes:
    """Colour the places of some masks on a grey picture, and name them in a legend."""
    grey = np.broadcast_to(image.mean(0), image.shape).copy()
    for (_, mask), colour in zip(masks.items(), COLOURS, strict=False):
        grey[:, mask] = 0.4 * grey[:, mask] + 0.6 * np.array(to_rgb(colour))[:, None]
    draw_picture(axes, grey)
    patches = [
        Patch(color=colour, label=name) for name, colour in zip(masks, COLOURS, strict=False)
    ]
    axes.legend(handles=patches, loc="lower left", bbox_to_anchor=(0, 1), ncols=len(masks))
    return axes


def draw_boxes(axes: Axes, masks: Sequence[Bool[np.ndarray, "height width"]]) -> Axes:
    """Outline the smallest box about each mask, as MDD's code does; an empty one has none."""
    for mask in masks:
        if mask.any():
            height, width = mask.shape
            rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
            left, right = (2 * (columns[[0, -1]] + (-0.5, 0.5)) / (width - 1) - 1).tolist()
            top, bottom = (2 * (rows[[0, -1]] + (-0.5, 0.5)) / (height - 1) - 1).tolist()
            _outline(axes, (left, top), right - left, bottom - top)
    return axes


def draw_gram(
    axes: Axes,
    matrix: Float[np.ndarray, "c c"],
    names: Sequence[str],
    *,
    peak: float | None = None,
) -> Axes:
    """Show a Gram matrix; blue is negative, red positive.

    Args:
        axes: where to draw.
        matrix: of a few channels.
        names: of the channels.
        peak: what is drawn darkest; None: the largest value.
    """
    peak = peak or float(np.abs(matrix).max()) or 1.0
    axes.imshow(matrix, cmap="coolwarm", vmin=-peak, vmax=peak)
    axes.set_xticks(range(len(names)), names, rotation=90, fontsize=8)
    axes.set_yticks(range(len(names)), names, fontsize=8)
    return axes


def draw_receptive_fields(
    axes: Axes, image: Float[np.ndarray, "3 height width"], sizes: Mapping[str, int]
) -> Axes:
    """Draw squares of so many pixels about the middle of a picture, each with its name.

    One that is larger than the picture is named, but not to be seen.
    """
    draw_picture(axes, 0.5 + 0.5 * np.clip(image, 0, 1))
    for k, (name, size) in enumerate(sizes.items()):
        half = size / (image.shape[-1] - 1)
        _outline(axes, (-half, -half), 2 * half, 2 * half, k, f"{name}: {size}")
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    return axes


def _outline(
    axes: Axes,
    corner: tuple[float, float],
    width: float,
    height: float,
    kind: int = 0,
    label: str | None = None,
) -> None:
    axes.add_patch(
        Rectangle(
            corner,
            width,
            height,
            fill=False,
            linewidth=1.5,
            color=COLOURS[kind % len(COLOURS)],
            linestyle=STROKES[kind % len(STROKES)],
            label=label,
        )
    )
