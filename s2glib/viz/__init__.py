"""Pictures of motion and sound; what draws takes axes and returns them."""

from s2glib.viz.audio import draw_features, draw_waveform, draw_words
from s2glib.viz.film import draw_films, film_bytes
from s2glib.viz.flows import (
    draw_keypoint_groups,
    draw_moving_flow,
    draw_occlusion,
    draw_weight_maps,
)
from s2glib.viz.kept import draw_kept
from s2glib.viz.motion import draw_pose, draw_strip
from s2glib.viz.pictures import (
    draw_boxes,
    draw_gram,
    draw_masks,
    draw_receptive_fields,
)
from s2glib.viz.surface import draw_bodies, draw_surface
from s2glib.viz.systems import draw_systems
from s2glib.viz.tokens import draw_tokens
from s2glib.viz.video_file import write_video
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
    "draw_boxes",
    "draw_carried_grid",
    "draw_control_points",
    "draw_features",
    "draw_films",
    "draw_flow",
    "draw_gram",
    "draw_heatmap",
    "draw_kept",
    "draw_keypoint_groups",
    "draw_masks",
    "draw_moving_flow",
    "draw_occlusion",
    "draw_picture",
    "draw_pose",
    "draw_receptive_fields",
    "draw_strip",
    "draw_surface",
    "draw_systems",
    "draw_tokens",
    "draw_warped_grid",
    "draw_waveform",
    "draw_weight_maps",
    "draw_words",
    "film_bytes",
    "write_video",
]
