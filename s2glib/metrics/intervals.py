"""Intervals: how far a figure could have come out otherwise with other test clips.

Paper:    -
Notebook: notebooks/17_motion_distances.ipynb
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Shaped


class Interval(NamedTuple):
    """A figure with the range that resampling the clips gives it."""

    value: float
    low: float
    high: float


def bootstrap_interval(
    *values: Shaped[np.ndarray, "clips ..."],
    rng: np.random.Generator,
    statistic: Callable[..., float] = np.mean,
    level: float = 0.95,
    resamples: int = 1000,
) -> Interval:
    """Percentile bootstrap over clips: draw as many clips with replacement, take the figure again.

    Several arrays are resampled together, clip by clip, for figures of pairs:
    `bootstrap_interval(ours, real, statistic=lambda a, b: a.mean() / b.mean(), rng=rng)`.

    Args:
        *values: one entry (of any shape) per clip, clips along the first axis.
        rng: draws the clips.
        statistic: takes the arrays, gives a number.
        level: probability that the interval should cover.
        resamples: how many draws.

    Raises:
        TypeError, ValueError: for fewer than two clips, arrays of unequal length, a level outside
            (0, 1), or a statistic that is not finite (a clip without value: drop it, or count it).
    """
    _check(values, level, resamples)
    clips = len(values[0])
    value = float(statistic(*values))
    draws = np.empty(resamples)
    for draw in range(resamples):
        chosen = rng.integers(clips, size=clips)
        draws[draw] = statistic(*(array[chosen] for array in values))
    if not (np.isfinite(value) and np.isfinite(draws).all()):
        raise ValueError(
            f"the statistic is {value} here and not finite in {np.sum(~np.isfinite(draws))} of "
            f"{resamples} resamples; drop or fill the clips that have no value"
        )
    low, high = np.quantile(draws, [(1 - level) / 2, (1 + level) / 2])
    return Interval(value, float(low), float(high))


def _check(values: tuple[np.ndarray, ...], level: float, resamples: int) -> None:
    if not values or not all(isinstance(array, np.ndarray) and array.ndim for array in values):
        raise TypeError("bootstrap_interval needs numpy arrays with one entry per clip")
    lengths = {len(array) for array in values}
    if len(lengths) != 1 or min(lengths) < 2:
        raise ValueError(f"every array needs the same 2 or more clips, got {sorted(lengths)}")
    if not 0 < level < 1 or resamples < 1:
        raise ValueError(
            f"level must lie between 0 and 1 and resamples be positive, got {level}, {resamples}"
        )
