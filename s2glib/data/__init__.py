"""Clips and the windows that models see of them."""

from s2glib.data.film_files import find_films
from s2glib.data.films import Footage, read_film
from s2glib.data.samples import GESTURE_TYPES, Clip, Interval
from s2glib.data.shipped import clips, load_clip, speech_windows
from s2glib.data.windows import NOISE_FLOOR_DB, noise_floor, speech_window, spoken_frames

__all__ = [
    "GESTURE_TYPES",
    "NOISE_FLOOR_DB",
    "Clip",
    "Footage",
    "Interval",
    "clips",
    "find_films",
    "load_clip",
    "noise_floor",
    "read_film",
    "speech_window",
    "speech_windows",
    "spoken_frames",
]
