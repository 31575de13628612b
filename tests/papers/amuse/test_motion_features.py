import pytest
import torch

from s2glib.body import (
    JOINT_NAMES,
    PARENTS,
    PELVIS_HEIGHT,
    REST_JOINTS,
    axis_angle_to_matrix,
    forward_kinematics,
    joint,
    matrix_to_sixd,
)
from s2glib.corpus import Cell, render_motion
from s2glib.papers.amuse import UpperBodyFeatures, WholeBodyFeatures, motion_features
from s2glib.papers.amuse.motion_features import (
    HAND_COMPONENTS,
    HAND_LENGTH,
    HANDS,
    SEEN_JOINTS,
    UPPER_BODY,
)


@pytest.fixture
def poses():
    """Poses whose hands have as many degrees of freedom as there are components."""
    poses = torch.zeros(200, 55, 3)
    poses[:, UPPER_BODY] = 0.6 * torch.randn(200, 13, 3)
    hands = torch.randn(200, HAND_COMPONENTS) @ torch.randn(HAND_COMPONENTS, 90) * 0.1
    poses[:, HANDS] = hands.unflatten(1, (30, 3))
    return poses


@pytest.fixture
def features(poses):
    features = UpperBodyFeatures()
    features.fit(poses)
    return features


def full_body(poses):
    rest = torch.from_numpy(REST_JOINTS).to(poses)
    return forward_kinematics(axis_angle_to_matrix(poses), rest, PARENTS)


def test_a_frame_has_90_numbers_of_13_joints_and_two_hands(features, poses):
    assert UpperBodyFeatures.size == 6 * 13 + 12 == 90
    assert {JOINT_NAMES[j] for j in UPPER_BODY} & {"pelvis", "left_knee", "jaw"} == set()
    assert features.from_poses(poses).shape == (200, 90)


def test_features_are_standardised_over_the_poses_they_were_fitted_on(features, poses):
    standard = features.from_poses(poses)
    torch.testing.assert_close(standard.mean(0), torch.zeros(90), atol=1e-4, rtol=0)
    torch.testing.assert_close(standard.std(0), torch.ones(90), atol=1e-3, rtol=0)


def test_rotations_survive_the_way_there_and_back(features, poses):
    back = features.to_poses(features.from_poses(poses))
    was, now = (axis_angle_to_matrix(p[:, UPPER_BODY]) for p in (poses, back))
    assert (was - now).abs().max() < 1e-4
    torch.testing.assert_close(back[:, HANDS], poses[:, HANDS], atol=1e-3, rtol=0)


def test_joints_that_features_leave_out_come_back_at_rest(features, poses):
    poses[:, joint("left_knee")] = 1.0
    poses[:, joint("jaw")] = 0.2
    back = features.to_poses(features.from_poses(poses))
    for name in ("pelvis", "left_knee", "jaw", "left_eye"):
        assert (back[:, joint(name)] == 0).all()


def test_hands_keep_their_first_principal_components(poses):
    poses[:, HANDS] += 0.05 * torch.randn(200, 30, 3)
    features = UpperBodyFeatures()
    features.fit(poses)
    hands = poses[:, HANDS].flatten(1)
    back = features.to_poses(features.from_poses(poses))[:, HANDS].flatten(1)
    *_, strengths, _ = torch.linalg.svd(hands - hands.mean(0), full_matrices=False)
    least = strengths[HAND_COMPONENTS:].square().sum()  # Eckart-Young
    torch.testing.assert_close((hands - back).square().sum(), least, rtol=1e-3, atol=1e-3)


def test_a_feature_that_never_changes_does_not_blow_up():
    features = UpperBodyFeatures()
    features.fit(torch.zeros(20, 55, 3))
    assert (features.from_poses(torch.zeros(3, 55, 3)) == 0).all()


def test_positions_agree_with_the_whole_body(features, poses):
    places, body = features.positions(features.from_poses(poses)), full_body(poses)
    for number, name in enumerate(SEEN_JOINTS[:7]):
        torch.testing.assert_close(
            places[:, number], body.positions[:, joint(name)], atol=1e-4, rtol=0
        )
    for number, (side, sign) in enumerate((("left", 1), ("right", -1)), start=7):
        wrist = joint(f"{side}_wrist")
        along = sign * HAND_LENGTH * body.rotations[:, wrist, :, 0]
        expected = body.positions[:, wrist] + along
        torch.testing.assert_close(places[:, number], expected, atol=1e-4, rtol=0)


def test_any_numbers_are_made_valid_rotations_once_and_for_all(features):
    wild = torch.randn(5, 7, 90)
    valid = features.valid(wild)
    turns = features.rotations(valid)
    torch.testing.assert_close(turns @ turns.mT, torch.eye(3).expand_as(turns), atol=1e-4, rtol=0)
    raw = valid * features.std + features.mean
    torch.testing.assert_close(raw[..., :78], matrix_to_sixd(turns).flatten(-2), atol=1e-4, rtol=0)
    torch.testing.assert_close(features.valid(valid), valid, atol=1e-3, rtol=1e-3)
    assert torch.equal(valid[..., 78:], wild[..., 78:])


def test_positions_are_differentiable_in_the_features(features):
    tiny = features.double()
    x = 0.3 * torch.randn(1, 90, dtype=torch.float64)
    assert torch.autograd.gradcheck(tiny.positions, (x.requires_grad_(),), atol=1e-4)


@pytest.fixture
def any_pose():
    return 0.6 * torch.randn(4, 7, 55, 3)


def test_the_whole_body_has_the_papers_333_numbers_as_they_are(any_pose):
    place = torch.randn(4, 7, 3)
    features = WholeBodyFeatures().from_poses(any_pose, place)
    assert features.shape == (4, 7, 333)
    elbow = 6 * joint("left_elbow")
    expected = matrix_to_sixd(axis_angle_to_matrix(any_pose[..., joint("left_elbow"), :]))
    assert torch.equal(features[..., elbow : elbow + 6], expected)
    assert torch.equal(features[..., 330:], place)


def test_every_joint_and_the_pelvis_survive_the_way_there_and_back(any_pose):
    whole, place = WholeBodyFeatures(), torch.randn(4, 7, 3)
    features = whole.from_poses(any_pose, place)
    was, now = (axis_angle_to_matrix(p) for p in (any_pose, whole.to_poses(features)))
    assert (was - now).abs().max() < 1e-4
    assert torch.equal(whole.pelvis(features), place)


def test_standing_feet_tell_where_the_pelvis_is():
    """Oracle: the corpus knows where it put the pelvis."""
    motion = render_motion(Cell(0, "voice_01", "anger", 0)).motion
    whole = WholeBodyFeatures()
    found = whole.pelvis(whole.from_poses(motion.poses))
    assert motion.trans.std(0).max() > 0.004
    torch.testing.assert_close(found, motion.trans, atol=1e-3, rtol=0)


def test_whole_bodies_are_seen_where_they_are(any_pose):
    whole = WholeBodyFeatures()
    places, body = whole.positions(whole.from_poses(any_pose)), full_body(any_pose)
    joints = [joint(name) for name in SEEN_JOINTS[:7]]
    torch.testing.assert_close(places[..., :7, :], body.positions[..., joints, :])


def test_a_body_that_only_moves_its_upper_half_is_seen_alike_by_both(features, poses):
    whole = WholeBodyFeatures()
    ours, papers = (f.positions(f.from_poses(poses)) for f in (features, whole))
    torch.testing.assert_close(ours, papers, atol=1e-4, rtol=0)
    standing = torch.tensor([0.0, PELVIS_HEIGHT, 0.0]).expand(200, 3)
    for representation in (features, whole):
        pelvis = representation.pelvis(representation.from_poses(poses))
        torch.testing.assert_close(pelvis, standing)


def test_any_numbers_are_made_valid_rotations_of_the_whole_body():
    whole, wild = WholeBodyFeatures(), torch.randn(3, 333)
    valid = whole.valid(wild)
    torch.testing.assert_close(valid[..., :330], matrix_to_sixd(whole.rotations(wild)).flatten(-2))
    torch.testing.assert_close(whole.valid(valid), valid)
    assert torch.equal(whole.pelvis(valid), whole.pelvis(wild))


def test_nothing_about_the_whole_body_is_fitted(any_pose):
    whole = WholeBodyFeatures()
    before = whole.from_poses(any_pose)
    whole.fit(any_pose.flatten(0, 1))
    assert torch.equal(whole.from_poses(any_pose), before)
    assert whole.state_dict() == {}


def test_a_size_names_its_representation():
    assert isinstance(motion_features(90), UpperBodyFeatures)
    assert isinstance(motion_features(333), WholeBodyFeatures)
    with pytest.raises(ValueError, match=r"90 .* or 333 .*, not 168"):
        motion_features(168)
