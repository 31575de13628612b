"""The training clips as a table of factors, and batches drawn from it.

Paper:    AM B.4, F
Notebook: notebooks/09_disentanglement.ipynb
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from s2glib.corpus.build import timing_of
from s2glib.corpus.script import EMOTIONS, SENTENCES, SPEAKERS, Cell
from s2glib.papers.amuse.cross_reconstruction import Donors


class FactorBatch(NamedTuple):
    """A target clip, three donors of its factors, and its labels."""

    target: Float[Tensor, "batch frames mels"]
    donors: Donors
    emotion: Int[Tensor, " batch"]
    style: Int[Tensor, " batch"]


class QuadrupleBatch(NamedTuple):
    """Quadruples in the order (c1, s1), (c2, s1), (c1, s2), (c2, s2)  [AM B.4]."""

    clips: Float[Tensor, "4 batch frames mels"]
    emotion: Int[Tensor, " batch"]
    style: Int[Tensor, "4 batch"]


def stress_times(cells: Sequence[Cell]) -> Float[Tensor, "n stresses"]:
    """Where stressed vowels begin (seconds); clips with fewer of them end in NaN."""
    times = [timing_of(cell).stress_times for cell in cells]
    padded = np.full((len(cells), max(map(len, times))), np.nan, np.float32)
    for row, stresses in zip(padded, times, strict=True):
        row[: len(stresses)] = stresses
    return torch.from_numpy(padded)


class FactorTable:
    """Clips that can be looked up by sentence, speaker, emotion and take.

    Args:
        cells: which clip each window shows.
        windows: standardised filterbanks, one per cell (kept in half precision).
    """

    def __init__(self, cells: Sequence[Cell], windows: Float[Tensor, "n frames mels"]):
        self.windows = windows
        self.factors = np.array(
            [
                (c.sentence, SPEAKERS.index(c.speaker), EMOTIONS.index(c.emotion), c.take)
                for c in cells
            ]
        )
        self.takes = np.unique(self.factors[:, 3])
        shape = (len(SENTENCES), len(SPEAKERS), len(EMOTIONS), int(self.takes.max()) + 1)
        self.index = np.full(shape, -1)
        self.index[tuple(self.factors.T)] = np.arange(len(cells))
        self.sentences = np.unique(self.factors[:, 0])
        self.speakers = np.unique(self.factors[:, 1])

    def clips(self, index: np.ndarray) -> Float[Tensor, "batch frames mels"]:
        """Windows in full precision."""
        return self.windows[torch.from_numpy(index)].float()

    def lookup(self, draw, count: int) -> np.ndarray:
        """`draw()` proposes `count` tuples of factors; keep proposing until all clips exist.

        A proposal is an array (count, 4); entry i is for batch item i, so that rejected items are
        drawn again without disturbing the others.

        Raises:
            ValueError: if 200 proposals leave a place open.
        """
        chosen = np.full(count, -1)
        for _ in range(200):
            open_places = chosen < 0
            if not open_places.any():
                return chosen
            proposal = draw()
            chosen[open_places] = self.index[tuple(proposal[open_places].T)]
        raise ValueError("the table of clips has too many holes for this kind of batch")

    def factor_batch(
        self, count: int, rng: np.random.Generator, *, same_emotion: float = 0.5
    ) -> FactorBatch:
        """Targets and donors for the full-factor swap.

        Args:
            count: batch size.
            rng: source of chance.
            same_emotion: share of content donors that speak in the target's emotion.
        """
        target = rng.integers(len(self.factors), size=count)
        c, s, e, t = self.factors[target].T

        def any_of(values):
            return rng.choice(values, count)

        emotions = np.arange(len(EMOTIONS))
        kept = rng.random(count) < same_emotion
        content = self.lookup(
            lambda: np.stack(
                [c, any_of(self.speakers), np.where(kept, e, any_of(emotions)), t], axis=1
            ),
            count,
        )
        style = self.lookup(
            lambda: np.stack(
                [any_of(self.sentences), s, any_of(emotions), any_of(self.takes)], axis=1
            ),
            count,
        )
        emotion = self.lookup(
            lambda: np.stack(
                [any_of(self.sentences), any_of(self.speakers), e, any_of(self.takes)], axis=1
            ),
            count,
        )
        donors = Donors(self.clips(content), self.clips(emotion), self.clips(style))
        return FactorBatch(
            self.clips(target), donors, torch.from_numpy(e.copy()), torch.from_numpy(s.copy())
        )

    def quadruple_indices(self, count: int, rng: np.random.Generator) -> np.ndarray:
        """(4, count) clips of two sentences x two speakers, in one emotion and one take."""
        found: list[np.ndarray] = []
        for _ in range(1000 * count):
            if len(found) == count:
                return np.stack(found, axis=1)
            c = rng.choice(self.sentences, 2, replace=False)
            s = rng.choice(self.speakers, 2, replace=False)
            e, t = rng.integers(len(EMOTIONS)), rng.choice(self.takes)
            four = self.index[[c[0], c[1], c[0], c[1]], [s[0], s[0], s[1], s[1]], e, t]
            if (four >= 0).all():
                found.append(four)
        raise ValueError(f"the table of clips does not hold {count} quadruples")

    def quadruple_batch(self, count: int, rng: np.random.Generator) -> QuadrupleBatch:
        """Quadruples for the paper's own losses."""
        four = self.quadruple_indices(count, rng)
        clips = self.clips(four.flatten()).unflatten(0, four.shape)
        styles = self.factors[four, 1]
        emotion = self.factors[four[0], 2]
        return QuadrupleBatch(clips, torch.from_numpy(emotion), torch.from_numpy(styles))
