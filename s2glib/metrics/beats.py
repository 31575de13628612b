"""Beats: the moments at which a body stops, and how well they meet the beats of speech.

Paper:    PT B Tab. 7 (BC), AM E (BA), MDD H (BAS)
Notebook: notebooks/18_beats.ipynb
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from s2glib.metrics.doors import require, require_positive


class ShuffledAlignment(NamedTuple):
    """Beat alignment of each clip, and of the same clip against the beats of other clips."""

    scores: Float[np.ndarray, " clips"]
    shuffled: Float[np.ndarray, " clips"]

    @property
    def margins(self) -> Float[np.ndarray, " clips"]:
        """What is left of the score once chance is taken away."""
        return self.scores - self.shuffled


def kinematic_beats(
    motion: Float[np.ndarray, "frames joints dims"],
    fps: float | int,
    *,
    joints: Sequence[int],
    order: int,
    smooth: float | int = 0,
    threshold: float | int = 0,
) -> Float[np.ndarray, " beats"]:
    """Times at which the summed speed of some joints has a strict local minimum.

    The step from frame k to frame k + 1 is dated to its middle, (k + ½) / fps. (Releases date it to
    either end: see `BEAT_PRESETS`.) Flat minima and the two ends of a clip are no beats.

    Args:
        motion: positions in metres, or any quantity whose change is a speed.
        fps: frames per second.
        joints: which joints count.
        order: a minimum is below its `order` neighbours on either side, in frames: another frame
            rate makes another metric.
        smooth: standard deviation in frames of a Gaussian over the speed; 0 leaves it as it is,
            and trembling then makes beats of its own.
        threshold: the higher of the two neighbouring speeds lies at least this much above the
            minimum, in units of `motion` per second.

    Returns:
        Seconds, ascending; empty if the body never slows down.

    Raises:
        TypeError, ValueError: for other shapes, NaN, fewer than 2 frames, joints that do not exist
            or settings out of range.
    """
    motion = require("motion", motion, "frames joints dims", at_least=2)
    require_positive("fps", fps)
    speeds = step_sizes(select_joints(motion, joints)) * fps
    return (strict_minima(speeds.sum(axis=1), order, smooth=smooth, depth=threshold) + 0.5) / fps


def beat_alignment(
    from_beats: Float[np.ndarray, " beats_from"],
    to_beats: Float[np.ndarray, " beats_to"],
    *,
    sigma: float | int,
) -> float:
    """Mean of exp(-d^2 / 2 sigma^2), d from each of `from_beats` to the nearest of `to_beats`.

    The direction matters: from audio to motion (PT, MDD H) many random beats are rewarded, from
    motion to audio (AM E) few careful ones.

    Args:
        from_beats: seconds; every one of them is a term of the mean.
        to_beats: seconds; need not be sorted.
        sigma: tolerance in seconds.

    Returns:
        A number in [0, 1]; nan without `from_beats`, 0.0 without `to_beats`.

    Raises:
        TypeError, ValueError: for anything but finite one-axis arrays and a positive `sigma`.
    """
    from_beats = require("from_beats", from_beats, "beats", at_least=0)
    to_beats = require("to_beats", to_beats, "beats", at_least=0)
    require_positive("sigma", sigma)
    return _alignment(from_beats, to_beats, sigma)


def shuffled_alignment(
    from_beats: Sequence[Float[np.ndarray, " _"]],
    to_beats: Sequence[Float[np.ndarray, " _"]],
    *,
    durations: Float[np.ndarray, " clips"],
    sigma: float | int,
    rng: np.random.Generator,
    shuffles: int = 100,
) -> ShuffledAlignment:
    """Beat alignment beside its chance level: the same beats against those of other clips.

    With ten minima in four seconds any two beat lists align well, so that a raw score says little;
    report `margins`. Each shuffle gives every clip the `to_beats` of another one (never its own);
    `from_beats` later than the other clip's end are left out, since nothing could meet them.

    Args:
        from_beats: one array of seconds per clip.
        to_beats: one array of seconds per clip.
        durations: length of each clip in seconds.
        sigma: tolerance in seconds.
        rng: draws the shuffles.
        shuffles: how many.

    Returns:
        Per clip, score and mean shuffled score. A clip without `from_beats` has nan in both: count
        its margin as 0 when the motion stood still, for dropping it would reward stillness.

    Raises:
        TypeError, ValueError: for lists of unequal length or fewer than two clips.
    """
    durations = require("durations", durations, "clips", at_least=2)
    require_positive("shuffles", shuffles)
    if not len(from_beats) == len(to_beats) == len(durations):
        raise ValueError(
            f"every clip needs from_beats, to_beats and a duration, got {len(from_beats)}, "
            f"{len(to_beats)} and {len(durations)} of them"
        )
    scores = [beat_alignment(a, b, sigma=sigma) for a, b in zip(from_beats, to_beats, strict=True)]
    chance = np.full((shuffles, len(durations)), np.nan)
    for row in chance:
        for clip, other in enumerate(_partners(len(durations), rng)):
            reachable = from_beats[clip][from_beats[clip] <= durations[other]]
            row[clip] = _alignment(reachable, to_beats[other], sigma)
    return ShuffledAlignment(np.array(scores), _mean_of_numbers(chance))


def step_sizes(motion: Float[np.ndarray, "frames joints dims"]) -> np.ndarray:
    """(frames - 1, joints): how far each joint goes from one frame to the next."""
    return np.linalg.norm(np.diff(motion, axis=0), axis=-1)


def select_joints(motion: np.ndarray, joints: Sequence[int] | None) -> np.ndarray:
    """The part of a (frames, joints, dims) motion that counts; `None` is every joint."""
    if joints is None:
        return motion
    if not len(joints) or not all(0 <= joint < motion.shape[1] for joint in joints):
        raise ValueError(
            f"joints {list(joints)} must be indices into the {motion.shape[1]} joints of the "
            "motion; pass the joints that this score is defined on"
        )
    return motion[:, list(joints)]


def strict_minima(
    curve: Float[np.ndarray, " n"], order: int, *, smooth: float | int = 0, depth: float | int = 0
) -> np.ndarray:
    """Indices of a curve that lie below all `order` neighbours on both sides; never the ends."""
    from scipy.ndimage import gaussian_filter1d
    from scipy.signal import argrelmin

    if order < 1 or smooth < 0 or depth < 0:
        raise ValueError(
            f"order must be at least 1 and smooth and threshold at least 0, got {order}, {smooth} "
            f"and {depth}"
        )
    curve = gaussian_filter1d(curve, smooth) if smooth else curve
    lows = argrelmin(curve, order=order)[0]
    rise = np.maximum(curve[lows - 1], curve[lows + 1]) - curve[lows]
    return lows[rise >= depth]


def _alignment(from_beats: np.ndarray, to_beats: np.ndarray, sigma: float | int) -> float:
    if not len(from_beats):
        return float("nan")
    if not len(to_beats):
        return 0.0
    distance = np.abs(from_beats[:, None] - to_beats).min(axis=1)  # (beats_from,)
    return float(np.exp(-(distance**2) / (2 * sigma**2)).mean())


def _partners(clips: int, rng: np.random.Generator) -> np.ndarray:
    """For each clip another one: a random order closed to a ring, so that none meets itself."""
    ring = rng.permutation(clips)
    partners = np.empty_like(ring)
    partners[ring] = np.roll(ring, 1)
    return partners


def _mean_of_numbers(values: np.ndarray) -> np.ndarray:
    """Mean over the first axis of what is not nan; nan where nothing is left."""
    known = np.isfinite(values)
    total = np.where(known, values, 0).sum(axis=0)
    return np.divide(total, known.sum(axis=0), out=np.full(len(total), np.nan), where=known.any(0))
