"""Video: a motion as a small film of a drawn speaker, with exact masks and keypoints.

Nothing is estimated. Masks are the parts that the strokes wrote while they painted, keypoints are
the points that were drawn, and a keypoint is visible if nothing else was painted over it.

Paper:    MDD 4.1 (clips at 25 fps), B.3 (masks of hands and face), C (13 + 2 x 21 keypoints)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import math
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, UInt8
from torch import Tensor

from s2glib.body.motion import Motion
from s2glib.body.rotations import axis_angle_to_matrix, matrix_to_axis_angle
from s2glib.corpus.appearance import Appearance
from s2glib.corpus.puppet.drawing import Camera, Canvas, Part, finish
from s2glib.corpus.puppet.figure import paint_figure
from s2glib.corpus.puppet.pose import KEYPOINT_POINTS, OWN_PARTS, Sketch, pose_puppet
from s2glib.corpus.puppet.scenery import backdrop, cloth_tile
from s2glib.data.samples import Clip

SPAN = 1.2  # metres from the lower to the upper edge: hips to a hand above the head
EYE_LEVEL = 0.39  # metres above the pelvis: the middle of the picture
CAMERA_DISTANCE = 4.0


@dataclass(frozen=True, eq=False)
class Video:
    """A clip of pictures and what is where in them.

    Attributes:
        frames: (t, h, w, 3), red, green, blue.
        parts: (t, h, w), the `Part` at the centre of every pixel.
        keypoints: (t, 55, 2), `KEYPOINT_NAMES`, x then y, -1 and 1 at the centres of the outermost
            pixels; beyond that, the point has left the picture.
        visible: (t, 55), whether a keypoint is inside the picture and its own part of the body is
            what one sees there. A finger in front of its own hand hides nothing.
        fps: frames per second.
    """

    frames: UInt8[np.ndarray, "t h w 3"]
    parts: UInt8[np.ndarray, "t h w"]
    keypoints: Float[np.ndarray, "t k 2"]
    visible: Bool[np.ndarray, "t k"]
    fps: float

    @property
    def hand_mask(self) -> Bool[np.ndarray, "t h w"]:
        """Where a hand is seen, from the wrist on."""
        return self.parts >= Part.LEFT_HAND

    @property
    def face_mask(self) -> Bool[np.ndarray, "t h w"]:
        """Where the face is seen: the head without hair and neck."""
        return self.parts == Part.FACE

    @property
    def person_mask(self) -> Bool[np.ndarray, "t h w"]:
        """Where the speaker is seen."""
        return self.parts != Part.BACKGROUND


def render_video(clip: Clip, appearance: Appearance, size: int, fps: float | int = 25) -> Video:
    """Film a clip of the corpus.

    Raises:
        ValueError: as `render_frames`.
    """
    return render_frames(clip.motion, appearance, size, fps)


def render_frames(
    motion: Motion, appearance: Appearance, size: int, fps: float | int = 25
) -> Video:
    """Film a motion. The camera stands still, in front of where the pelvis is on average.

    Args:
        motion: at any rate; resampled to `fps`.
        appearance: who is seen, in which clothes and room.
        size: height and width in pixels, 32 to 1024.
        fps: frames per second; the film has floor(duration x fps) frames, at least one.

    Raises:
        ValueError: if the size or the rate is out of range.
    """
    if not 32 <= size <= 1024:
        raise ValueError(f"size must be from 32 to 1024 pixels, got {size}")
    if not (math.isfinite(fps) and fps > 0):
        raise ValueError(f"fps must be finite and above zero, got {fps}")
    supersampling = 5 if size < 96 else 3  # odd: one fine pixel lies in the middle
    puppet = pose_puppet(resample_motion(motion, fps))
    camera = _camera(puppet.points[:, 0], size * supersampling)
    wall, cloth = backdrop(appearance.room, camera.size), cloth_tile(appearance.outfit)
    pictures = []
    for frame in puppet.frames(camera):
        canvas = Canvas(wall)
        paint_figure(Sketch(canvas, frame, appearance), cloth)
        pictures.append(finish(canvas, supersampling))
    places = camera.project(puppet.points[:, KEYPOINT_POINTS]) / supersampling
    parts = np.stack([picture.parts for picture in pictures])
    return Video(
        frames=np.stack([picture.frame for picture in pictures]),
        parts=parts,
        keypoints=(2 * (places - 0.5) / (size - 1) - 1).astype(np.float32),
        visible=_visible(places, parts),
        fps=float(fps),
    )


def resample_motion(motion: Motion, fps: float | int) -> Motion:
    """The motion at another rate, frame k at k / fps seconds.

    Each joint turns between two frames at constant speed about one axis (the geodesic); place and
    face go straight.
    """
    frames = max(1, math.floor(motion.duration * fps))
    time = torch.arange(frames, dtype=motion.poses.dtype) / fps * motion.fps
    time = time.clamp(max=motion.frames - 1)
    before = time.floor().long()
    after = (before + 1).clamp(max=motion.frames - 1)
    share = (time - before)[:, None]
    start, stop = (axis_angle_to_matrix(motion.poses[k]) for k in (before, after))
    step = matrix_to_axis_angle(start.mT @ stop) * share[..., None]
    poses = matrix_to_axis_angle(start @ axis_angle_to_matrix(step))

    def straight(track: Tensor) -> Tensor:
        return torch.lerp(track[before], track[after], share)

    return Motion(poses, straight(motion.trans), straight(motion.expression), float(fps))


def _camera(pelvis: Float[np.ndarray, "t 3"], size: int) -> Camera:
    center = pelvis.mean(axis=0) + np.array([0, EYE_LEVEL, 0])
    return Camera(center, SPAN, CAMERA_DISTANCE, size)


def _visible(places: Float[np.ndarray, "t k 2"], parts: UInt8[np.ndarray, "t h w"]) -> np.ndarray:
    size = parts.shape[-1]
    inside = ((places >= 0) & (places < size)).all(axis=-1)
    column, row = np.moveaxis(places.clip(0, size - 1).astype(int), -1, 0)
    seen = parts[np.arange(len(parts))[:, None], row, column]
    return inside & OWN_PARTS[np.arange(len(OWN_PARTS)), seen]
