"""What notebooks call: preparation, numbers, figures, source, questions, and exercises."""

from s2glib.teaching.asking import ask
from s2glib.teaching.checking import check, hint, show_solution
from s2glib.teaching.checkup import check_environment
from s2glib.teaching.overview import progress
from s2glib.teaching.preparation import PALETTE, setup
from s2glib.teaching.showing import figure, report
from s2glib.teaching.source import show_source

__all__ = [
    "PALETTE",
    "ask",
    "check",
    "check_environment",
    "figure",
    "hint",
    "progress",
    "report",
    "setup",
    "show_solution",
    "show_source",
]
