import numpy as np
import pytest
import torch

from s2glib.body.kinematics import forward_kinematics
from s2glib.body.motion import Motion
from s2glib.body.rotations import axis_angle_to_matrix
from s2glib.body.skeleton import FACE_CURVES, JOINT_NAMES, PARENTS, REST_JOINTS, joint
from s2glib.corpus.puppet.pose import (
    HAND_SCALE,
    KEYPOINT_NAMES,
    OWN_PARTS,
    POINT_NAMES,
    Part,
    pose_puppet,
)


def motion(**curves) -> Motion:
    """Any pose, held for one frame, with some face curves pulled."""
    generator = torch.Generator().manual_seed(1)
    poses = 0.3 * torch.randn(1, 55, 3, generator=generator)
    poses[:, joint("jaw")] = torch.tensor([curves.pop("jaw", 0.0), 0.0, 0.0])
    expression = torch.zeros(1, 100)
    for name, value in curves.items():
        expression[:, FACE_CURVES.index(name)] = value
    return Motion(poses, torch.tensor([[0.1, 1.0, 0.2]]), expression, 25.0)


def moved(**curves) -> dict[str, float]:
    """How far each point goes when curves are pulled, metres."""
    step = pose_puppet(motion(**curves)).points - pose_puppet(motion()).points
    return dict(zip(POINT_NAMES, np.linalg.norm(step[0], axis=-1), strict=True))


def test_there_are_13_keypoints_of_the_body_and_21_of_each_hand():
    assert len(KEYPOINT_NAMES) == 13 + 2 * 21
    assert set(KEYPOINT_NAMES) <= set(POINT_NAMES)
    assert len(set(KEYPOINT_NAMES)) == 53  # each hand starts at a wrist that the body has too


def test_points_of_the_body_are_the_joints_of_forward_kinematics():
    still = motion()
    rest = torch.from_numpy(REST_JOINTS).float()
    joints = forward_kinematics(axis_angle_to_matrix(still.poses), rest, PARENTS).positions
    body = [
        joint(f"{side}_{name}") for side in ("left", "right") for name in ("hip", "elbow", "wrist")
    ]
    expected = joints[0, body] + still.trans
    np.testing.assert_allclose(pose_puppet(still).points[0, body], expected, atol=1e-5)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_hand_keeps_its_shape_and_grows_about_its_wrist(side):
    points = pose_puppet(motion()).points[0]
    hand = [
        POINT_NAMES.index(f"{side}_{name}") for name in ("wrist", "middle1", "middle2", "middle3")
    ]
    bones = np.linalg.norm(np.diff(points[hand], axis=0), axis=1)
    rest = np.linalg.norm(np.diff(REST_JOINTS[hand], axis=0), axis=1)
    np.testing.assert_allclose(bones, HAND_SCALE * rest, rtol=1e-6)


@pytest.mark.parametrize("curve", FACE_CURVES)
def test_every_face_curve_moves_the_face_and_nothing_else(curve):
    steps = moved(**{curve: 1.0})
    assert max(steps.values()) > 0.003
    assert all(steps[name] == 0 for name in JOINT_NAMES)


def test_a_smirk_lifts_the_left_corner_only():
    steps = moved(smirk=1.0)
    assert steps["left_mouth_corner"] > 0.01
    assert steps["right_mouth_corner"] == 0


def test_a_jaw_opens_the_mouth():
    points = dict(zip(POINT_NAMES, pose_puppet(motion(jaw=0.3)).points[0], strict=True))
    assert np.linalg.norm(points["mouth_top"] - points["mouth_bottom"]) > 0.02


def test_curves_beyond_their_range_do_not_tear_the_face():
    assert moved(smile=1.0) == moved(smile=40.0)


def test_every_keypoint_lies_on_the_person():
    assert OWN_PARTS.any(axis=1).all()
    assert not OWN_PARTS[:, Part.BACKGROUND].any()
