"""Drawing warps: deformed grids, control points, flows and heatmaps, in image coordinates.

Paper:    MDD Sup. A, Fig. E1
Notebook: notebooks/02_thin_plate_splines.ipynb
"""

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

SOURCE, DRIVING, LINES = "#0072B2", "#D55E00", "#333333"  # Okabe and Ito's blue and vermilion


def draw_picture(axes: Axes, image: Float[np.ndarray, "3 height width"]) -> Axes:
    """Show a picture with values in [0, 1] so that its corner pixels lie on -1 and 1."""
    axes.imshow(np.clip(image, 0, 1).transpose(1, 2, 0), extent=_extent(*image.shape[1:]))
    return _frame(axes)


def draw_warped_grid(
    axes: Axes, grid: Float[np.ndarray, "height width 2"], *, every: int = 4
) -> Axes:
    """Draw the rows and columns of a warped grid as lines, the last ones too.

    Args:
        axes: where to draw.
        grid: where each pixel went, or, for a sampling grid, where it looks.
        every: how many pixels lie between two lines.
    """
    if every < 1:
        raise ValueError(f"lines are at least 1 pixel apart, got every={every}")
    rows, columns = (_thinned(size, every) for size in grid.shape[:2])
    lines = [*grid[rows], *grid.transpose(1, 0, 2)[columns]]
    axes.add_collection(LineCollection(lines, colors=LINES, linewidths=0.7))
    return _frame(axes)


def draw_carried_grid(
    axes: Axes, grid: Float[np.ndarray, "height width 2"], *, step: float = 0.25
) -> Axes:
    """Draw the lines of the source image that the warp carried along with the picture.

    A sampling grid says where each pixel looks: a line lies where it looks at a multiple of `step`.
    """
    height, width = grid.shape[:2]
    x, y = np.linspace(-1, 1, width), np.linspace(-1, 1, height)
    levels = step * np.arange(-round(1 / step), round(1 / step) + 1)
    for looked_at in np.moveaxis(grid, -1, 0):
        axes.contour(x, y, looked_at, levels, colors=LINES, linewidths=0.6, linestyles="solid")
    return _frame(axes)


def draw_control_points(
    axes: Axes, driving: Float[np.ndarray, "n 2"], source: Float[np.ndarray, "n 2"]
) -> Axes:
    """Mark keypoint pairs: an arrow leads from each source point to where it is driven."""
    axes.plot(*source.T, "o", color=SOURCE, markerfacecolor="white", label="source", zorder=4)
    axes.plot(*driving.T, "o", color=DRIVING, label="driving", zorder=5)
    for start, end in zip(source, driving, strict=True):
        axes.annotate(
            "", end, start, arrowprops={"arrowstyle": "->", "color": DRIVING, "linewidth": 1.5}
        )
    return _frame(axes)


def draw_flow(axes: Axes, flow: Float[np.ndarray, "height width 2"], *, every: int = 8) -> Axes:
    """Draw a backward flow: an arrow from every few pixels to the point they show, true to scale.

    Args:
        axes: where to draw.
        flow: the sampling grid.
        every: how many pixels lie between two arrows.
    """
    if every < 1:
        raise ValueError(f"arrows are at least 1 pixel apart, got every={every}")
    height, width = flow.shape[:2]
    rows, columns = np.ix_(_thinned(height, every), _thinned(width, every))
    x, y = np.linspace(-1, 1, width)[columns], np.linspace(-1, 1, height)[rows]
    x, y = np.broadcast_arrays(x, y)
    right, down = flow[rows, columns, 0] - x, flow[rows, columns, 1] - y
    axes.quiver(
        *(x, y, right, down), angles="xy", scale_units="xy", scale=1, color=SOURCE, width=0.004
    )
    return _frame(axes)


def draw_heatmap(
    axes: Axes,
    image: Float[np.ndarray, "3 height width"],
    heatmap: Float[np.ndarray, "map_height map_width"],
) -> Axes:
    """Lay a heatmap over a grey picture; where it is 0 the picture shows, brightest is its peak.

    The two may differ in size. Negative heat, as in driving minus source, is blue.
    """
    draw_picture(axes, np.broadcast_to(image.mean(0), image.shape))
    peak = float(np.abs(heatmap).max()) or 1.0
    strength = np.abs(heatmap) / peak
    axes.imshow(
        heatmap,
        extent=_extent(*heatmap.shape),
        cmap="coolwarm",
        vmin=-peak,
        vmax=peak,
        alpha=0.85 * strength,
    )
    return _frame(axes)


def _thinned(size: int, every: int) -> list[int]:
    """Every so many indices, and the last one."""
    return sorted({*range(0, size, every), size - 1})


def _extent(height: int, width: int) -> tuple[float, float, float, float]:
    """Left, right, bottom, top of a picture whose outermost pixel centres lie on -1 and 1."""
    x, y = 1 + 1 / max(width - 1, 1), 1 + 1 / max(height - 1, 1)
    return -x, x, y, -y


def _frame(axes: Axes) -> Axes:
    axes.set(xlim=(-1.1, 1.1), ylim=(1.1, -1.1), aspect="equal")
    axes.set(xlabel="x (image units)", ylabel="y (image units)")
    axes.set_xticks([-1, 0, 1])
    axes.set_yticks([-1, 0, 1])
    return axes
