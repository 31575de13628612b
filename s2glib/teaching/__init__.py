"""What notebooks call: preparation, rounded numbers, captioned figures, shown source."""

from s2glib.teaching.checkup import check_environment
from s2glib.teaching.preparation import PALETTE, setup
from s2glib.teaching.showing import figure, report
from s2glib.teaching.source import show_source

__all__ = ["PALETTE", "check_environment", "figure", "report", "setup", "show_source"]
