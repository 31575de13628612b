"""The exercises of notebook 07."""

from s2glib.teaching.exercises.notebook_07.comparing import COMPARE
from s2glib.teaching.exercises.notebook_07.filling import FILL

__all__ = ["EXERCISES"]

EXERCISES = (FILL, COMPARE)
