"""Demos: a pure drawing function behind native controls, which tests itself.

A demo says what can be changed (`controls`), which states show its point (`grid`), and how a state
looks (`render`). Everything else is here: the controls, the picture, a spoken description, and a
self-test that moves the real controls.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import html
import math
import time
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, NamedTuple

import ipywidgets
from IPython.display import HTML

SLOWEST = 0.15  # seconds of computing that one picture may take


class Panel(NamedTuple):
    """One state of a demo: what is seen, what is said of it, and its figures.

    Attributes:
        picture: inline SVG or HTML.
        alt: the picture in words, for those who do not see it.
        facts: figures by name; finite, so that a test can read them.
    """

    picture: str
    alt: str
    facts: dict[str, float]


class Slider(NamedTuple):
    """A number to choose, from `low` to `high` in steps."""

    low: float
    high: float
    start: float
    step: float


class Demo(ipywidgets.VBox):
    """Base of all demos; a child gives `controls`, `grid` and `render`.

    Attributes:
        controls: by name a `Slider`, or the options of a dropdown, the first being the default.
        grid: states that the self-test visits, each naming some controls; corners belong in it.
        distinct: whether every state of the grid must look different.
    """

    controls: ClassVar[Mapping[str, Slider | Sequence]]
    grid: ClassVar[Sequence[Mapping[str, object]]]
    distinct: ClassVar[bool] = True

    def __init__(self) -> None:
        self._inputs = {name: _input(name, spec) for name, spec in self.controls.items()}
        self._defaults = self.state
        self._picture, self._spoken = ipywidgets.HTML(), ipywidgets.HTML()
        for each in self._inputs.values():
            each.observe(self._redraw, names="value")
        super().__init__([*self._inputs.values(), self._picture, self._spoken])
        self._redraw()

    def render(self, *_: Any, **state: Any) -> Panel:
        """Draw one state: the same state, the same panel; no widgets inside.

        A child names its controls here instead of taking any.
        """
        raise NotImplementedError(f"{type(self).__name__} does not say how it looks")

    @property
    def state(self) -> dict[str, object]:
        """What the controls say now."""
        return {name: each.value for name, each in self._inputs.items()}

    def set(self, **state) -> None:
        """Move controls, as a reader would."""
        for name, value in state.items():
            self._inputs[name].value = value

    def _redraw(self, _change=None) -> None:
        panel = self.render(**self.state)
        self._picture.value, self._spoken.value = _seen(panel), _said(panel)

    def selftest(self) -> None:
        """Visit the grid through the controls, compare the view with `render`, and say so.

        Raises:
            AssertionError: if a state shows something else than `render` draws, has a figure that
                is not finite, takes too long, or looks like another one.
        """
        try:
            pictures = {self._visit(state) for state in self.grid}
        finally:
            self.set(**self._defaults)
        if self.distinct and len(pictures) < len(self.grid):
            raise AssertionError(
                f"{len(self.grid)} states, but only {len(pictures)} look different"
            )
        print(f"{len(self.grid)} states, {len(pictures)} distinct")

    def _visit(self, state: Mapping[str, object]) -> str:
        self.set(**{**self._defaults, **state})
        started = time.process_time()
        panel = self.render(**self.state)
        seconds = time.process_time() - started
        if (self._picture.value, self._spoken.value) != (_seen(panel), _said(panel)):
            raise AssertionError(f"the view of {state} is not what render draws")
        if not panel.alt or not all(map(math.isfinite, panel.facts.values())):
            raise AssertionError(f"{state} has no description, or a figure that is not finite")
        if seconds > SLOWEST:
            raise AssertionError(
                f"{state} takes {seconds:.2f} s to draw, at most {SLOWEST} s is fine"
            )
        return panel.picture

    def strip(self, states: Sequence[Mapping[str, object]]) -> HTML:
        """Some states next to each other: what is seen where no kernel runs."""
        panels = [self.render(**{**self._defaults, **state}) for state in states]
        cells = "".join(
            f'<figure style="margin:0;max-width:24%">{_seen(panel)}'
            f"<figcaption>{html.escape(panel.alt)}</figcaption></figure>"
            for panel in panels
        )
        return HTML(f'<div style="display:flex;gap:1%;flex-wrap:wrap">{cells}</div>')

    def __repr__(self) -> str:
        first = ", ".join(f"{name}={value!r}" for name, value in self._defaults.items())
        return f"{type(self).__name__}: needs a running kernel; without one, .render({first})"


def _input(name: str, spec: Slider | Sequence) -> ipywidgets.ValueWidget:
    words = {"description": name.replace("_", " "), "style": {"description_width": "9em"}}
    if not isinstance(spec, Slider):
        return ipywidgets.Dropdown(options=spec, value=_first(spec), **words)
    whole = all(isinstance(number, int) for number in spec)
    kind = ipywidgets.IntSlider if whole else ipywidgets.FloatSlider
    return kind(min=spec.low, max=spec.high, value=spec.start, step=spec.step, **words)


def _first(options: Sequence) -> object:
    """The value of the first option, which may be a (label, value) pair."""
    return options[0][1] if isinstance(options[0], tuple) else options[0]


def _seen(panel: Panel) -> str:
    return f'<div role="img" aria-label="{html.escape(panel.alt)}">{panel.picture}</div>'


def _said(panel: Panel) -> str:
    return f'<p role="status" aria-live="polite">{html.escape(panel.alt)}</p>'
