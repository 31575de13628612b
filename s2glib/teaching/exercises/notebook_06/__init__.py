"""The exercises of notebook 06."""

from s2glib.teaching.exercises.notebook_06.gating import GATE
from s2glib.teaching.exercises.notebook_06.restyling import RESTYLE
from s2glib.teaching.exercises.notebook_06.scheduling import SCHEDULE

__all__ = ["EXERCISES"]

EXERCISES = (GATE, RESTYLE, SCHEDULE)
