"""How far generated clips lie from real ones as a crowd, in units of real from real.

Paper:    AM E (FGD)
Notebook: notebooks/17_motion_distances.ipynb
"""

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
        over_draws(f"FGD ratio, {name}", frechet_ratios(*sets, count=count), count)
        for name, sets in measured.items()
    ]


def frechet_ratios(
    real: Float[np.ndarray, "n d"],
    made: Float[np.ndarray, "n d"],
    others: Float[np.ndarray, "m d"],
    *,
    count: int,
) -> Float[np.ndarray, " draws"]:
    """The ratio for several draws of `count` clips and `count` others."""
    rng = np.random.default_rng(_SEED)
    ratios = []
    for _ in range(DRAWS):
        chosen = rng.choice(len(real), count, replace=False)
        compared = others[rng.choice(len(others), count, replace=False)]
        scale = frechet_distance(compared, real[chosen])
        ratios.append(frechet_distance(made[chosen], real[chosen]) / scale)
    return np.array(ratios)


def principal_components(clips: Float[Tensor, "n d"], count: int) -> Float[Tensor, "d count"]:
    """Directions in which whole clips vary most, from the small matrix of their products."""
    centred = clips - clips.mean(0)
    _, weights = torch.linalg.eigh((centred @ centred.T).double())
    directions = centred.T @ weights.flip(1)[:, :count].to(clips)
    return directions / directions.norm(dim=0)
