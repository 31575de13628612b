"""A motion: the pose, place and face of one body, frame by frame.

Paper:    PT A.2, AM C.2 (SMPL-X parameters at 30 fps)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import math
from dataclasses import dataclass
from numbers import Real

import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.body.kinematics import forward_kinematics
from s2glib.body.rotations import axis_angle_to_matrix
from s2glib.body.skinning import BodyModel, Skinned, linear_blend_skinning

_BLOCK = 1024  # frames whose joints are found together: a long motion needs no more memory
_FRAME_SHAPES = {"poses": (55, 3), "trans": (3,), "expression": (100,)}


@dataclass(frozen=True, eq=False)
class Motion:
    """A gesture clip in the parameters that all three papers share.

    Attributes:
        poses: axis-angle of each joint relative to its parent, radians, SMPL-X order.
        trans: where the pelvis is, metres; standing, it is `PELVIS_HEIGHT` above the floor.
        expression: the face. Our own motions keep `FACE_CURVES` in the first columns.
        fps: frames per second.

    Raises:
        TypeError: if a field is not a float tensor, or `fps` not a number.
        ValueError: if shapes do not fit, a number is not finite, or `fps` is not above zero.
    """

    poses: Float[Tensor, "frames 55 3"]
    trans: Float[Tensor, "frames 3"]
    expression: Float[Tensor, "frames 100"]
    fps: float | int

    def __post_init__(self) -> None:
        for name, frame_shape in _FRAME_SHAPES.items():
            _check_track(name, getattr(self, name), frame_shape)
        lengths = [len(getattr(self, name)) for name in _FRAME_SHAPES]
        if len(set(lengths)) > 1:
            raise ValueError(f"poses, trans and expression differ in frames: {lengths}; cut them")
        if len({getattr(self, name).dtype for name in _FRAME_SHAPES}) > 1:
            raise TypeError("poses, trans and expression differ in dtype; convert them to one")
        if not isinstance(self.fps, Real) or isinstance(self.fps, bool):
            raise TypeError(f"fps must be a number, got {type(self.fps).__name__}")
        if not (math.isfinite(self.fps) and self.fps > 0):
            raise ValueError(f"fps must be finite and above zero, got {self.fps}")
        object.__setattr__(self, "fps", float(self.fps))

    @property
    def frames(self) -> int:
        """How many frames the motion has."""
        return len(self.poses)

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the end of the last one."""
        return self.frames / self.fps


def _check_track(name: str, value: Tensor, frame_shape: tuple[int, ...]) -> None:
    if not isinstance(value, Tensor):
        raise TypeError(f"{name} must be a torch tensor, got {type(value).__name__}")
    if not value.is_floating_point():
        raise TypeError(f"{name} must hold floats, got {value.dtype}; call .float() on it")
    if value.ndim == 0 or tuple(value.shape[1:]) != frame_shape:
        expected = ", ".join(map(str, frame_shape))
        raise ValueError(f"{name} must be (frames, {expected}), got {tuple(value.shape)}")
    if len(value) == 0:
        raise ValueError(f"{name} has no frames; a motion needs at least one")
    if not value.isfinite().all():
        raise ValueError(f"{name} holds NaN or infinite values; repair or drop those frames")


def joint_positions(motion: Motion, body: BodyModel) -> Float[Tensor, "frames 55 3"]:
    """Where the joints of the body's rest shape are in every frame, metres."""
    joints = body.joints.to(motion.poses)
    blocks = zip(motion.poses.split(_BLOCK), motion.trans.split(_BLOCK), strict=True)
    places = [
        forward_kinematics(axis_angle_to_matrix(poses), joints, body.parents).positions
        + trans[:, None, :]
        for poses, trans in blocks
    ]
    return torch.cat(places)


def skin_motion(motion: Motion, body: BodyModel) -> Skinned:
    """The body's surface and joints in every frame; the face takes as many curves as it knows."""
    directions = body.expression_directions
    expression = None if directions is None else motion.expression[:, : directions.shape[-1]]
    return linear_blend_skinning(
        body, axis_angle_to_matrix(motion.poses), motion.trans, expression=expression
    )
