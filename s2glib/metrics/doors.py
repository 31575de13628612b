"""What every metric demands of its arrays, and the sentence it answers with otherwise.

Paper:    -
Notebook: notebooks/17_motion_distances.ipynb
"""

import numpy as np


def require(name: str, values: np.ndarray, axes: str, *, at_least: int = 1) -> np.ndarray:
    """Return `values` as float64, or refuse them in one sentence.

    Args:
        name: what the caller calls the array.
        values: the array.
        axes: its axes in words and numbers, e.g. `"frames joints 3"`; a leading `"*batch"` stands
            for any number of axes.
        at_least: the shortest first axis (after the batch axes) a metric can use.

    Raises:
        TypeError: if it is no numeric numpy array.
        ValueError: if it has other axes, is too short or empty, or holds NaN or Inf.
    """
    if not isinstance(values, np.ndarray) or values.dtype.kind not in "fiu":
        kind = values.dtype if isinstance(values, np.ndarray) else type(values).__name__
        raise TypeError(
            f"{name} must be a numpy array of numbers with axes ({axes}), got {kind}; "
            "convert it with numpy.asarray or .numpy()"
        )
    own = [axis for axis in axes.split() if not axis.startswith("*")]
    shape = values.shape[-len(own) :] if axes.startswith("*") else values.shape
    if not _fits(shape, own):
        raise ValueError(f"{name} must have axes ({axes}), got shape {values.shape}; reshape it")
    if shape[0] < at_least:
        raise ValueError(f"{name} needs at least {at_least} {own[0]}, got {shape[0]}; give more")
    if at_least > 0 and values.size == 0:
        raise ValueError(f"{name} is empty (shape {values.shape}); give at least one of each axis")
    if not np.isfinite(values).all():
        raise ValueError(f"{name} holds NaN or infinite values; repair or drop them first")
    return values.astype(np.float64)


def require_pair(
    predicted: np.ndarray, target: np.ndarray, axes: str, *, at_least: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Both arrays as float64, or a refusal if either is unusable or their shapes differ."""
    predicted = require("predicted", predicted, axes, at_least=at_least)
    target = require("target", target, axes, at_least=at_least)
    if predicted.shape != target.shape:
        raise ValueError(
            f"predicted {predicted.shape} and target {target.shape} must have the same shape; "
            "cut both to the same frames and joints"
        )
    return predicted, target


def require_positive(name: str, value: float | int) -> None:
    """Refuse a number that is not finite and above zero."""
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f"{name} must be a positive number, got {value}; give one above 0")


def _fits(shape: tuple[int, ...], axes: list[str]) -> bool:
    return len(shape) == len(axes) and all(
        int(axis) == size for axis, size in zip(axes, shape, strict=True) if axis.isdigit()
    )
