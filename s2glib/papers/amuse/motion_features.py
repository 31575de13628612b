"""What the motion models see of a body: rotations as six numbers, hands as a few components.

The jaw stays out: it follows the sound, and a classifier would read the tempo of speech off it.

Paper:    AM C.1 (6D rotations); fewer joints and hand components: ours
Notebook: notebooks/12_motion_prior.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.body import (
    axis_angle_to_matrix,
    forward_kinematics,
    matrix_to_axis_angle,
    matrix_to_sixd,
    sixd_to_matrix,
)
from s2glib.body.skeleton import JOINT_NAMES, PARENTS, REST_JOINTS, joint

UPPER_BODY = tuple(
    joint(name)
    for name in JOINT_NAMES[:22]
    if name != "pelvis" and not name.endswith(("hip", "knee", "ankle", "foot"))
)
HANDS = tuple(range(joint("left_index1"), joint("right_thumb3") + 1))
HAND_COMPONENTS = 12
FEATURES = 6 * len(UPPER_BODY) + HAND_COMPONENTS
SMALLEST_STD = 0.02

_TREE = (0, *UPPER_BODY)
_TREE_PARENTS = tuple(-1 if j == 0 else _TREE.index(PARENTS[j]) for j in _TREE)
_SEEN = ("head", "left_shoulder", "right_shoulder", "left_elbow", "right_elbow")
_WRISTS = ("left_wrist", "right_wrist")
HAND_LENGTH = 0.10  # metres from the wrist to the point that stands for the hand
SEEN_JOINTS = (*_SEEN, *_WRISTS, "left_hand", "right_hand")
"""The nine points of `MotionFeatures.positions`."""


class MotionFeatures(nn.Module):
    """Between poses and standardised features; the statistics travel with the model.

    A motion has `FEATURES` = 90 numbers per frame: 13 upper-body joints x 6D and 12 principal
    components of both hands.
    """

    hand_mean: Tensor
    hand_basis: Tensor
    mean: Tensor
    std: Tensor
    rest_joints: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("hand_mean", torch.zeros(3 * len(HANDS)))
        self.register_buffer("hand_basis", torch.zeros(3 * len(HANDS), HAND_COMPONENTS))
        self.register_buffer("mean", torch.zeros(FEATURES))
        self.register_buffer("std", torch.ones(FEATURES))
        rest = torch.tensor(REST_JOINTS[list(_TREE)], dtype=torch.float32)
        self.register_buffer("rest_joints", rest, persistent=False)

    def fit(self, poses: Float[Tensor, "n 55 3"]) -> None:
        """Learn the hands' components and the features' mean and spread from many poses."""
        hands = poses[:, HANDS].flatten(1)
        self.hand_mean.copy_(hands.mean(0))
        _, _, basis = torch.linalg.svd(hands - self.hand_mean, full_matrices=False)
        self.hand_basis.copy_(basis[:HAND_COMPONENTS].T)
        raw = self._raw(poses)
        self.mean.copy_(raw.mean(0))
        self.std.copy_(raw.std(0).clamp_min(SMALLEST_STD))

    def _raw(self, poses: Tensor) -> Tensor:
        sixd = matrix_to_sixd(axis_angle_to_matrix(poses[..., UPPER_BODY, :])).flatten(-2)
        hands = (poses[..., HANDS, :].flatten(-2) - self.hand_mean) @ self.hand_basis
        return torch.cat([sixd, hands], dim=-1)

    def from_poses(self, poses: Float[Tensor, "*b 55 3"]) -> Float[Tensor, "*b 90"]:
        """Standardised features of axis-angle poses."""
        return (self._raw(poses) - self.mean) / self.std

    def rotations(self, features: Float[Tensor, "*b 90"]) -> Float[Tensor, "*b 13 3 3"]:
        """True rotations of the upper body, whatever numbers the features hold."""
        raw = features * self.std + self.mean
        return sixd_to_matrix(raw[..., :-HAND_COMPONENTS].unflatten(-1, (len(UPPER_BODY), 6)))

    def to_poses(self, features: Float[Tensor, "*b 90"]) -> Float[Tensor, "*b 55 3"]:
        """Axis-angle poses; joints that the features leave out are zero."""
        poses = features.new_zeros(*features.shape[:-1], len(JOINT_NAMES), 3)
        poses[..., UPPER_BODY, :] = matrix_to_axis_angle(self.rotations(features))
        components = (features * self.std + self.mean)[..., -HAND_COMPONENTS:]
        hands = components @ self.hand_basis.T + self.hand_mean
        poses[..., HANDS, :] = hands.unflatten(-1, (len(HANDS), 3))
        return poses

    def valid(self, features: Float[Tensor, "*b 90"]) -> Float[Tensor, "*b 90"]:
        """The nearest features that are rotations, so that no judge sees anything else."""
        sixd = matrix_to_sixd(self.rotations(features)).flatten(-2)
        split = sixd.shape[-1]
        sixd = (sixd - self.mean[:split]) / self.std[:split]
        return torch.cat([sixd, features[..., split:]], dim=-1)

    def positions(self, features: Float[Tensor, "*b 90"]) -> Float[Tensor, "*b 9 3"]:
        """Where the nine `SEEN_JOINTS` are, metres from the pelvis."""
        turns = self.rotations(features)
        identity = torch.eye(3, dtype=turns.dtype, device=turns.device)
        turns = torch.cat([identity.expand(*turns.shape[:-3], 1, 3, 3), turns], dim=-3)
        body = forward_kinematics(turns, self.rest_joints, _TREE_PARENTS)
        places = [body.positions[..., _TREE.index(joint(name)), :] for name in (*_SEEN, *_WRISTS)]
        for wrist, sign in zip(_WRISTS, (1.0, -1.0), strict=True):
            at = _TREE.index(joint(wrist))
            along = sign * HAND_LENGTH * body.rotations[..., at, :, 0]
            places.append(body.positions[..., at, :] + along)
        return torch.stack(places, dim=-2)
