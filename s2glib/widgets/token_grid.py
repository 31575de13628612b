"""A table of tokens as inline SVG: which are hidden, which are known, and how sure they were.

Paper:    PT A.2
Notebook: notebooks/06_masked_prediction.ipynb
"""

import math

import numpy as np
from jaxtyping import Bool, Float, Int
from matplotlib import colormaps
from matplotlib.colors import to_hex

from s2glib.viz.tokens import CERTAINTY, HIDDEN

WIDE, HIGH = 30.0, 26.0  # of a cell
LEFT, TOP = 64.0, 6.0  # of the table
TICK = 3  # tokens between two marks of the time axis
BRIGHT = 0.55  # colours above this share get dark numbers
_CELL = '<rect x="{x}" y="{y}" width="{wide}" height="{high}" fill="{fill}" {frame}/>'
_NUMBER = '<text x="{x}" y="{y}" font-size="12" text-anchor="middle" fill="{ink}">{words}</text>'
_WORDS = '<text x="{x}" y="{y}" font-size="13" text-anchor="{anchor}">{words}</text>'
_NEW = 'stroke="#000" stroke-width="2.5"'
_OLD = 'stroke="#fff" stroke-width="1"'
_GRADIENT = (
    '<linearGradient id="s2g-certainty">{stops}</linearGradient>'
    '<rect x="{x}" y="{y}" width="120" height="14" fill="url(#s2g-certainty)"/>'
)


def token_grid(
    tokens: Int[np.ndarray, "time groups"],
    log_p: Float[np.ndarray, "time groups"],
    new: Bool[np.ndarray, "time groups"],
    *,
    codes: int,
    seconds: float,
    drawn: bool,
) -> str:
    """The table as SVG.

    Args:
        tokens: codes; those that are hidden are not read.
        log_p: log-probability of each code when it was chosen; nan where the token is hidden.
        new: tokens that became known in the last step; they get a thick frame.
        codes: of a group.
        seconds: that a token takes.
        drawn: whether the hidden ones were drawn in the last step, and hidden again: a cross.
    """
    time, groups = tokens.shape
    cells = "".join(
        _cell(t, g, int(tokens[t, g]), float(log_p[t, g]), bool(new[t, g]), codes, drawn)
        for t in range(time)
        for g in range(groups)
    )
    below = TOP + groups * HIGH + 16
    marks = "".join(
        _words(LEFT + t * WIDE, below, f"{t * seconds:.1f}", "middle")
        for t in range(0, time + 1, TICK)
    )
    rows = "".join(
        _words(LEFT - 8, TOP + (g + 0.7) * HIGH, f"group {g}", "end") for g in range(groups)
    )
    size = f"{LEFT + time * WIDE + 20} {below + 48}"
    axis = _words(LEFT + time * WIDE / 2, below + 16, "time (s)", "middle")
    return (
        f'<svg viewBox="0 0 {size}" style="width:100%;max-width:760px" fill="currentColor">'
        f"{cells}{marks}{rows}{axis}{_legend(below + 30, codes)}</svg>"
    )


def _cell(t: int, g: int, code: int, log_p: float, new: bool, codes: int, drawn: bool) -> str:
    x, y = LEFT + t * WIDE, TOP + g * HIGH
    middle = {"x": x + WIDE / 2, "y": y + 0.7 * HIGH}
    if math.isnan(log_p):
        fill, number = HIDDEN, _NUMBER.format(**middle, ink="#555", words="×" if drawn else "")
    else:
        share = 1 + log_p / math.log(codes)
        fill = to_hex(colormaps[CERTAINTY](max(share, 0.0)))
        ink = "#000" if share > BRIGHT else "#fff"
        number = _NUMBER.format(**middle, ink=ink, words=code)
    inset = 2 if new else 0.5
    box = {"x": x + inset, "y": y + inset, "wide": WIDE - 2 * inset, "high": HIGH - 2 * inset}
    return _CELL.format(**box, fill=fill, frame=_NEW if new else _OLD) + number


def _legend(y: float, codes: int) -> str:
    stops = "".join(
        f'<stop offset="{share}" stop-color="{to_hex(colormaps[CERTAINTY](share))}"/>'
        for share in np.linspace(0, 1, 9)
    )
    bar = _GRADIENT.format(stops=stops, x=LEFT + 150, y=y)
    around = _words(LEFT + 145, y + 12, f"probability 1/{codes}", "end")
    said = "1, when it was chosen; framed: new; ×: hidden again"
    return bar + around + _words(LEFT + 276, y + 12, said, "start")


def _words(x: float, y: float, words: str, anchor: str) -> str:
    return _WORDS.format(x=x, y=y, words=words, anchor=anchor)
