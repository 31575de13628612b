"""Pictures of more people than were filmed: mirrored, and in other colours.

Paper:    - (MDD: authors' code only)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import math
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float
from torch import Tensor

MIRRORED = 0.5  # share of the pairs; authors' code
JITTER = 0.1  # of a turn of the colour circle, and of brightness; authors' code


class Augmentation(NamedTuple):
    """One change for each pair, to be made to every picture of it.

    Attributes:
        mirrored: whether left becomes right.
        colors: what red, green and blue become; rows are the new colours.
    """

    mirrored: Bool[Tensor, " batch"]
    colors: Float[Tensor, "batch 3 3"]

    @classmethod
    def draw(cls, count: int, rng: np.random.Generator) -> "Augmentation":
        """Mirror half of the pairs; turn the hue and change the brightness of all, a little."""
        turns = 2 * math.pi * rng.uniform(-JITTER, JITTER, count)
        brightness = rng.uniform(1 - JITTER, 1 + JITTER, (count, 1, 1))
        colors = torch.from_numpy(brightness * hue_rotation(turns)).float()
        return cls(torch.from_numpy(rng.random(count) < MIRRORED), colors)

    def mirror(self, maps: Float[Tensor, "batch c h w"]) -> Float[Tensor, "batch c h w"]:
        """Flip the chosen ones."""
        return torch.where(self.mirrored[:, None, None, None], maps.flip(-1), maps)

    def change(self, images: Float[Tensor, "batch 3 h w"]) -> Float[Tensor, "batch 3 h w"]:
        """Flip the chosen ones and colour them all; the result stays in 0 .. 1."""
        colored = torch.einsum("bnc, bchw -> bnhw", self.colors, images)
        return self.mirror(colored.clamp(0, 1))


def hue_rotation(angles: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 3 3"]:
    """Turn colours about the axis of the greys, which stay; radians."""
    grey = np.full(3, 3**-0.5)
    along = np.outer(grey, grey)
    across = np.cross(grey, np.eye(3)).T
    cosine, sine = np.cos(angles)[:, None, None], np.sin(angles)[:, None, None]
    return cosine * np.eye(3) + sine * across + (1 - cosine) * along
