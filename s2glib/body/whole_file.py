"""Files that appear whole or not at all: written aside, then renamed.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Lend a file to write into; when all went well it takes its place in one step.

    A missing folder is made, an older file is replaced. What is written piece by piece need not
    stand in memory as a whole.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}-") as folder:
        aside = Path(folder, path.name)
        with aside.open("wb") as file:
            yield file
        aside.replace(path)
