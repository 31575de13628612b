"""Frechet distance: how far apart two clouds of features are, seen as two Gaussians.

Paper:    PT B Tab. 7 (FGD), AM E, MDD C
Notebook: notebooks/17_motion_distances.ipynb
"""

import numpy as np
from jaxtyping import Float

from s2glib.metrics.doors import require


def frechet_distance(
    features_a: Float[np.ndarray, "n d"], features_b: Float[np.ndarray, "m d"]
) -> float:
    """Squared Frechet distance between Gaussians fitted to two sets of features (FGD, FID, FVD).

    The value belongs to the network that made the features: numbers of different papers cannot be
    compared. Few samples push it up (two draws of 100 from one 32-d Gaussian are about 6 apart), so
    compare only values taken with equal n and m, and print real against real beside them.

    Args:
        features_a: one row per clip; fewer rows than columns are allowed.
        features_b: the same number of columns.

    Returns:
        A number >= 0 in squared units of the features, computed in float64.

    Raises:
        TypeError, ValueError: for anything but two finite matrices of equal width, with at least
            two rows each (one sample has no covariance).
    """
    features_a = require("features_a", features_a, "samples d", at_least=2)
    features_b = require("features_b", features_b, "samples d", at_least=2)
    return frechet_from_statistics(*_statistics(features_a), *_statistics(features_b))


def frechet_from_statistics(
    mean_a: Float[np.ndarray, " d"],
    cov_a: Float[np.ndarray, "d d"],
    mean_b: Float[np.ndarray, " d"],
    cov_b: Float[np.ndarray, "d d"],
) -> float:
    """Squared Frechet distance between two Gaussians of given mean m and covariance C.

    |m_a - m_b|^2 + tr(C_a + C_b - 2 (C_a C_b)^½), not rooted. With C_a = R R^T, the product C_a C_b
    has the eigenvalues of R^T C_b R, which is symmetric and never negative: the trace of its root
    needs no complex numbers and no `sqrtm`, even when C_a is singular.

    Raises:
        TypeError, ValueError: if widths differ or a covariance is not symmetric positive
            semi-definite.
    """
    mean_a, cov_a = _gaussian("a", mean_a, cov_a)
    mean_b, cov_b = _gaussian("b", mean_b, cov_b)
    if len(mean_a) != len(mean_b):
        raise ValueError(
            f"the two sets have {len(mean_a)} and {len(mean_b)} features per sample; "
            "both must come from the same feature network"
        )
    R = _root(cov_a)  # (d, rank)
    eigenvalues = np.linalg.eigvalsh(R.T @ cov_b @ R)
    trace_of_root = np.sqrt(eigenvalues.clip(0)).sum()
    distance = np.square(mean_a - mean_b).sum() + np.trace(cov_a + cov_b) - 2 * trace_of_root
    return max(float(distance), 0.0)


def _statistics(features: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    mean = features.mean(axis=0)
    centred = features - mean
    return mean, centred.T @ centred / (len(features) - 1)  # unbiased, as in every release


def _gaussian(name: str, mean: np.ndarray, cov: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    mean = require(f"mean_{name}", mean, "d")
    cov = require(f"cov_{name}", cov, f"{len(mean)} {len(mean)}")
    if not np.allclose(cov, cov.T, rtol=1e-6, atol=1e-8 * np.abs(cov).max()):
        raise ValueError(f"cov_{name} is not symmetric; pass numpy.cov(features, rowvar=False)")
    return mean, cov


def _root(cov: np.ndarray) -> np.ndarray:
    """(d, rank) matrix R with R R^T = cov: Cholesky with pivoting, which stops at the rank."""
    from scipy.linalg.lapack import dpstrf

    lower, pivots, rank, _ = dpstrf(cov, lower=1)
    R = np.empty((len(cov), rank))
    R[pivots - 1] = np.tril(lower)[:, :rank]
    if rank < len(cov) and np.abs(R @ R.T - cov).max() > 1e-6 * np.abs(cov).max():
        raise ValueError("a covariance has negative eigenvalues; pass one estimated from features")
    return R
