"""What a notebook does first: seeds, one thread, and figures that everybody can read.

Paper:    -
Notebook: -
"""

import re
from typing import Any

from s2glib.teaching.progress import record

PALETTE = {  # Okabe and Ito's colours, which stay apart for colour-blind readers
    "blue": "#0072B2",
    "vermilion": "#D55E00",
    "green": "#009E73",
    "purple": "#CC79A7",
    "orange": "#E69F00",
    "sky": "#56B4E9",
    "black": "#000000",
}
_STROKES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (1, 1)), (0, (3, 1, 1, 1)))
_STYLE: dict[Any, Any] = {
    "figure.constrained_layout.use": True,
    "font.size": 12,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": "medium",
    "axes.titlelocation": "left",
    "legend.frameon": False,
    "image.cmap": "cividis",
}


def setup(notebook: str) -> None:
    """Prepare a notebook: seed numpy and torch, use one thread, and set the style of figures.

    Args:
        notebook: its two digits, such as "01".

    Raises:
        ValueError: if that is no notebook's number.
    """
    if not re.fullmatch(r"[0-9]{2}", notebook):
        raise ValueError(f"a notebook is named by two digits, such as '01'; got {notebook!r}")
    import numpy as np
    import torch
    from cycler import cycler
    from matplotlib import rcParams

    np.random.seed(0)  # noqa: NPY002  (for libraries that draw from the global generator)
    torch.manual_seed(0)
    torch.set_num_threads(1)
    colours = cycler(color=list(PALETTE.values())) + cycler(linestyle=_STROKES)
    rcParams.update({**_STYLE, "axes.prop_cycle": colours})
    record("notebook", notebook, "opened")
    print(f"Notebook {notebook} is ready.")
