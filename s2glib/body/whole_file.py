"""Files that appear whole or not at all: written aside, then renamed.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import os
import tempfile
from pathlib import Path


def write_whole(path: str | os.PathLike[str], content: bytes) -> None:
    """Put a file in place in one step; a missing folder is made, an older file is replaced."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}-") as folder:
        aside = Path(folder, path.name)
        aside.write_bytes(content)
        aside.replace(path)
