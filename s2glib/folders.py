"""Where things lie: shipped data, the cache of regenerated data, and a student's progress.

Paper:    -
Notebook: notebooks/00_start_here.ipynb
"""

import os
from pathlib import Path


def data_folder() -> Path:
    """The shipped data: S2G_DATA, or `data_samples` beside the package."""
    default = Path(__file__).resolve().parents[1] / "data_samples"
    return Path(os.environ.get("S2G_DATA", default))


def runs_folder() -> Path:
    """Records of training runs, beside the package."""
    return Path(__file__).resolve().parents[1] / "runs"


def cache_folder() -> Path:
    """What can be rebuilt at any time: S2G_CACHE, or `s2glib` in the user's cache folder."""
    default = Path.home() / ".cache" / "s2glib"
    return Path(os.environ.get("S2G_CACHE", default))


def home_folder() -> Path:
    """A student's own progress: S2G_HOME, or `.s2glib` in the home folder."""
    return Path(os.environ.get("S2G_HOME", Path.home() / ".s2glib"))
