"""How strongly a clip shows its emotion: one number that drives both voice and body.

Paper:    AM E (expressiveness differs between subjects and takes), design: ours
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np

from s2glib.corpus.clock import SEED
from s2glib.corpus.script import EMOTIONS, SPEAKERS, Cell, speech_take

MEAN, SPREAD = 0.52, 0.25  # the dial that sets how recognisable the corpus' gestures are
STRONGEST = 1.15
_STREAM = 3


def intensity(cell: Cell) -> float:
    """0 is the neutral manner, 1 the emotion's full table entry; shared by voice and body."""
    factors = [cell.sentence, SPEAKERS.index(cell.speaker), EMOTIONS.index(cell.emotion)]
    rng = np.random.default_rng([SEED, _STREAM, *factors, speech_take(cell.take)])
    return float(np.clip(rng.normal(MEAN, SPREAD), 0, STRONGEST))
