"""Folders of films as readers bring them, for tests of what reads them."""

from pathlib import Path

import numpy as np
from PIL import Image


def write_pictures(folder: Path, pictures: np.ndarray) -> None:
    """Bytes (t, h, w, 3) or masks (t, h, w) as .png files."""
    folder.mkdir(parents=True)
    for number, picture in enumerate(pictures):
        Image.fromarray(picture).save(folder / f"{number}.png")


def write_film(film: Path, frames: np.ndarray, **given: np.ndarray) -> None:
    """A film as a sub-folder; masks become pictures, numbers a .npy file."""
    write_pictures(film / "frames", frames)
    for name, value in given.items():
        if value.dtype == bool:
            write_pictures(film / name, value)
        else:
            np.save(film / f"{name}.npy", value)
