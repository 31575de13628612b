"""Errors against the one true motion: positions, joints, velocities.

Paper:    PT B Tab. 7 (MAE), Tab. 8 (MSE, LVD)
Notebook: notebooks/17_motion_distances.ipynb
"""

from typing import Literal

import numpy as np
from jaxtyping import Float

from s2glib.metrics.doors import require_pair


def mean_absolute_error(
    predicted: Float[np.ndarray, "*batch frames channels"],
    target: Float[np.ndarray, "*batch frames channels"],
) -> float:
    """Mean of |predicted - target| over every element (MAE of the Trimodal line of work).

    That line drops the first four frames, which are its seed poses: cut them yourself.

    Raises:
        TypeError, ValueError: for unequal shapes, empty arrays or NaN.
    """
    predicted, target = require_pair(predicted, target, "*batch frames channels")
    return float(np.abs(predicted - target).mean())


def mean_squared_error(
    predicted: Float[np.ndarray, "*batch frames channels"],
    target: Float[np.ndarray, "*batch frames channels"],
) -> float:
    """Mean of (predicted - target)^2 over every element (MSE of EMAGE, of face vertices).

    Raises:
        TypeError, ValueError: for unequal shapes, empty arrays or NaN.
    """
    predicted, target = require_pair(predicted, target, "*batch frames channels")
    return float(np.square(predicted - target).mean())


def mean_joint_error(
    predicted: Float[np.ndarray, "*batch frames joints 3"],
    target: Float[np.ndarray, "*batch frames joints 3"],
) -> float:
    """Distance of each joint to its target, SUMMED over joints, mean over frames (MAJE of PT).

    The sum grows with the skeleton (22, 73 or 127 joints in use); divide by the number of joints to
    compare skeletons.

    Raises:
        TypeError, ValueError: for unequal shapes, empty arrays or NaN.
    """
    predicted, target = require_pair(predicted, target, "*batch frames joints 3")
    return float(np.linalg.norm(predicted - target, axis=-1).sum(axis=-1).mean())


def landmark_velocity_difference(
    predicted: Float[np.ndarray, "*batch frames joints 3"],
    target: Float[np.ndarray, "*batch frames joints 3"],
    *,
    variant: Literal["probtalk", "emage", "emage-printed"] = "probtalk",
) -> float:
    """How differently two motions move, in units per frame (LVD).

    - `"probtalk"`: difference of SPEEDS, summed over joints, mean over steps: blind to direction.
    - `"emage"`: difference of velocities, mean over steps, joints and coordinates. (Its evaluation
      tools divide T - 1 steps by T; we do not.)
    - `"emage-printed"`: what stands behind PT Tab. 8. The trainer subtracts the TARGET's previous
      frame from both, which leaves |predicted - target| after frame 0: no velocity at all.

    Raises:
        TypeError, ValueError: for unequal shapes, fewer than 2 frames, NaN, unknown variants.
    """
    predicted, target = require_pair(predicted, target, "*batch frames joints 3", at_least=2)
    if variant == "emage-printed":
        return float(np.abs(predicted - target)[..., 1:, :, :].mean())
    velocity, target_velocity = np.diff(predicted, axis=-3), np.diff(target, axis=-3)
    if variant == "emage":
        return float(np.abs(velocity - target_velocity).mean())
    if variant == "probtalk":
        speed = np.linalg.norm(velocity, axis=-1)  # (*batch, frames - 1, joints)
        target_speed = np.linalg.norm(target_velocity, axis=-1)
        return float(np.abs(speed - target_speed).sum(axis=-1).mean())
    raise ValueError(f"no variant {variant!r}; choose 'probtalk', 'emage' or 'emage-printed'")
