"""The scripts and styles of widgets, which stand beside their Python.

Paper:    -
Notebook: notebooks/02_thin_plate_splines.ipynb
"""

from pathlib import Path


def read_parts(*names: str) -> str:
    """The text of some of this room's files, one below the other."""
    return "\n".join((Path(__file__).parent / name).read_text("utf-8") for name in names)
