"""The exercises of the notebooks, one module a notebook, found by their ids."""

from s2glib.teaching.exercises.exercise import Exercise, Mutant, all_exercises, find_exercise

__all__ = ["Exercise", "Mutant", "all_exercises", "find_exercise"]
