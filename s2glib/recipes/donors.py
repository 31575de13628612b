"""Who lends what in a test: donors of emotion and style, and strangers for the reliance test.

Paper:    AM A (editing), E
Notebook: notebooks/09_disentanglement.ipynb
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Int

from s2glib.corpus.script import EMOTIONS, TRAIN_SENTENCES, Cell


def emotion_donors(cells: Sequence[Cell], rng: np.random.Generator) -> list[Cell]:
    """For each clip one of the same voice that says something else in another emotion."""
    return [
        _lender(cell, cell.speaker, _other(EMOTIONS, cell.emotion, rng), cells, rng)
        for cell in cells
    ]


def style_donors(cells: Sequence[Cell], rng: np.random.Generator) -> list[Cell]:
    """For each clip one of another voice that says something else in the same emotion."""
    voices = sorted({cell.speaker for cell in cells})
    return [
        _lender(cell, _other(voices, cell.speaker, rng), cell.emotion, cells, rng) for cell in cells
    ]


def strangers(classes: Int[np.ndarray, " n"], rng: np.random.Generator) -> Int[np.ndarray, " n"]:
    """For each clip the row of a random one that is of another class.

    Raises:
        ValueError: if all clips are of one class.
    """
    if len(set(classes.tolist())) < 2:
        raise ValueError("no clip differs in this factor; test on clips of two or more classes")
    return np.array([rng.choice(np.flatnonzero(classes != own)) for own in classes])


def _other(values: Sequence[str], own: str, rng: np.random.Generator) -> str:
    return str(rng.choice([value for value in values if value != own]))


def _lender(
    cell: Cell, speaker: str, emotion: str, cells: Sequence[Cell], rng: np.random.Generator
) -> Cell:
    """A clip of this voice and emotion with another sentence: of `cells`, else of their block."""
    fitting = [
        c
        for c in cells
        if (c.speaker, c.emotion) == (speaker, emotion) and c.sentence != cell.sentence
    ]
    if fitting:
        return fitting[rng.integers(len(fitting))]
    sentence = rng.choice([s for s in TRAIN_SENTENCES if s != cell.sentence])
    return Cell(int(sentence), speaker, emotion, cell.take)
