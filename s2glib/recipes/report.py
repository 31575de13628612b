"""Figures with their intervals, held against what was aimed at, printed and written as JSON.

Paper:    -
Notebook: notebooks/17_motion_distances.ipynb
"""

import json
import math
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Shaped

from s2glib.metrics import bootstrap_interval
from s2glib.recipes.targets import TARGETS, Bounds, Target

_SEED = 0  # of the bootstrap


class Row(NamedTuple):
    """One figure of a table.

    `interval` is the 95 % bootstrap interval over clips, where there is one; `met` and `held` say
    whether the aim and the floor are reached; `recorded` marks figures taken from a recorded run.
    """

    name: str
    value: float
    n: int
    interval: tuple[float, float] | None = None
    recorded: bool = False

    @property
    def target(self) -> Target:
        """What was aimed at, by the row's name."""
        return TARGETS.get(self.name, Target())

    @property
    def met(self) -> bool | None:
        """Whether the aim is reached; None where there is none."""
        return _within(self.target.aim, self.value)

    @property
    def held(self) -> bool | None:
        """Whether the floor holds; None where there is none."""
        return _within(self.target.floor, self.value)

    def as_json(self) -> dict[str, Any]:
        """The row as it stands in the JSON file."""
        aim, floor = self.target
        return {
            "name": self.name,
            "value": self.value,
            "n": self.n,
            "interval": self.interval and list(self.interval),
            "aim": aim and str(aim),
            "met": self.met,
            "floor": floor and str(floor),
            "recorded": self.recorded,
        }


def figure(
    name: str,
    *values: Shaped[np.ndarray, "clips ..."],
    statistic: Callable[..., float] = np.mean,
) -> Row:
    """A row whose interval comes from drawing clips with replacement.

    Args:
        name: of the row.
        *values: one entry per clip; several arrays are drawn together.
        statistic: takes the arrays, gives the figure.
    """
    rng = np.random.default_rng(_SEED)
    value, low, high = bootstrap_interval(*values, statistic=statistic, rng=rng)
    return Row(name, value, len(values[0]), (low, high))


def share(name: str, right: Bool[np.ndarray, " clips"]) -> Row:
    """A row for how many clips came out right."""
    return figure(name, right.astype(float))


def ratio(name: str, ours: Shaped[np.ndarray, " clips"], real: Shaped[np.ndarray, " clips"]) -> Row:
    """A row for one mean over another, of the same clips."""
    return figure(name, ours, real, statistic=lambda a, b: a.mean() / b.mean())


def over_draws(name: str, values: Float[np.ndarray, " draws"], n: int) -> Row:
    """A row for a figure of whole sets of `n` clips; the interval is the range over the draws."""
    return Row(name, float(values.mean()), n, (float(values.min()), float(values.max())))


def table(rows: Sequence[Row]) -> str:
    """The rows as text, one line each."""
    width = max(len(row.name) for row in rows)
    head = ("", "value", "95 % interval", "n", "aim", "floor", "")
    lines = [_line(width, *head), *(_line(width, *_cells(row)) for row in rows)]
    return "\n".join(line.rstrip() for line in lines)


def write_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write the rows as a JSON list; the file appears whole or not at all."""
    text = json.dumps([row.as_json() for row in rows], indent=1, allow_nan=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    unfinished.write_text(text + "\n", encoding="utf8")
    unfinished.replace(path)


def _within(bounds: Bounds | None, value: float) -> bool | None:
    return None if bounds is None else bounds.low <= value <= bounds.high


def _line(width: int, name: str, *cells: str) -> str:
    value, interval, n, aim, floor, verdict = cells
    return f"{name:{width}}  {value:>7}  {interval:>16}  {n:>5}  {aim:>12}  {floor:>8}  {verdict}"


def _cells(row: Row) -> tuple[str, ...]:
    interval = "" if row.interval is None else " .. ".join(map(_short, row.interval))
    aim, floor = ("" if bounds is None else str(bounds) for bounds in row.target)
    verdict = {None: "", True: "met", False: "aim missed"}[row.met]
    verdict = "below the floor" if row.held is False else verdict
    verdict = f"{verdict} (recorded)".strip() if row.recorded else verdict
    return row.name, _short(row.value), interval, str(row.n), aim, floor, verdict


def _short(value: float) -> str:
    digits = 3 if math.isfinite(value) and abs(value) < 100 else 1
    return f"{value:.{digits}f}"
