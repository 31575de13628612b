"""What the motion models see of a body: the whole of it, or trunk, arms and hands.

A model's size says which: 333 numbers per frame are the paper's, 90 are ours.

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
from s2glib.body.skeleton import JOINT_NAMES, PARENTS, PELVIS_HEIGHT, REST_JOINTS, joint

UPPER_BODY = tuple(
    joint(name)
    for name in JOINT_NAMES[:22]
    if name != "pelvis" and not name.endswith(("hip", "knee", "ankle", "foot"))
)
HANDS = tuple(range(joint("left_index1"), joint("right_thumb3") + 1))
HAND_COMPONENTS = 12
SMALLEST_STD = 0.02
STANDING = (0.0, PELVIS_HEIGHT, 0.0)  # where the pelvis is, metres

_TREE = (0, *UPPER_BODY)
_TREE_PARENTS = tuple(-1 if j == 0 else _TREE.index(PARENTS[j]) for j in _TREE)
_SEEN = ("head", "left_shoulder", "right_shoulder", "left_elbow", "right_elbow")
_WRISTS = ("left_wrist", "right_wrist")
HAND_LENGTH = 0.10  # metres from the wrist to the point that stands for the hand
SEEN_JOINTS = (*_SEEN, *_WRISTS, "left_hand", "right_hand")
"""The nine points of `positions`."""


def seen_positions(
    turns: Float[Tensor, "*b 14 3 3"], rest_joints: Float[Tensor, "14 3"]
) -> Float[Tensor, "*b 9 3"]:
    """Where the nine `SEEN_JOINTS` are, metres from the pelvis, which turns first."""
    body = forward_kinematics(turns, rest_joints, _TREE_PARENTS)
    places = [body.positions[..., _TREE.index(joint(name)), :] for name in (*_SEEN, *_WRISTS)]
    for wrist, sign in zip(_WRISTS, (1.0, -1.0), strict=True):
        at = _TREE.index(joint(wrist))
        along = sign * HAND_LENGTH * body.rotations[..., at, :, 0]
        places.append(body.positions[..., at, :] + along)
    return torch.stack(places, dim=-2)


class UpperBodyFeatures(nn.Module):
    """13 upper-body joints x 6D and 12 principal components of both hands, standardised (ours).

    The statistics travel with the model. The jaw stays out: it follows the sound, and a classifier
    would read the tempo of speech off it.
    """

    size = 6 * len(UPPER_BODY) + HAND_COMPONENTS  # 90
    hand_mean: Tensor
    hand_basis: Tensor
    mean: Tensor
    std: Tensor
    rest_joints: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("hand_mean", torch.zeros(3 * len(HANDS)))
        self.register_buffer("hand_basis", torch.zeros(3 * len(HANDS), HAND_COMPONENTS))
        self.register_buffer("mean", torch.zeros(self.size))
        self.register_buffer("std", torch.ones(self.size))
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
        pelvis = torch.eye(3, dtype=turns.dtype, device=turns.device)
        pelvis = pelvis.expand(*turns.shape[:-3], 1, 3, 3)
        return seen_positions(torch.cat([pelvis, turns], dim=-3), self.rest_joints)

    def pelvis(self, features: Float[Tensor, "*b 90"]) -> Float[Tensor, "*b 3"]:
        """Where the pelvis is, metres: the body stands."""
        return features.new_tensor(STANDING).repeat(*features.shape[:-1], 1)


class WholeBodyFeatures(nn.Module):
    """55 joints x 6D and the pelvis' place in metres, as they are  [AM C.1; authors' code]."""

    size = 6 * len(JOINT_NAMES) + 3  # 333
    rest_joints: Tensor

    def __init__(self) -> None:
        super().__init__()
        rest = torch.tensor(REST_JOINTS, dtype=torch.float32)
        self.register_buffer("rest_joints", rest, persistent=False)

    def fit(self, poses: Float[Tensor, "n 55 3"]) -> None:
        """Learn nothing: the authors' code does not standardise."""

    def from_poses(
        self, poses: Float[Tensor, "*b 55 3"], trans: Float[Tensor, "*b 3"] | None = None
    ) -> Float[Tensor, "*b 333"]:
        """Features of axis-angle poses.

        Args:
            poses: of all joints.
            trans: where the pelvis is; without it, where it must be for the feet to stand still.
        """
        turns = axis_angle_to_matrix(poses)
        trans = self._above_the_feet(turns) if trans is None else trans
        return torch.cat([matrix_to_sixd(turns).flatten(-2), trans], dim=-1)

    def _above_the_feet(self, turns: Tensor) -> Tensor:
        ankles = [joint("left_ankle"), joint("right_ankle")]
        places = forward_kinematics(turns, self.rest_joints, PARENTS).positions
        moved = (places - self.rest_joints)[..., ankles, :].mean(dim=-2)
        return turns.new_tensor(STANDING) - moved

    def rotations(self, features: Float[Tensor, "*b 333"]) -> Float[Tensor, "*b 55 3 3"]:
        """True rotations of all joints, whatever numbers the features hold."""
        return sixd_to_matrix(features[..., :-3].unflatten(-1, (len(JOINT_NAMES), 6)))

    def to_poses(self, features: Float[Tensor, "*b 333"]) -> Float[Tensor, "*b 55 3"]:
        """Axis-angle poses."""
        return matrix_to_axis_angle(self.rotations(features))

    def valid(self, features: Float[Tensor, "*b 333"]) -> Float[Tensor, "*b 333"]:
        """The nearest features that are rotations, so that no judge sees anything else."""
        sixd = matrix_to_sixd(self.rotations(features)).flatten(-2)
        return torch.cat([sixd, self.pelvis(features)], dim=-1)

    def positions(self, features: Float[Tensor, "*b 333"]) -> Float[Tensor, "*b 9 3"]:
        """Where the nine `SEEN_JOINTS` are, metres from the pelvis."""
        turns = self.rotations(features)[..., _TREE, :, :]
        return seen_positions(turns, self.rest_joints[[*_TREE]])

    def pelvis(self, features: Float[Tensor, "*b 333"]) -> Float[Tensor, "*b 3"]:
        """Where the pelvis is, metres."""
        return features[..., -3:]


MotionFeatures = UpperBodyFeatures | WholeBodyFeatures


def motion_features(size: int) -> MotionFeatures:
    """The representation that has `size` numbers per frame.

    Raises:
        ValueError: if there is none.
    """
    for features in (UpperBodyFeatures, WholeBodyFeatures):
        if features.size == size:
            return features()
    raise ValueError(
        f"motion has {UpperBodyFeatures.size} numbers per frame (upper body) or "
        f"{WholeBodyFeatures.size} (whole body), not {size}"
    )
