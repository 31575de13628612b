"""Films: frames in either of the two ways they come, and moments of them in a row.

Paper:    -
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from collections.abc import Mapping, Sequence
from numbers import Real

import numpy as np
from jaxtyping import Float, UInt8
from matplotlib.axes import Axes
from torch import Tensor

Frames = (
    UInt8[np.ndarray, "_t _h _w 3"]
    | UInt8[Tensor, "_t _h _w 3"]
    | Float[np.ndarray, "_t 3 _h _w"]
    | Float[Tensor, "_t 3 _h _w"]
)
FASTEST = 120  # frames per second


def film_bytes(frames: Frames) -> UInt8[np.ndarray, "t h w 3"]:
    """A film as bytes, whether it comes as bytes (t, h, w, 3) or in 0 .. 1 (t, 3, h, w).

    Raises:
        TypeError: if it is no array or tensor of bytes or floats.
        ValueError: if it is empty, of another shape, or a value is not in 0 .. 1.
    """
    if isinstance(frames, Tensor):
        frames = (frames.float() if frames.is_floating_point() else frames).detach().cpu().numpy()
    kind = getattr(getattr(frames, "dtype", None), "kind", type(frames).__name__)
    if kind != "f" and getattr(frames, "dtype", None) != np.uint8:
        raise TypeError(
            "frames must be bytes (t, h, w, 3) or floats (t, 3, h, w), got "
            f"{getattr(frames, 'dtype', kind)}"
        )
    if frames.ndim != 4 or not frames.size or frames.shape[1 if kind == "f" else 3] != 3:
        raise ValueError(
            "frames must be bytes (t, h, w, 3) or floats (t, 3, h, w), at least one, got "
            f"{frames.dtype} {frames.shape}"
        )
    if kind != "f":
        return np.ascontiguousarray(frames)
    levels = np.round(np.float32(255) * frames)
    if not ((levels >= 0) & (levels <= 255)).all():
        raise ValueError("frames of floats must have values from 0 to 1; clamp or divide them")
    return np.ascontiguousarray(levels.astype(np.uint8).transpose(0, 2, 3, 1))


def check_fps(fps: float | int, fastest: int = FASTEST) -> None:
    """Refuse a rate at which nobody can watch, or that is no number."""
    if not isinstance(fps, Real):
        raise TypeError(f"fps must be a number, got {type(fps).__name__}")
    if not 1 <= fps <= fastest:
        raise ValueError(f"fps must be from 1 to {fastest} here, got {fps}; leave out frames")


def draw_films(
    axes: Axes, films: Mapping[str, Frames], fps: float | int, times: Sequence[float | int]
) -> Axes:
    """Draw moments of films, a row for each film; every picture is one unit wide.

    Args:
        axes: where to draw.
        films: by name, as `write_video` takes them.
        fps: frames per second, of all.
        times: seconds; a time after the end shows the last frame.

    Raises:
        TypeError: if the films hold something else than bytes or floats.
        ValueError: if there is no film or no time, or a film is none.
    """
    if not films or not len(times):
        raise ValueError("there is nothing to draw; give at least one film and one time")
    top, middles = 0.0, []
    for film in map(film_bytes, films.values()):
        shown = [film[min(int(time * fps + 1e-3), len(film) - 1)] for time in times]
        height = film.shape[1] / film.shape[2]
        axes.imshow(np.concatenate(shown, axis=1), extent=(0, len(times), top + height, top))
        middles.append(top + height / 2)
        top += height
    axes.set_xticks(np.arange(len(times)) + 0.5, [f"{time:.1f}" for time in times])
    axes.set_yticks(middles, list(films))
    axes.set(xlim=(0, len(times)), ylim=(top, 0), xlabel="time (s)", ylabel="film")
    return axes
