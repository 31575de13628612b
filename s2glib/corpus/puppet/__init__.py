"""The puppet: a two-dimensional speaker, drawn from the joints of a body."""

from s2glib.corpus.puppet.drawing import Camera, Canvas, Part, Picture, finish
from s2glib.corpus.puppet.figure import paint_figure
from s2glib.corpus.puppet.pose import KEYPOINT_NAMES, Frame, Puppet, Sketch, pose_puppet
from s2glib.corpus.puppet.scenery import backdrop, cloth_tile

__all__ = [
    "KEYPOINT_NAMES",
    "Camera",
    "Canvas",
    "Frame",
    "Part",
    "Picture",
    "Puppet",
    "Sketch",
    "backdrop",
    "cloth_tile",
    "finish",
    "paint_figure",
    "pose_puppet",
]
