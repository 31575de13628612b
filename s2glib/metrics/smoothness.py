"""Smoothness: how much a motion shakes, by its second and third time derivative.

Paper:    AM D (jerk)
Notebook: notebooks/17_motion_distances.ipynb
"""

import numpy as np
from jaxtyping import Float

from s2glib.metrics.doors import require, require_positive


def derivative_sizes(
    positions: Float[np.ndarray, "frames joints dims"], fps: float | int, *, order: int
) -> Float[np.ndarray, "steps joints"]:
    """Length of the `order`-th time derivative of each joint: 1 speed, 2 acceleration, 3 jerk.

    Args:
        positions: metres.
        fps: frames per second.
        order: how often to differentiate; frame k of the result spans frames k to k + order.

    Returns:
        (frames - order, joints), in metres per second^order.

    Raises:
        TypeError, ValueError: for other shapes, NaN, or fewer than `order + 1` frames.
    """
    if order < 1:
        raise ValueError(f"order must be at least 1, got {order}; 1 is the speed")
    positions = require("positions", positions, "frames joints dims", at_least=order + 1)
    require_positive("fps", fps)
    return np.linalg.norm(np.diff(positions, n=order, axis=0), axis=-1) * fps**order


def acceleration(positions: Float[np.ndarray, "frames joints dims"], fps: float | int) -> float:
    """Mean length of the acceleration over frames and joints, m/s^2; needs 3 frames."""
    return float(derivative_sizes(positions, fps, order=2).mean())


def jerk(positions: Float[np.ndarray, "frames joints dims"], fps: float | int) -> float:
    """Mean length of the jerk over frames and joints, m/s^3 (third differences); needs 4 frames.

    A hand that swings 10 cm to either side once a second already has about 16 m/s^3, so that
    AM's figures near 1 must be scaled otherwise: compare ratios to real motion only.
    """
    return float(derivative_sizes(positions, fps, order=3).mean())
