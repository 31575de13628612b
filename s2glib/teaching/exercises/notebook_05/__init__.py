"""The exercises of notebook 05."""

from s2glib.teaching.exercises.notebook_05.following import FOLLOW
from s2glib.teaching.exercises.notebook_05.passing import PASS
from s2glib.teaching.exercises.notebook_05.searching import SEARCH
from s2glib.teaching.exercises.notebook_05.using import USE

__all__ = ["EXERCISES"]

EXERCISES = (SEARCH, PASS, FOLLOW, USE)
