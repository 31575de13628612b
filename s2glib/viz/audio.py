"""Drawing sound: a waveform, features frame by frame, and the words on the same clock.

Paper:    AM Fig. A.3 (filterbank)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes


def draw_waveform(axes: Axes, samples: Float[np.ndarray, " n"], sample_rate: int) -> Axes:
    """Draw a waveform over seconds."""
    axes.plot(np.arange(len(samples)) / sample_rate, samples, "k-", linewidth=0.4)
    axes.set(xlabel="time (s)", ylabel="amplitude (no unit)")
    return axes


def draw_features(
    axes: Axes, features: Float[np.ndarray, "frames k"], frame_rate: float, label: str
) -> Axes:
    """Draw features as colours, time to the right, the first feature at the bottom."""
    frames, count = features.shape
    reach = (0, frames / frame_rate, 0, count)
    axes.imshow(features.T, origin="lower", aspect="auto", extent=reach, interpolation="none")
    axes.set(xlabel="time (s)", ylabel=label)
    return axes


def draw_words(axes: Axes, words: Sequence[str], starts: Sequence[float]) -> Axes:
    """Write words above the axes on three levels in turn, each where it starts (seconds)."""
    place = axes.get_xaxis_transform()  # x in seconds, y as a share of the height
    for count, (word, start) in enumerate(zip(words, starts, strict=True)):
        above = (0, 3 + 11 * (count % 3))
        axes.annotate(
            word, (start, 1), above, xycoords=place, textcoords="offset points", fontsize=9
        )
    return axes
