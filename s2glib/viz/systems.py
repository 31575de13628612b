"""A map of the three systems: what each makes of speech, step by step, and where you build it.

Paper:    PT A, AM Fig. A.4, MDD B
Notebook: notebooks/00_start_here.ipynb
"""

from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch


class Step(NamedTuple):
    """One box of the map, and the notebooks that build it."""

    what: str
    notebooks: str


class System(NamedTuple):
    """One row of the map: a name, a colour, and steps from left to right."""

    name: str
    colour: str
    steps: tuple[Step, ...]


SYSTEMS = (
    System(
        "ProbTalk",
        "#0072B2",
        (
            Step("speech, speaker,\nany known frames", "01"),
            Step("motion as codes\nfrom small books", "05"),
            Step("predict the\nmasked codes", "06"),
            Step("refine the\nmotion", "07"),
            Step("body, hands\nand face", "22"),
        ),
    ),
    System(
        "AMUSE",
        "#D55E00",
        (
            Step("speech", "01"),
            Step("content, emotion,\nstyle apart", "08 09"),
            Step("denoise a\nmotion latent", "10 13"),
            Step("decode it with\na motion prior", "12"),
            Step("3-D body, emotion\nof your choice", "14 22"),
        ),
    ),
    System(
        "S2G-MDDiffusion",
        "#009E73",
        (
            Step("speech and\none picture", "01"),
            Step("picture as\nmoving keypoints", "02 03"),
            Step("denoise the\nkeypoints' paths", "10 11 15"),
            Step("warp the picture,\nmend its pixels", "03 04"),
            Step("a video of\nthat person", "19 22"),
        ),
    ),
)
STAGES = (
    "what goes in",
    "how motion or\nspeech is written",
    "what is generated",
    "what finishes it",
    "what comes out",
)
_WIDTH, _HEIGHT, _ACROSS, _DOWN = 1.0, 0.5, 1.22, 0.86


def draw_systems(axes: Axes) -> Axes:
    """Draw the map: one row a system, arrows from speech to motion."""
    for column, stage in enumerate(STAGES):
        axes.text(column * _ACROSS, 0.62, stage, ha="center", style="italic", color="#444444")
    for row, system in enumerate(SYSTEMS):
        middle = -row * _DOWN
        axes.text(-0.5, middle + 0.32, system.name, weight="bold", color=system.colour)
        for column, step in enumerate(system.steps):
            _draw_step(axes, step, system.colour, column * _ACROSS, middle)
            if column:
                _draw_arrow(axes, system.colour, column * _ACROSS, middle)
    axes.set(xlim=(-0.55, 4 * _ACROSS + 0.55), ylim=(-2 * _DOWN - 0.3, 0.9))
    axes.axis("off")
    return axes


def _draw_step(axes: Axes, step: Step, colour: str, x: float, y: float) -> None:
    corner = (x - _WIDTH / 2, y - _HEIGHT / 2)
    box = FancyBboxPatch(corner, _WIDTH, _HEIGHT, boxstyle="round,pad=0,rounding_size=0.05")
    box.set(facecolor="white", edgecolor=colour, linewidth=2)
    axes.add_patch(box)
    axes.text(x, y + 0.06, step.what, ha="center", va="center", fontsize=12)
    axes.text(x, y - 0.18, step.notebooks, ha="center", va="center", fontsize=11, color=colour)


def _draw_arrow(axes: Axes, colour: str, x: float, y: float) -> None:
    tip, tail = (x - _WIDTH / 2, y), (x - _ACROSS + _WIDTH / 2, y)
    axes.annotate("", tip, tail, arrowprops={"arrowstyle": "->", "color": colour, "linewidth": 2})
