"""How far generated clips lie from real ones as a crowd, in units of real from real.

Paper:    AM E (FGD)
Notebook: notebooks/17_motion_distances.ipynb
"""

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.metrics import frechet_distance
from s2glib.recipes.motion_seen import Seen
from s2glib.recipes.report import Row, over_draws

SET, DRAWS, COMPONENTS = 512, 5, 32
_SEED = 11


def frechet_rows(real: Seen, made: Seen, others: Seen) -> list[Row]:
    """Distance of generated to real clips, over that of other real clips to the same ones."""
    components = principal_components(others.motion.flatten(1), COMPONENTS)
    measured = {
        "M": [seen.code for seen in (real, made, others)],
        "principal components": [
            (seen.motion.flatten(1) @ components).numpy() for seen in (real, made, others)
        ],
    }
    count = min(SET, len(real.motion), len(others.motion))
    return [
        over_draws(f"FGD ratio, {name}", distances(*sets, count=count).ratios, count)
        for name, sets in measured.items()
    ]


class Distances(NamedTuple):
    """Frechet distances to the same real clips, draw after draw.

    Attributes:
        made: of generated clips.
        others: of other real clips.
    """

    made: Float[np.ndarray, " draws"]
    others: Float[np.ndarray, " draws"]

    @property
    def ratios(self) -> Float[np.ndarray, " draws"]:
        """1 where generated clips are as near as real ones."""
        return self.made / self.others


def distances(
    real: Float[np.ndarray, "n d"],
    made: Float[np.ndarray, "n d"],
    others: Float[np.ndarray, "m d"],
    *,
    count: int,
) -> Distances:
    """Several draws of `count` clips and `count` others."""
    rng = np.random.default_rng(_SEED)
    pairs = []
    for _ in range(DRAWS):
        chosen = rng.choice(len(real), count, replace=False)
        compared = others[rng.choice(len(others), count, replace=False)]
        pairs.append([frechet_distance(x, real[chosen]) for x in (made[chosen], compared)])
    return Distances(*np.array(pairs).T)


def principal_components(clips: Float[Tensor, "n d"], count: int) -> Float[Tensor, "d count"]:
    """Directions in which whole clips vary most, from the small matrix of their products."""
    centred = clips - clips.mean(0)
    _, weights = torch.linalg.eigh((centred @ centred.T).double())
    directions = centred.T @ weights.flip(1)[:, :count].to(clips)
    return directions / directions.norm(dim=0)
