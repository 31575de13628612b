import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from smplx.lbs import batch_rigid_transform
from torch.autograd import gradcheck

from s2glib.body import PARENTS, REST_JOINTS, axis_angle_to_matrix, forward_kinematics, joint

rest = torch.from_numpy(REST_JOINTS)


def random_rotations(*shape, seed=0):
    generator = torch.Generator().manual_seed(seed)
    return axis_angle_to_matrix(torch.randn(*shape, 3, dtype=torch.float64, generator=generator))


@st.composite
def trees(draw):
    joints = draw(st.integers(1, 8))
    return tuple(draw(st.integers(-1, j - 1)) for j in range(joints))


def test_positions_agree_with_smplx():
    rotations = random_rotations(7, 55)
    ours = forward_kinematics(rotations, rest, PARENTS)
    theirs, _ = batch_rigid_transform(
        rotations, rest.expand(7, 55, 3), torch.tensor(PARENTS), dtype=torch.float64
    )
    torch.testing.assert_close(ours.positions, theirs, atol=1e-13, rtol=0.0)


@settings(max_examples=40)
@given(trees(), st.integers(0, 1000))
def test_any_tree_is_the_chain_of_its_maps(parents, seed):
    rotations = random_rotations(len(parents), seed=seed)
    joints = random_rotations(len(parents), seed=seed + 1)[:, 0]
    ours = forward_kinematics(rotations, joints, parents)
    for j, parent in enumerate(parents):
        turn, place = (
            (torch.eye(3, dtype=torch.float64), joints[j])
            if parent < 0
            else (
                ours.rotations[parent],
                ours.positions[parent] + ours.rotations[parent] @ (joints[j] - joints[parent]),
            )
        )
        torch.testing.assert_close(ours.rotations[j], turn @ rotations[j])
        torch.testing.assert_close(ours.positions[j], place)


def test_identity_pose_is_the_rest_pose():
    identity = torch.eye(3, dtype=torch.float64).expand(55, 3, 3)
    ours = forward_kinematics(identity, rest, PARENTS)
    torch.testing.assert_close(ours.positions, rest)
    torch.testing.assert_close(ours.rotations, identity)


@given(st.integers(0, 1000))
def test_bones_keep_their_lengths(seed):
    positions = forward_kinematics(random_rotations(55, seed=seed), rest, PARENTS).positions
    child, parent = list(range(1, 55)), list(PARENTS[1:])
    torch.testing.assert_close(
        (positions[child] - positions[parent]).norm(dim=-1),
        (rest[child] - rest[parent]).norm(dim=-1),
    )


def test_turning_the_root_turns_everything():
    rotations = random_rotations(55)
    turn = random_rotations(seed=5)
    turned = torch.cat([(turn @ rotations[0])[None], rotations[1:]])
    before = forward_kinematics(rotations, rest, PARENTS)
    after = forward_kinematics(turned, rest, PARENTS)
    torch.testing.assert_close(after.positions, before.positions @ turn.T)
    torch.testing.assert_close(after.rotations, turn @ before.rotations)


def test_a_raised_left_arm_points_up():
    rotations = torch.eye(3, dtype=torch.float64).repeat(55, 1, 1)
    quarter_turn = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    rotations[joint("left_shoulder")] = torch.from_numpy(quarter_turn)
    positions = forward_kinematics(rotations, rest, PARENTS).positions.numpy()
    reach = REST_JOINTS[joint("left_wrist")] - REST_JOINTS[joint("left_shoulder")]
    expected = positions[joint("left_shoulder")] + [-reach[1], reach[0], reach[2]]
    np.testing.assert_allclose(positions[joint("left_wrist")], expected, atol=1e-12)


def test_a_subset_of_joints_moves_as_in_the_whole_body():
    arm = [joint(f"left_{name}") for name in ("collar", "shoulder", "elbow", "wrist")]
    rotations = random_rotations(55)
    whole = forward_kinematics(rotations, rest, PARENTS)
    alone = forward_kinematics(rotations[arm], rest[arm], (-1, 0, 1, 2))
    turn = whole.rotations[PARENTS[arm[0]]]
    whole_arm, alone_arm = whole.positions[arm], alone.positions
    torch.testing.assert_close(whole_arm - whole_arm[0], (alone_arm - alone_arm[0]) @ turn.T)


@given(st.sampled_from([((), (2,)), ((3, 1), (2,)), ((2,), ()), ((0,), ())]))
def test_leading_axes_broadcast(batches):
    rotation_batch, rest_batch = batches
    ours = forward_kinematics(
        random_rotations(*rotation_batch, 55), rest.expand(*rest_batch, 55, 3), PARENTS
    )
    batch = torch.broadcast_shapes(rotation_batch, rest_batch)
    assert ours.rotations.shape == (*batch, 55, 3, 3)
    assert ours.positions.shape == (*batch, 55, 3)


def test_gradients():
    def positions(axis_angle, joints):
        return forward_kinematics(axis_angle_to_matrix(axis_angle), joints, (-1, 0, 1, 0)).positions

    generator = torch.Generator().manual_seed(1)
    poses, joints = torch.randn(2, 4, 3, dtype=torch.float64, generator=generator)
    assert gradcheck(positions, (poses.requires_grad_(), joints.requires_grad_()))


@pytest.mark.parametrize("parents", [(-1, 0), (-1, 2, 0), (0, 0, 1), (-1, -2, 0), (-1, 1, 0)])
def test_trees_that_do_not_fit_are_refused(parents):
    with pytest.raises(ValueError, match="parent"):
        forward_kinematics(random_rotations(3), rest[:3], parents)
