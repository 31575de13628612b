"""Exercises in a notebook: check an answer, give a hint, show the solution.

Whatever a student writes, the notebook goes on: with the student's function if it is right, else
with the package's own. Under S2G_STRICT=1 a check that is not passed raises instead.

Paper:    -
Notebook: -
"""

import inspect
import os
import textwrap
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from typing import Any, NamedTuple

import numpy as np
import torch
from IPython.display import display
from torch import Tensor

from s2glib.teaching.comparison import arrays, brief, difference
from s2glib.teaching.exercises import Exercise, find_exercise
from s2glib.teaching.progress import record
from s2glib.teaching.source import source_panel

LINE = 90  # characters that JupyterLab shows without breaking a word
CHANGED = "The answer is right, but you changed the input; work on a copy."
_hints_given: Counter[str] = Counter()


class Attempt(NamedTuple):
    """One call of a function: what came back or was raised, and whether it changed its input."""

    value: object
    error: Exception | None
    changed: bool

    @property
    def is_empty(self) -> bool:
        """Whether nothing has been written yet."""
        nothing = self.error is None and (self.value is None or self.value is ...)
        return nothing or isinstance(self.error, NotImplementedError)


class Differentiated(NamedTuple):
    """What came back, and how its sum changes with each argument that asks for a gradient."""

    value: Tensor
    gradient: tuple[Tensor, ...]


def check(id: str, fn: Callable) -> Callable:
    """Say whether a function solves an exercise.

    Args:
        id: the exercise's id, such as "01-2".
        fn: the student's function.

    Returns:
        `fn` if it is right, else the package's own function.

    Raises:
        ValueError: if there is no such exercise.
        AssertionError: under S2G_STRICT=1 only, if `fn` is not right.
    """
    exercise = find_exercise(id)
    state, words = judge(exercise, fn)
    if state != "untried":
        record("exercise", id, state)
    solved = state == "solved"
    if not solved and os.environ.get("S2G_STRICT") == "1":
        raise AssertionError(words)
    _say(words)
    return fn if solved else exercise.reference


def judge(exercise: Exercise, fn: Callable) -> tuple[str, str]:
    """The state of an exercise, "solved", "tried" or "untried", and what to say of it."""
    name = f"Exercise {exercise.id}"
    goes_on = "The notebook goes on with the package's function."
    if fn is exercise.reference:
        return "untried", f"{name}: this is the package's function.\nRun the cell with yours again."
    cases = list(exercise.inputs(np.random.default_rng(0)))
    attempts = [attempt(fn, case) for case in cases]
    if all(each.is_empty for each in attempts):
        return "untried", f"{name} is not attempted yet (nothing is returned).\n{goes_on}"
    mistake = find_mistake(exercise, cases, attempts)
    if mistake is None:
        return "solved", f"{name} is solved.\nThe notebook goes on with your function."
    return "tried", f"{name} is not right yet. {mistake}\n{goes_on} Stuck? Open a hint below."


def attempt(fn: Callable, case: tuple[Any, ...]) -> Attempt:
    """Call a function on a copy of some arguments."""
    used, value, error = deepcopy(case), None, None
    try:
        value = with_gradients(fn(*used), used)
        _ = brief(value), list(arrays(value))  # what cannot be read is an error, too
    except Exception as raised:  # whatever a student's code does
        error = raised
    before, after = list(arrays(case)), list(arrays(used))
    same = len(before) == len(after) and all(map(_same, before, after))
    return Attempt(value, error, changed=not same)


def with_gradients(value: object, used: Sequence[object]) -> object:
    """The value; and, where arguments ask for one, the gradients of its sum, 0 if cut off."""
    wanted = [each for each in used if isinstance(each, Tensor) and each.requires_grad]
    if not wanted or not isinstance(value, Tensor):
        return value
    joined = value.sum() + sum(0 * each.sum() for each in wanted)
    return Differentiated(value, torch.autograd.grad(joined, wanted))


def _same(before: np.ndarray, after: np.ndarray) -> bool:
    return np.array_equal(before, after, equal_nan=True)


def find_mistake(
    exercise: Exercise, cases: Sequence[tuple], attempts: Sequence[Attempt]
) -> str | None:
    """A sentence on what is wrong; None if nothing is.

    A mistake that others have made before is named; of any other the first difference is told.
    """
    for case, each in zip(cases, attempts, strict=True):
        if each.error is not None:
            return f"{_spoken_case(exercise, case)}, {_spoken_error(each.error)}."
    values = [each.value for each in attempts]
    expected = [attempt(exercise.reference, case).value for case in cases]
    differences = list(_differences(exercise, expected, values))
    if not any(differences):
        return CHANGED if any(each.changed for each in attempts) else None
    for mutant in exercise.mutants:
        outcomes = [attempt(mutant.wrong, case).value for case in cases]
        if not any(_differences(exercise, outcomes, values)):
            return mutant.hint
    case, what = next(pair for pair in zip(cases, differences, strict=True) if pair[1])
    return f"{_spoken_case(exercise, case)}, {what}."


def _differences(exercise: Exercise, expected, got) -> Iterator[str | None]:
    for right, yours in zip(expected, got, strict=True):
        yield difference(right, yours, exercise.tolerance)


def _spoken_error(error: Exception) -> str:
    frame = error.__traceback__ and error.__traceback__.tb_next  # the first below our own call
    where = f" in line {frame.tb_lineno}" if frame else ""
    return f"it stops{where} with {type(error).__name__}: {brief(str(error))}"


def _spoken_case(exercise: Exercise, case: tuple) -> str:
    names = inspect.signature(exercise.reference).parameters
    return "For " + ", ".join(
        f"{name} = {brief(value)}" for name, value in zip(names, case, strict=False)
    )


def hint(id: str) -> None:
    """Print the next hint for an exercise.

    Raises:
        ValueError: if there is no such exercise.
    """
    hints = find_exercise(id).hints
    given = _hints_given[id]
    if given == len(hints):
        _say(f'Those were all {given} hints. show_solution("{id}") shows the code.')
        return
    _hints_given[id] += 1
    record("exercise", id, "hint")
    _say(f"Hint {given + 1} of {len(hints)}: {hints[given]}")


def _say(words: str) -> None:
    for line in words.splitlines():
        print(textwrap.fill(line, LINE))


def show_solution(id: str) -> None:
    """Show the package's own function, and the hints before it, each folded until clicked.

    Raises:
        ValueError: if there is no such exercise.
    """
    exercise = find_exercise(id)
    panels = [source_panel(each) for each in (exercise.reference, *exercise.helpers)]
    folds = {f"Hint {i}": text for i, text in enumerate(exercise.hints, start=1)}
    folds["Solution"] = "\n\n".join(panel["text/markdown"] for panel in panels)
    shown = {
        "text/markdown": "\n\n".join(
            f"<details><summary>{name}</summary>\n\n{text}\n\n</details>"
            for name, text in folds.items()
        ),
        "text/plain": "\n\n".join(panel["text/plain"] for panel in panels),
    }
    display(shown, raw=True)
