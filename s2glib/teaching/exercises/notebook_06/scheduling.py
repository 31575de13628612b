"""Exercise 06-3: how many tokens are hidden again after each step.

Paper:    PT A.2 (schedule: authors' code, after MaskGIT)
Notebook: -
"""

import math
from collections.abc import Iterator

import numpy as np

from s2glib.papers.probtalk import remask_counts
from s2glib.teaching.exercises.exercise import Exercise, Mutant


def schedule_inputs(rng: np.random.Generator) -> Iterator[tuple[int, int]]:
    """The paper's window, one step, more steps than tokens, and any numbers."""
    yield 88, 8
    yield 88, 1
    yield 3, 6
    yield int(rng.integers(20, 200)), int(rng.integers(3, 30))


def schedule_oracle(tokens: int, steps: int) -> list[int]:
    """By the sine of what is left of a right angle, in degrees."""
    counts: list[int] = []
    for step in range(1, steps + 1):
        left = math.sin(math.radians(90 * (steps - step) / steps))
        most = (counts or [tokens])[-1] - 1
        counts.append(max(0, min(int(tokens * left + 1e-9), most)))
    return counts


def _by(
    tokens: int, steps: int, shares: list[float], *, fewer: bool = True, kind=math.floor
) -> list[int]:
    """Counts from the share that is to be hidden after each step."""
    counts, unknown = [], tokens
    for share in shares:
        most = unknown - 1 if fewer else tokens
        unknown = max(0, min(kind(tokens * share), most))
        counts.append(unknown)
    return counts


def _angles(steps: int, first: int = 1) -> list[float]:
    return [(first + k) / steps * math.pi / 2 for k in range(steps)]


def newly_known(tokens: int, steps: int) -> list[int]:
    """How many are known after each step."""
    return [tokens - count for count in remask_counts(tokens, steps)]


def sine(tokens: int, steps: int) -> list[int]:
    """Most are hidden at the end."""
    return _by(tokens, steps, [math.sin(a) for a in _angles(steps)], fewer=False)


def straight(tokens: int, steps: int) -> list[int]:
    """As many in each step."""
    return _by(tokens, steps, [1 - step / steps for step in range(1, steps + 1)])


def whole_angle(tokens: int, steps: int) -> list[int]:
    """The cosine of r pi: already negative half-way."""
    return _by(tokens, steps, [math.cos(2 * a) for a in _angles(steps)])


def too_early(tokens: int, steps: int) -> list[int]:
    """Steps counted from zero: after the last, some are still hidden."""
    return _by(tokens, steps, [math.cos(a) for a in _angles(steps, first=0)])


def rounded(tokens: int, steps: int) -> list[int]:
    """Rounded, not cut."""
    return _by(tokens, steps, [math.cos(a) for a in _angles(steps)], kind=round)


def unbounded(tokens: int, steps: int) -> list[int]:
    """A step may reveal nothing."""
    return _by(tokens, steps, [math.cos(a) for a in _angles(steps)], fewer=False)


SCHEDULE = Exercise(
    id="06-3",
    title="how many are hidden again",
    reference=remask_counts,
    inputs=schedule_inputs,
    oracle=schedule_oracle,
    minutes=12,
    difficulty=2,
    equation="PT A.2",
    mutants=(
        Mutant(newly_known, "You count the known tokens; the list is of those that are hidden."),
        Mutant(sine, "You took the sine, which grows; the cosine falls from 1 to 0."),
        Mutant(
            straight,
            "You reveal as many in every step; the cosine reveals few at first and many at last.",
        ),
        Mutant(whole_angle, "Your cosine runs to pi; it has to end at pi / 2, where it is 0."),
        Mutant(
            too_early,
            "Your steps begin at 0, so that tokens are still hidden at the end; the ratio after "
            "step k is k / steps, k from 1.",
        ),
        Mutant(rounded, "You round to the nearest number; the authors round down."),
        Mutant(
            unbounded,
            "Some of your steps reveal nothing: at least one token must become known, as long as "
            "there are any.",
        ),
    ),
    hints=(
        "For step k from 1 to `steps` the ratio is r = k / steps: "
        "`math.floor(tokens * math.cos(r * math.pi / 2))`.",
        "Keep in mind how many were hidden before the step; there must be at least one less, and "
        "never less than 0.",
        "`hidden = max(0, min(cosine, hidden - 1))`, beginning with all of the tokens.",
    ),
)
