"""What an exercise is, and how it is found.

The exercises of notebook NN are the tuple `EXERCISES` of the folder `notebook_NN` beside this file.
It is imported when one of them is wanted, so that a notebook loads only what it talks about.

Paper:    -
Notebook: -
"""

import importlib
import pkgutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Mutant:
    """A mistake that students make: the wrong code, and the hint that names it."""

    wrong: Callable[..., Any]
    hint: str


@dataclass(frozen=True)
class Exercise:
    """A function of the package for students to write themselves.

    Attributes:
        id: notebook and number, such as "01-2".
        title: what is to be done, in a few words.
        reference: the package's own function.
        inputs: the arguments to try, the simplest first, the last ones drawn from a generator.
            Where tensors among them require a gradient, gradients are compared, too.
        oracle: the same answer from an independent, slower form; tests compare the two.
        mutants: at least two.
        hints: from a nudge to almost the code.
        minutes: how long it takes.
        difficulty: 1 to 3.
        equation: where it stands in the papers, such as "MDD Eq. A2", or "-".
        tolerance: relative and absolute error that is forgiven.
        helpers: what the reference calls, shown with it.
    """

    id: str
    title: str
    reference: Callable[..., Any]
    inputs: Callable[[np.random.Generator], Iterable[tuple[Any, ...]]]
    oracle: Callable[..., Any]
    mutants: tuple[Mutant, ...]
    hints: tuple[str, ...]
    minutes: int
    difficulty: int
    equation: str = "-"
    tolerance: float = 1e-6
    helpers: tuple[Callable[..., Any], ...] = ()


def all_exercises() -> dict[str, Exercise]:
    """Every exercise by its id, in the order of the notebooks."""
    modules = pkgutil.iter_modules(importlib.import_module(__package__).__path__)
    notebooks = sorted(each.name[-2:] for each in modules if each.name.startswith("notebook_"))
    return {each.id: each for notebook in notebooks for each in _exercises_of(notebook)}


def find_exercise(id: str) -> Exercise:
    """The exercise with this id.

    Raises:
        ValueError: if there is none.
    """
    here = {each.id: each for each in _exercises_of(str(id)[:2])}
    if not isinstance(id, str) or id not in here:
        known = ", ".join(here or all_exercises())
        raise ValueError(f"there is no exercise {id!r}; there are {known}")
    return here[id]


def _exercises_of(notebook: str) -> tuple[Exercise, ...]:
    name = f"{__package__}.notebook_{notebook}"
    try:
        return importlib.import_module(name).EXERCISES
    except ModuleNotFoundError as missing:
        if missing.name != name:
            raise
        return ()
