"""Packing films: frames of films that play side by side, as a few sheets of small pictures.

A sheet is a JPEG whose colours are as fine as its greys, because small pictures lose most where
colours are halved: some 2.5 kB for a frame of 64 pixels.

Paper:    -
Notebook: notebooks/04_repairing_pixels.ipynb
"""

import io
import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from s2glib.audio.io import Waveform
from s2glib.viz.film import check_fps
from s2glib.widgets.packing import pack_sound
from s2glib.widgets.playback import check_waveform

SIDE = 4096  # pixels along a sheet, which every browser can hold
MOST_PIXELS = 1 << 27  # half a gigabyte, once a browser has opened the sheets
QUALITY = 92


class Place(NamedTuple):
    """Where a film stands among those beside it, in pixels."""

    name: str
    left: int
    width: int
    height: int


class PackedFilms(NamedTuple):
    """What a page needs in order to play films.

    Attributes:
        film: what film_player.js needs in order to find every frame on the sheets.
        sheets: one behind the other.
        sound: a WAV file, or nothing.
    """

    film: dict[str, object]
    sheets: bytes
    sound: bytes


def pack_films(
    films: Mapping[str, UInt8[np.ndarray, "_t _h _w 3"]],
    fps: float | int,
    waveform: Waveform | None = None,
) -> PackedFilms:
    """Films of one clock, side by side; where one is shorter, its last frame stays.

    Raises:
        TypeError: if the waveform is none.
        ValueError: if nobody can watch at this rate, or it is more than a browser can hold.
    """
    check_fps(fps)
    check_waveform(waveform)
    frames = max(map(len, films.values()))
    height, width = max(_heights(films)), sum(_widths(films))
    if max(height, width) > SIDE or frames * height * width > MOST_PIXELS:
        raise ValueError(
            f"{frames} frames of {width} x {height} pixels are more than a browser holds; show "
            "fewer or smaller ones, or write a video file"
        )
    columns = min(SIDE // width, math.ceil(math.sqrt(frames)))
    rows = min(SIDE // height, math.ceil(frames / columns))
    blocks = [np.arange(frames)[k : k + rows * columns] for k in range(0, frames, rows * columns)]
    sheets = [_jpeg(_sheet(_beside(films, block), columns)) for block in blocks]
    places = [place._asdict() for place in _places(films)]
    film = {"fps": float(fps), "frames": frames, "films": places, "size": (width, height)}
    grid = {"columns": columns, "rows": rows}
    coded = {"kind": "image/jpeg", "lengths": list(map(len, sheets))}
    sound = pack_sound(waveform, frames / fps)
    return PackedFilms({**film, **grid, **coded}, b"".join(sheets), sound)


def _heights(films: Mapping[str, np.ndarray]) -> list[int]:
    return [film.shape[1] for film in films.values()]


def _widths(films: Mapping[str, np.ndarray]) -> list[int]:
    return [film.shape[2] for film in films.values()]


def _places(films: Mapping[str, np.ndarray]) -> list[Place]:
    lefts = np.cumsum([0, *_widths(films)]).tolist()
    return list(map(Place, films, lefts, _widths(films), _heights(films)))


def _beside(films: Mapping[str, np.ndarray], block: np.ndarray) -> np.ndarray:
    """Some frames of all films, side by side, from their upper edges down."""
    row = np.zeros((len(block), max(_heights(films)), sum(_widths(films)), 3), np.uint8)
    for (_, left, width, height), film in zip(_places(films), films.values(), strict=True):
        row[:, :height, left : left + width] = film[block.clip(max=len(film) - 1)]
    return row


def _sheet(pictures: np.ndarray, columns: int) -> np.ndarray:
    """Pictures in rows of so many; the last row is filled up with black."""
    count, height, width, _ = pictures.shape
    full = np.pad(pictures, [(0, -count % columns), (0, 0), (0, 0), (0, 0)])
    grid = full.reshape(-1, columns, height, width, 3).swapaxes(1, 2)
    return grid.reshape(-1, columns * width, 3)


def _jpeg(sheet: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(sheet).save(file, "JPEG", quality=QUALITY, subsampling=0, optimize=True)
    return file.getvalue()
