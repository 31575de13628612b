"""The exercises of notebook 04."""

from s2glib.teaching.exercises.notebook_04.looking_closely import CLOSELY
from s2glib.teaching.exercises.notebook_04.smoothness import SMOOTHNESS
from s2glib.teaching.exercises.notebook_04.texture import TEXTURE

__all__ = ["EXERCISES"]

EXERCISES = (CLOSELY, TEXTURE, SMOOTHNESS)
