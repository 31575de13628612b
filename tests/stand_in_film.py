"""A small film in which every frame differs from the others, for tests of films."""

import numpy as np


def moving_film(frames: int = 50, height: int = 48, width: int = 64) -> np.ndarray:
    """A bright disc that crosses a coloured slope from left to right, (t, h, w, 3) bytes."""
    y, x = np.mgrid[:height, :width]
    slope = np.stack([40 + x, 60 + y, np.full_like(x, 90)], axis=-1)
    centres = width * (np.arange(frames) + 0.5) / frames
    disc = np.hypot(x - centres[:, None, None], y - height / 2) < height / 5
    return np.where(disc[..., None], (235, 180, 60), slope).astype(np.uint8)
