"""What a notebook shows: numbers rounded alike, and figures with a caption and their extent.

Paper:    -
Notebook: -
"""

import io
from collections.abc import Iterator

import numpy as np
import torch
from IPython.display import display
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

CAPTION = range(40, 301)  # characters
DOTS_PER_INCH = 100


def report(**values: object) -> None:
    """Print values by name, floats with three significant digits, an underscore as a space."""
    width = max(map(len, values), default=0)
    for name, value in values.items():
        print(f"{name.replace('_', ' '):<{width}} : {spoken(value)}")


def spoken(value: object) -> str:
    """A value as text that is the same on every machine."""
    if isinstance(value, torch.Tensor):
        value = value.detach().numpy()
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return "(" + ", ".join(map(spoken, value)) + ")"
    if isinstance(value, float):
        return "0" if abs(value) < 1e-12 else f"{value:.3g}"
    return str(value)


def figure(fig: Figure, caption: str, *, exact: bool = True) -> None:
    """Show a figure, its caption, and one line that says how far the data reach.

    Args:
        fig: what to show; it is closed.
        caption: what there is to see, in 40 to 300 characters.
        exact: whether the data are the same on every machine. What a network made is not, and
            then the line is left out.

    Raises:
        ValueError: if an axis that is drawn has no label, or the caption is not of 40 to 300
            characters.
    """
    if len(caption) not in CAPTION:
        raise ValueError(f"a caption has 40 to 300 characters, got {len(caption)}: {caption!r}")
    for axes in fig.axes:
        _check_labels(axes)
    picture = _png(fig)
    plt.close(fig)
    reached = dict.fromkeys(fact for axes in fig.axes for fact in _extent(axes) if exact)
    facts = "; ".join(reached)
    display({"image/png": picture, "text/plain": "figure"}, raw=True)
    words = {
        "text/markdown": f"**Figure.** {caption}"
        + (f"\n\n<small>{facts}</small>" if facts else ""),
        "text/plain": f"{caption}\n{facts}".strip(),
    }
    display(words, raw=True)


def _png(fig: Figure) -> bytes:
    """The figure in 256 colours, which keeps notebooks small."""
    from PIL import Image

    drawn, small = io.BytesIO(), io.BytesIO()
    fig.savefig(drawn, format="png", dpi=DOTS_PER_INCH)
    Image.open(drawn).convert("RGB").quantize(256).save(small, "PNG", optimize=True)
    return small.getvalue()


def _check_labels(axes: Axes) -> None:
    if not axes.axison:
        return
    for name, siblings in (
        ("x", axes.get_shared_x_axes().get_siblings(axes)),
        ("y", axes.get_shared_y_axes().get_siblings(axes)),
    ):
        if not any(getattr(each, f"get_{name}label")() for each in siblings):
            raise ValueError(f"the {name} axis of {axes.get_title() or 'a figure'!r} has no label")


def _extent(axes: Axes) -> Iterator[str]:
    """How far the drawn data reach on each labelled axis, and in colour."""
    reach = axes.dataLim
    for label, low, high in (
        (axes.get_xlabel(), reach.x0, reach.x1),
        (axes.get_ylabel(), reach.y0, reach.y1),
    ):
        if axes.axison and label and np.isfinite([low, high]).all():
            yield f"{label}: {spoken(low)} to {spoken(high)}"
