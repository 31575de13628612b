"""Pictures of motion and sound; every function takes axes and returns them."""

from s2glib.viz.audio import draw_features, draw_waveform, draw_words
from s2glib.viz.motion import draw_pose, draw_strip
from s2glib.viz.surface import draw_bodies, draw_surface
from s2glib.viz.systems import draw_systems

__all__ = [
    "draw_bodies",
    "draw_features",
    "draw_pose",
    "draw_strip",
    "draw_surface",
    "draw_systems",
    "draw_waveform",
    "draw_words",
]
