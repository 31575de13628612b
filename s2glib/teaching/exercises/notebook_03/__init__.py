"""The exercises of notebook 03."""

from s2glib.teaching.exercises.notebook_03.bending import EQUIVARIANCE
from s2glib.teaching.exercises.notebook_03.hiding import HIDE
from s2glib.teaching.exercises.notebook_03.mixing import MIX
from s2glib.teaching.exercises.notebook_03.weighing import WEIGH

__all__ = ["EXERCISES"]

EXERCISES = (WEIGH, MIX, HIDE, EQUIVARIANCE)
