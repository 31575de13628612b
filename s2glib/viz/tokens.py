"""Tokens as a table: a column for every time, a row for every group, coloured by how sure they are.

Paper:    PT A.2
Notebook: notebooks/06_masked_prediction.ipynb
"""

import numpy as np
from jaxtyping import Bool, Float
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

HIDDEN = "#d9d9d9"
CERTAINTY = "viridis"  # its name in matplotlib


def draw_tokens(
    axes: Axes,
    log_p: Float[np.ndarray, "time groups"],
    new: Bool[np.ndarray, "time groups"] | None = None,
    *,
    codes: int,
    seconds: float,
) -> Axes:
    """Draw a table of tokens: dark where a code came by chance, bright where it was certain.

    Args:
        axes: where to draw.
        log_p: log-probability of each token's code; nan where it is hidden, which is grey.
        new: tokens to be framed.
        codes: of a group; the darkest colour is a probability of one in so many.
        seconds: that a token takes.
    """
    time, groups = log_p.shape
    colours = colormaps[CERTAINTY].with_extremes(bad=HIDDEN)
    extent = (0, time * seconds, groups - 0.5, -0.5)
    shades = {"cmap": colours, "vmin": -np.log(codes), "vmax": 0.0}
    axes.imshow(np.ma.masked_invalid(log_p.T), extent=extent, aspect="auto", **shades)
    for token, group in [] if new is None else np.argwhere(new):
        corner = (token * seconds, group - 0.5)
        axes.add_patch(Rectangle(corner, seconds, 1, fill=False, edgecolor="black", linewidth=1.2))
    axes.set_yticks(range(groups))
    axes.set(xlabel="time (s)", ylabel="group")
    return axes
