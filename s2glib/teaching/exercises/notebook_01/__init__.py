"""The exercises of notebook 01."""

from s2glib.teaching.exercises.notebook_01.bones import WALK
from s2glib.teaching.exercises.notebook_01.rates import RATE
from s2glib.teaching.exercises.notebook_01.turns import SIXD

__all__ = ["EXERCISES"]

EXERCISES = (SIXD, WALK, RATE)
