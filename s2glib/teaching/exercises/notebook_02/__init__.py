"""The exercises of notebook 02."""

from s2glib.teaching.exercises.notebook_02.applying import APPLY
from s2glib.teaching.exercises.notebook_02.basis import BASIS
from s2glib.teaching.exercises.notebook_02.system import SYSTEM

__all__ = ["EXERCISES"]

EXERCISES = (BASIS, SYSTEM, APPLY)
