"""Diversity: how different the clips of one model are, by each definition in use.

Paper:    PT Tab. 8, AM E, MDD C
Notebook: notebooks/17_motion_distances.ipynb
"""

from typing import Literal

import numpy as np
from jaxtyping import Float

from s2glib.metrics.doors import require


def diversity(
    features: Float[np.ndarray, "n d"],
    *,
    p: float | int = 2,
    pairs: Literal["all", "permutation"] | int = "all",
    rng: np.random.Generator | None = None,
) -> float:
    """Mean distance between pairs of feature vectors.

    The published definitions differ in norm and in pairs:

    - `p=2, pairs="all"`: Euclidean, every pair once (AIST++; MDD C as worded).
    - `p=1, pairs="permutation"`: sum of absolute differences to a random permutation, in which a
      vector may meet itself (HA2G, whose code MDD C cites).
    - `p=2, pairs=k`: Euclidean, k against k rows, each drawn without repetition (MDM and MLD, on
      which AM's code stands).

    Args:
        features: one row per clip.
        p: order of the norm.
        pairs: which pairs are compared.
        rng: draws the pairs; needed unless `pairs="all"`.

    Raises:
        TypeError, ValueError: for fewer than two rows, non-finite values, an unknown `pairs`, more
            pairs than rows, or random pairs without `rng`.
    """
    features = require("features", features, "samples d", at_least=2)
    if not p >= 1:
        raise ValueError(f"p must be at least 1, got {p}; 1 and 2 are the norms in use")
    if pairs == "all":
        from scipy.spatial.distance import pdist

        return float(pdist(features, "minkowski", p=p).mean())
    first, second = _random_pairs(len(features), pairs, rng)
    return float(np.linalg.norm(features[first] - features[second], ord=p, axis=1).mean())


def sample_variance(positions: Float[np.ndarray, "samples frames joints 3"]) -> float:
    """How much several motions for the same speech differ (diversity of PT's released code).

    Unbiased variance over the samples, its length over x, y, z, summed over joints, mean over
    frames. PT then divides by constants of its own body model (0.98894 body, 0.00070698 face).

    Raises:
        TypeError, ValueError: for other shapes, NaN, or a single sample (it has no variance).
    """
    positions = require("positions", positions, "samples frames joints 3", at_least=2)
    variance = positions.var(axis=0, ddof=1)  # (frames, joints, 3)
    return float(np.linalg.norm(variance, axis=-1).sum(axis=-1).mean())


def l1_variation(motion: Float[np.ndarray, "frames joints dims"]) -> float:
    """How far one clip strays from its own mean pose ("diversity" of BEAT, EMAGE and PT Tab. 8).

    Absolute difference to the mean over time, summed over joints and coordinates, mean over frames.
    It sees one clip at a time: a model that always makes the same large gesture scores high.

    Raises:
        TypeError, ValueError: for other shapes, NaN or no frames.
    """
    motion = require("motion", motion, "frames joints dims")
    return float(np.abs(motion - motion.mean(axis=0)).sum() / len(motion))


def _random_pairs(
    n: int, pairs: Literal["permutation"] | int, rng: np.random.Generator | None
) -> tuple[np.ndarray, np.ndarray]:
    if rng is None:
        raise ValueError("random pairs need rng; pass numpy.random.default_rng(seed)")
    if pairs == "permutation":
        return np.arange(n), rng.permutation(n)
    if isinstance(pairs, str) or not 0 < pairs <= n:
        raise ValueError(f"pairs must be 'all', 'permutation' or 1 to {n} (rows), got {pairs!r}")
    return rng.choice(n, pairs, replace=False), rng.choice(n, pairs, replace=False)
