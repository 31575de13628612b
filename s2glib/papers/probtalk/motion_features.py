"""What ProbTalk sees of a body: jaw, upper body, both hands and the face; legs and eyes stay out.

Paper:    PT A.1 (holistic motion); joints, order and statistics: authors' code
Notebook: notebooks/05_product_codes.ipynb
"""

from typing import Literal

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn

from s2glib.body import (
    Kinematics,
    axis_angle_to_matrix,
    forward_kinematics,
    matrix_to_axis_angle,
    matrix_to_sixd,
    sixd_to_matrix,
)
from s2glib.body.skeleton import JOINT_NAMES, PARENTS, REST_JOINTS, joint

PARTS = ("face", "body", "left_hand", "right_hand")
"""What can be kept or made anew by itself; the face is the jaw and the expression."""


def _chain(number: int) -> list[int]:
    """A joint and all it hangs on."""
    return [] if number < 0 else [number, *_chain(PARENTS[number])]


_STILL = ("pelvis", "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle")
_FIRST, _MIDDLE = joint("left_index1"), joint("right_index1")  # where the hands' joints begin
JOINTS_OF: dict[str, tuple[int, ...]] = {
    "face": (joint("jaw"),),
    "body": tuple(joint(name) for name in JOINT_NAMES[:22] if name not in _STILL),
    "left_hand": tuple(range(_FIRST, _MIDDLE)),
    "right_hand": tuple(range(_MIDDLE, len(JOINT_NAMES))),
}
"""The joints of each part; all others stay at rest."""

_KEPT = [number for part in PARTS for number in JOINTS_OF[part]]
_SPANS = {"jaw": (0, 6), "body": (6, 96), "hands": (96, 276)}
_SPANS |= {"left_hand": (96, 186), "right_hand": (186, 276)}
_SIXD = 6 * len(_KEPT)  # 276

POINTS = (
    "head",
    *(
        f"{side}_{name}"
        for name in ("shoulder", "elbow", "wrist", "middle1")
        for side in ("left", "right")
    ),
)
"""Head, arms and hands: what is seen of a gesture from afar."""

_WRISTS = [joint("left_wrist"), joint("right_wrist")]
_CHEST = joint("spine3")
_TREE = sorted({ancestor for name in POINTS for ancestor in _chain(joint(name))})
_TREE_PARENTS = [-1, *(_TREE.index(PARENTS[j]) for j in _TREE[1:])]
_COEFFICIENTS = 100  # of a motion's expression
SMALLEST_STD = 0.02  # what varies less is not blown up; authors' code: 1e-9 where it is 0


class HolisticFeatures(nn.Module):
    """46 joints x 6D and some face coefficients, standardised; the statistics travel along.

    Attributes:
        parts: where the numbers of "jaw", "body", "hands", "left_hand", "right_hand" and
            "expression" are.

    Args:
        expression: how many of a motion's 100 face coefficients are seen.
        statistics: "shared": all joints have one mean and one spread, six numbers each; "centred":
            every number has its own mean, so that zero is the mean pose (ours). Face coefficients
            always have their own mean and spread.
    """

    mean: Tensor
    std: Tensor
    face_mean: Tensor
    face_std: Tensor
    rest_joints: Tensor

    def __init__(self, expression: int, statistics: Literal["shared", "centred"] = "shared"):
        super().__init__()
        self.expression, self.statistics = expression, statistics
        self.size = _SIXD + expression
        spans = _SPANS | {"expression": (_SIXD, self.size)}
        self.parts = {name: slice(*span) for name, span in spans.items()}
        self.register_buffer("mean", torch.zeros(len(_KEPT), 6))
        self.register_buffer("std", torch.ones(6))
        self.register_buffer("face_mean", torch.zeros(expression))
        self.register_buffer("face_std", torch.ones(expression))
        rest = torch.tensor(REST_JOINTS[_TREE] - REST_JOINTS[_TREE[0]], dtype=torch.float32)
        self.register_buffer("rest_joints", rest, persistent=False)

    def fit(self, poses: Float[Tensor, "n 55 3"], expression: Float[Tensor, "n 100"]) -> None:
        """Learn means and spreads from many poses and faces."""
        sixd = matrix_to_sixd(axis_angle_to_matrix(poses))
        self.mean.copy_(sixd.mean((0, 1)) if self.statistics == "shared" else sixd.mean(0)[_KEPT])
        self.std.copy_(sixd.std((0, 1)).clamp_min(SMALLEST_STD))
        face = expression[:, : self.expression]
        self.face_mean.copy_(face.mean(0))
        self.face_std.copy_(face.std(0).clamp_min(SMALLEST_STD))

    def from_motion(
        self, poses: Float[Tensor, "*b 55 3"], expression: Float[Tensor, "*b 100"]
    ) -> Float[Tensor, "*b size"]:
        """Standardised features of axis-angle poses and faces."""
        sixd = matrix_to_sixd(axis_angle_to_matrix(poses[..., _KEPT, :]))
        body = ((sixd - self.mean) / self.std).flatten(-2)
        face = (expression[..., : self.expression] - self.face_mean) / self.face_std
        return torch.cat([body, face], dim=-1)

    def rotations(self, features: Float[Tensor, "*b size"]) -> Float[Tensor, "*b 46 3 3"]:
        """True rotations of the joints that are seen, whatever numbers the features hold."""
        return sixd_to_matrix(self._sixd(features))

    def _sixd(self, features: Tensor) -> Tensor:
        return features[..., :_SIXD].unflatten(-1, (len(_KEPT), 6)) * self.std + self.mean

    def to_poses(self, features: Float[Tensor, "*b size"]) -> Float[Tensor, "*b 55 3"]:
        """Axis-angle poses; joints that the features leave out are at rest: the body stands."""
        poses = features.new_zeros(*features.shape[:-1], len(JOINT_NAMES), 3)
        poses[..., _KEPT, :] = matrix_to_axis_angle(self.rotations(features))
        return poses

    def to_expression(self, features: Float[Tensor, "*b size"]) -> Float[Tensor, "*b 100"]:
        """Face coefficients; those that the features leave out are zero."""
        seen = features[..., self.parts["expression"]] * self.face_std + self.face_mean
        return nn.functional.pad(seen, (0, _COEFFICIENTS - self.expression))

    def wrists(self, features: Float[Tensor, "*b size"]) -> Float[Tensor, "*b 2 3"]:
        """Where the left and the right wrist are, metres, seen from the chest as it turns."""
        turns, places = self._tree(features)
        chest, wrists = _TREE.index(_CHEST), [_TREE.index(number) for number in _WRISTS]
        away = places[..., wrists, :] - places[..., [chest], :]
        return away @ turns[..., chest, :, :]

    def points(self, features: Float[Tensor, "*b size"]) -> Float[Tensor, "*b 9 3"]:
        """Where `POINTS` are, metres from the pelvis, which does not turn."""
        return self._tree(features).positions[..., [_TREE.index(joint(n)) for n in POINTS], :]

    def _tree(self, features: Tensor) -> Kinematics:
        moving = [_KEPT.index(number) for number in _TREE[1:]]
        turns = sixd_to_matrix(self._sixd(features)[..., moving, :])
        pelvis = torch.eye(3).to(turns).expand(*turns.shape[:-3], 1, 3, 3)
        turns = torch.cat([pelvis, turns], dim=-3)
        return forward_kinematics(turns, self.rest_joints, _TREE_PARENTS)

    def of_parts(self, known: Bool[Tensor, "*b 4"]) -> Bool[Tensor, "*b size"]:
        """Spread a mask over `PARTS` to the numbers that belong to them."""
        lengths = [*(6 * len(JOINTS_OF[part]) for part in PARTS), self.expression]
        part = torch.tensor([*range(len(PARTS)), PARTS.index("face")], device=known.device)
        return known[..., part.repeat_interleave(torch.tensor(lengths, device=known.device))]
