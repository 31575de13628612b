"""Drawing what is kept of a motion: a row for each part of the body, over time.

Paper:    PT A.2, A.3 (motion context)
Notebook: notebooks/07_refiner.ipynb
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool
from matplotlib.axes import Axes

KEPT, MADE = "#0072B2", "#F3E7D8"  # Okabe and Ito's blue, and paper


def draw_kept(
    axes: Axes, kept: Bool[np.ndarray, "frames parts"], fps: float | int, names: Sequence[str]
) -> Axes:
    """Draw a bar for each part, the first one above: blue where it is kept, hatched elsewhere.

    Args:
        axes: where to draw.
        kept: true where motion is kept.
        fps: frames per second.
        names: of the parts.
    """
    seconds = len(kept) / fps
    for row, known in enumerate(kept.T):
        axes.barh(row, seconds, 0.8, color=MADE, edgecolor="#B9A48F", hatch="////", linewidth=0)
        edges = np.flatnonzero(np.diff(np.pad(known, 1).astype(int))).reshape(-1, 2) / fps
        spans = [(start, end - start) for start, end in edges]
        axes.broken_barh(spans, (row - 0.4, 0.8), color=KEPT)
    words = [name.replace("_", " ") for name in names]
    axes.set_yticks(range(len(words)), words)
    axes.set(xlabel="time (s)", ylabel="part", xlim=(0, seconds), ylim=(len(words) - 0.5, -0.5))
    return axes
