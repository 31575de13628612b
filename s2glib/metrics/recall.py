"""Recall: which share of the joints arrives near its target, and whether it matters there.

Paper:    AM E (SRGR)
Notebook: notebooks/17_motion_distances.ipynb
"""

from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

from s2glib.metrics.doors import require, require_pair, require_positive


def pck(
    predicted: Float[np.ndarray, "frames joints dims"],
    target: Float[np.ndarray, "frames joints dims"],
    *,
    threshold: float | int = 0.1,
    scale: Float[np.ndarray, " frames"] | None = None,
    visible: Bool[np.ndarray, "frames joints"] | None = None,
) -> float:
    """Probability of a correct keypoint: share of joints closer to the target than `threshold`.

    Strictly closer, per joint over the frames in which it is visible, then mean over joints.

    Args:
        predicted: keypoints or joints.
        target: the same points in truth.
        threshold: in units of the motion, or of `scale` where given.
        scale: length by which the distances of a frame are divided, e.g. the longer side of the
            target's bounding box with `threshold=0.2`.
        visible: true where a target exists; joints that are never visible are left out.

    Raises:
        TypeError, ValueError: for unequal shapes, NaN, a scale or threshold that is not positive,
            or if no joint is ever visible.
    """
    predicted, target = require_pair(predicted, target, "frames joints dims")
    hits = _hits(predicted, target, threshold, "l2", scale)
    seen = np.ones(hits.shape, bool) if visible is None else visible
    if seen.shape != hits.shape or not seen.any():
        raise ValueError(
            f"visible must be a (frames, joints) mask {hits.shape} with at least one true entry, "
            f"got shape {seen.shape} with {seen.sum()}"
        )
    counted = seen.any(axis=0)
    return float(((hits & seen).sum(axis=0)[counted] / seen.sum(axis=0)[counted]).mean())


def semantic_relevant_gesture_recall(
    predicted: Float[np.ndarray, "frames joints dims"],
    target: Float[np.ndarray, "frames joints dims"],
    semantic: Float[np.ndarray, " frames"],
    *,
    threshold: float | int = 0.1,
    norm: Literal["l1", "l2"] = "l2",
    mean_score: float | int = 1.0,
) -> float:
    """Share of recalled joints, each frame weighted by its semantic score (SRGR)  [AM E].

    Perfect motion scores mean(semantic) / mean_score, not 1. The releases differ: BEAT 2022 has
    `norm="l1"` and calls it with threshold 4 on Euler angles in degrees, the later tools have "l2"
    and 0.1; both divide by `mean_score=0.165`, BEAT's average, which AM's formula does not have.

    Args:
        predicted: joints, in the unit of `threshold`.
        target: the same joints in truth.
        semantic: score of each frame, 0 to 1.
        threshold: delta; a joint is recalled strictly below it.
        norm: how the error of a joint is measured.
        mean_score: what the weights are divided by.

    Raises:
        TypeError, ValueError: for unequal shapes, NaN, negative scores, settings out of range.
    """
    predicted, target = require_pair(predicted, target, "frames joints dims")
    semantic = require("semantic", semantic, f"{len(target)}")
    require_positive("mean_score", mean_score)
    if (semantic < 0).any():
        raise ValueError("semantic scores must not be negative; rescale them to 0 to 1")
    recalled = _hits(predicted, target, threshold, norm)  # (frames, joints)
    return float((semantic[:, None] / mean_score * recalled).mean())


def _hits(
    predicted: np.ndarray,
    target: np.ndarray,
    threshold: float | int,
    norm: Literal["l1", "l2"],
    scale: np.ndarray | None = None,
) -> np.ndarray:
    """(frames, joints) truth values: 1[ |p - p_hat| < delta ]."""
    require_positive("threshold", threshold)
    if norm not in ("l1", "l2"):
        raise ValueError(f"norm must be 'l1' or 'l2', got {norm!r}")
    distance = np.linalg.norm(predicted - target, ord=int(norm[1]), axis=-1)
    if scale is None:
        return distance < threshold
    scale = require("scale", scale, f"{len(target)}")
    if (scale <= 0).any():
        raise ValueError("scale must be positive in every frame; leave out frames without a body")
    return distance < threshold * scale[:, None]
