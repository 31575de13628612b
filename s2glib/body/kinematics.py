"""Forward kinematics: from the turn at each joint to where every joint is.

Paper:    PT A.2, AM C.2 (SMPL-X bodies)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from collections.abc import Sequence
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor


class Kinematics(NamedTuple):
    """Where each joint is and how it is turned, in the space of the whole body."""

    rotations: Float[Tensor, "*b j 3 3"]
    positions: Float[Tensor, "*b j 3"]


def check_parents(parents: Sequence[int], joints: int) -> None:
    """Refuse a tree in which a joint comes before its parent.

    Raises:
        ValueError: if there is not one parent a joint, or a parent does not come first.
    """
    if len(parents) != joints:
        raise ValueError(f"expected one parent for each of {joints} joints, got {len(parents)}")
    for joint, parent in enumerate(parents):
        if not -1 <= parent < joint:
            raise ValueError(
                f"joint {joint} has parent {parent}; order the joints so that parents come "
                "before their children, and give roots the parent -1"
            )


def forward_kinematics(
    rotations: Float[Tensor, "*#b j 3 3"],
    rest_joints: Float[Tensor, "*#b j 3"],
    parents: Sequence[int],
) -> Kinematics:
    """Walk down the tree: each joint turns with its parent, then by its own rotation.

    Args:
        rotations: each joint's turn relative to its parent, leading axes broadcast.
        rest_joints: joint positions in the rest pose, metres. Roots stay where they are.
        parents: parent of each joint, before its children; -1 for a root. Any tree or forest.

    Returns:
        Global rotations G and positions p: [G p; 0 1]_j = [G p; 0 1]_parent [R offset; 0 1]_j.

    Raises:
        ValueError: if `parents` does not fit the joints.
    """
    check_parents(parents, rotations.shape[-3])
    local = _local_maps(rotations, rest_joints, parents).unbind(-3)
    world: list[Tensor] = []
    for step, parent in zip(local, parents, strict=True):
        world.append(step if parent < 0 else world[parent] @ step)
    maps = torch.stack(world, dim=-3)
    return Kinematics(maps[..., :3, :3], maps[..., :3, 3])


def _local_maps(rotations: Tensor, rest_joints: Tensor, parents: Sequence[int]) -> Tensor:
    """[R_j offset_j; 0 1]: each joint's turn, and its place seen from its parent, (*b, j, 4, 4)."""
    from_parent = rest_joints[..., [max(parent, 0) for parent in parents], :]
    is_root = torch.tensor([parent < 0 for parent in parents], device=rest_joints.device)
    offsets = torch.where(is_root[:, None], rest_joints, rest_joints - from_parent)[..., None]
    batch = torch.broadcast_shapes(rotations.shape[:-2], offsets.shape[:-2])
    upper = torch.cat([rotations.expand(*batch, 3, 3), offsets.expand(*batch, 3, 1)], dim=-1)
    last_row = upper.new_tensor([0.0, 0.0, 0.0, 1.0]).expand(*batch, 1, 4)
    return torch.cat([upper, last_row], dim=-2)
