"""Video networks with every part of the large ones, and films of noise to feed them."""

from dataclasses import replace

import numpy as np

from s2glib.papers.mddiffusion import TEACHING_DECOUPLING, TEACHING_REFINEMENT
from s2glib.recipes.video_data import Film

SMALL_DECOUPLING = replace(
    TEACHING_DECOUPLING,
    size=32,
    transforms=3,
    keypoint_widths=(4, 4, 6, 8),
    keypoint_grid=2,
    flow_size=16,
    flow_width=4,
    flow_widest=8,
    flow_blocks=2,
    synthesis_width=4,
    synthesis_blocks=2,
)
SMALL_REFINEMENT = replace(TEACHING_REFINEMENT, widths=(4, 6, 8), patch_widths=(4, 6, 8))


def noise_film(rng: np.random.Generator, size: int = 32) -> Film:
    """Twelve frames of anything, with hands and faces anywhere."""
    parts = rng.integers(20, size=(12, size, size)).astype(np.uint8)
    frames = rng.integers(256, size=(12, size, size, 3)).astype(np.uint8)
    return Film(frames, parts, rng.normal(size=(12, 55, 2)).astype(np.float16))
