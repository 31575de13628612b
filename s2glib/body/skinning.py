"""Linear blend skinning: a surface that follows its skeleton.

Paper:    PT A.2, AM C.2 (SMPL-X bodies)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

import torch
from jaxtyping import Float, Int64
from torch import Tensor

from s2glib.body.kinematics import check_parents, forward_kinematics


@dataclass(frozen=True, eq=False)
class BodyModel:
    """A surface in its rest pose, and how it follows joints, shape and face.

    Attributes:
        vertices: surface points of the rest pose, metres.
        faces: three vertex numbers a triangle, counter-clockwise seen from outside.
        weights: how much each vertex follows each joint; rows sum to one.
        joints: joints of the rest pose, metres.
        parents: parent of each joint, -1 for the root.
        colors: red, green and blue of each vertex in [0, 1], or None.
        shape_directions: how each vertex moves with each shape coefficient, or None.
        expression_directions: the same for each expression coefficient, or None.
        pose_directions: how each vertex moves with each entry of R_j - I, root left out, or None.
        joint_regressor: joints as weighted means of vertices, so that they move with the shape,
            or None where they stay.

    Raises:
        ValueError: if a shape does not fit the others, or a face points past the vertices.
    """

    vertices: Float[Tensor, "v 3"]
    faces: Int64[Tensor, "f 3"]
    weights: Float[Tensor, "v j"]
    joints: Float[Tensor, "j 3"]
    parents: tuple[int, ...]
    colors: Float[Tensor, "v 3"] | None = None
    shape_directions: Float[Tensor, "v 3 s"] | None = None
    expression_directions: Float[Tensor, "v 3 e"] | None = None
    pose_directions: Float[Tensor, "v 3 p"] | None = None
    joint_regressor: Float[Tensor, "j v"] | None = None

    def __post_init__(self) -> None:
        check_shape("vertices", self.vertices, (None, 3))
        check_shape("joints", self.joints, (None, 3))
        v, j = len(self.vertices), len(self.joints)
        check_parents(self.parents, j)
        expected = {
            "faces": (None, 3),
            "weights": (v, j),
            "colors": (v, 3),
            "shape_directions": (v, 3, None),
            "expression_directions": (v, 3, None),
            "pose_directions": (v, 3, 9 * (j - 1)),
            "joint_regressor": (j, v),
        }
        for name, shape in expected.items():
            check_shape(name, getattr(self, name), shape)
        if self.faces.numel() and not 0 <= self.faces.min() <= self.faces.max() < v:
            raise ValueError(f"faces must name vertices 0 to {v - 1}")

    def to(self, target: torch.dtype | torch.device | str) -> "BodyModel":
        """The same body with other floats or on another device; faces stay whole numbers."""
        moved: dict[str, Any] = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, Tensor):
                stays = isinstance(target, torch.dtype) and not value.is_floating_point()
                moved[field.name] = value if stays else value.to(target)
        return replace(self, **moved)


def check_shape(name: str, value: Tensor | None, shape: tuple[int | None, ...]) -> None:
    """Refuse a tensor of another shape; an axis that is None may have any length.

    Raises:
        ValueError: if the shape differs.
    """
    if value is None:
        return
    fits = value.ndim == len(shape) and all(
        want in (None, size) for want, size in zip(shape, value.shape, strict=True)
    )
    if not fits:
        wanted = ", ".join("any" if want is None else str(want) for want in shape)
        raise ValueError(f"{name} must be ({wanted}), got {tuple(value.shape)}")


class Skinned(NamedTuple):
    """A posed surface and its joints, metres."""

    vertices: Float[Tensor, "*b v 3"]
    joints: Float[Tensor, "*b j 3"]


def linear_blend_skinning(
    body: BodyModel,
    rotations: Float[Tensor, "*#b j 3 3"],
    trans: Float[Tensor, "*#b 3"],
    *,
    betas: Float[Tensor, "*#b s"] | None = None,
    expression: Float[Tensor, "*#b e"] | None = None,
) -> Skinned:
    """Pose a body: shape it, correct it for the pose, carry it along with its joints, move it.

    Args:
        body: what to pose, with the dtype and device of `rotations`.
        rotations: turn of each joint relative to its parent.
        trans: added to everything, metres.
        betas: shape coefficients; fewer than the body has means the first ones.
        expression: expression coefficients, the same way.

    Raises:
        ValueError: if more coefficients are given than the body has directions.
    """
    shaped = _shape(body, betas, expression)
    rest_joints = body.joints
    if body.joint_regressor is not None and shaped is not body.vertices:
        rest_joints = torch.einsum("jv,...vc->...jc", body.joint_regressor, shaped)
    posed = shaped
    if body.pose_directions is not None:
        identity = torch.eye(3, dtype=rotations.dtype, device=rotations.device)
        bend = (rotations[..., 1:, :, :] - identity).flatten(-3)
        posed = shaped + _offsets(bend, body.pose_directions)
    kinematics = forward_kinematics(rotations, rest_joints, body.parents)
    joints = kinematics.positions + trans[..., None, :]
    return Skinned(_blend(body.weights, kinematics.rotations, rest_joints, joints, posed), joints)


def _shape(body: BodyModel, betas: Tensor | None, expression: Tensor | None) -> Tensor:
    """The rest pose of this person with this face: (*b, v, 3)."""
    shaped = body.vertices
    for name, coefficients, directions in (
        ("betas", betas, body.shape_directions),
        ("expression", expression, body.expression_directions),
    ):
        if coefficients is None:
            continue
        given, known = coefficients.shape[-1], 0 if directions is None else directions.shape[-1]
        if directions is None or given > known:
            raise ValueError(f"this body knows {known} {name}, got {given}; cut the rest off")
        shaped = shaped + _offsets(coefficients, directions[..., :given])
    return shaped


def _offsets(coefficients: Tensor, directions: Tensor) -> Tensor:
    """Sum of directions, each times its coefficient: (*b, v, 3)."""
    return (coefficients @ directions.flatten(0, 1).mT).unflatten(-1, (-1, 3))


def _blend(
    weights: Tensor, rotations: Tensor, rest_joints: Tensor, joints: Tensor, posed: Tensor
) -> Tensor:
    """Sum_j w_j (G_j (v - rest_j) + p_j): blend the maps, then apply each to its vertex."""
    turned = (rotations @ rest_joints[..., None]).squeeze(-1)
    columns = torch.cat([rotations.mT, (joints - turned)[..., None, :]], dim=-2)  # (*b, j, 4, 3)
    X, Y, Z, shift = (weights @ columns.flatten(-2)).unflatten(-1, (4, 3)).unbind(-2)
    x, y, z = posed.split(1, dim=-1)
    return shift.addcmul(x, X).addcmul(y, Y).addcmul(z, Z)
