"""Clips and the windows that models see of them."""

from s2glib.data.samples import GESTURE_TYPES, Clip, Interval
from s2glib.data.shipped import clips, load_clip, speech_windows
from s2glib.data.windows import NOISE_FLOOR_DB, noise_floor, speech_window, spoken_frames

__all__ = [
    "GESTURE_TYPES",
    "NOISE_FLOOR_DB",
    "Clip",
    "Interval",
    "clips",
    "load_clip",
    "noise_floor",
    "speech_window",
    "speech_windows",
    "spoken_frames",
]
