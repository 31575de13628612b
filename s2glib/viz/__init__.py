"""Pictures of motion and sound; every function takes axes and returns them."""

from s2glib.viz.audio import draw_features, draw_waveform, draw_words
from s2glib.viz.motion import draw_pose, draw_strip
from s2glib.viz.surface import draw_bodies, draw_surface
from s2glib.viz.systems import draw_systems
from s2glib.viz.warps import (
    draw_carried_grid,
    draw_control_points,
    draw_flow,
    draw_heatmap,
    draw_picture,
    draw_warped_grid,
)

__all__ = [
    "draw_bodies",
    "draw_carried_grid",
    "draw_control_points",
    "draw_features",
    "draw_flow",
    "draw_heatmap",
    "draw_picture",
    "draw_pose",
    "draw_strip",
    "draw_surface",
    "draw_systems",
    "draw_warped_grid",
    "draw_waveform",
    "draw_words",
]
