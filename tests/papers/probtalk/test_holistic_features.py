import pytest
import torch

from s2glib.body import (
    FACE_CURVES,
    JOINT_NAMES,
    PARENTS,
    REST_JOINTS,
    axis_angle_to_matrix,
    forward_kinematics,
    joint,
    matrix_to_sixd,
)
from s2glib.corpus import Cell, render_motion
from s2glib.papers.probtalk import JOINTS_OF, PARTS, HolisticFeatures
from s2glib.papers.probtalk.motion_features import POINTS

KEPT = [number for part in PARTS for number in JOINTS_OF[part]]
CURVES = len(FACE_CURVES)


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.fixture(scope="module")
def motion():
    return render_motion(Cell(3, "voice_02", "happiness", 0)).motion


@pytest.fixture(params=["shared", "centred"])
def features(request, motion):
    features = HolisticFeatures(CURVES, request.param)
    features.fit(motion.poses, motion.expression)
    return features


def test_the_papers_frame_has_376_numbers_and_ours_288():
    assert HolisticFeatures(100).size == 6 + 15 * 6 + 30 * 6 + 100 == 376
    assert HolisticFeatures(CURVES).size == 288


def test_legs_eyes_and_pelvis_stay_out():
    left_out = {JOINT_NAMES[j] for j in range(55) if j not in KEPT}
    legs = {f"{side}_{name}" for side in ("left", "right") for name in ("hip", "knee", "ankle")}
    assert left_out == legs | {"left_eye", "right_eye", "pelvis"}
    assert len(JOINTS_OF["body"]) == 15


def test_kept_joints_and_the_face_survive_the_way_there_and_back(features, motion):
    seen = features.from_motion(motion.poses, motion.expression)
    back = features.to_poses(seen)
    torch.testing.assert_close(back[:, KEPT], motion.poses[:, KEPT], atol=2e-5, rtol=0)
    assert (back[:, [j for j in range(55) if j not in KEPT]] == 0).all()
    torch.testing.assert_close(features.to_expression(seen), motion.expression, atol=1e-5, rtol=0)


def test_parts_stand_where_they_are_said_to(features, motion):
    seen = features.from_motion(motion.poses, motion.expression)
    poses = motion.poses.clone()
    poses[:, JOINTS_OF["right_hand"]] += 0.1
    changed = (features.from_motion(poses, motion.expression) != seen).any(0).nonzero()[:, 0]
    assert set(changed.tolist()) <= set(range(*features.parts["right_hand"].indices(288)))
    ends = [(s.start, s.stop) for s in features.parts.values()]
    assert ends == [(0, 6), (6, 96), (96, 276), (96, 186), (186, 276), (276, 288)]


def test_shared_statistics_are_one_mean_and_spread_of_all_joints(motion):
    features = HolisticFeatures(CURVES)
    features.fit(motion.poses, motion.expression)
    raw = matrix_to_sixd(axis_angle_to_matrix(motion.poses)).flatten(0, 1)
    seen = features.from_motion(motion.poses, motion.expression)
    elbow = 6 * KEPT.index(joint("left_elbow"))
    expected = (raw.view(-1, 55, 6)[:, joint("left_elbow")] - raw.mean(0)) / raw.std(0)
    torch.testing.assert_close(seen[:, elbow : elbow + 6], expected, atol=1e-4, rtol=1e-4)


def test_centred_features_are_the_shared_ones_from_another_origin(motion):
    shared, centred = (HolisticFeatures(CURVES, kind) for kind in ("shared", "centred"))
    for features in (shared, centred):
        features.fit(motion.poses, motion.expression)
    ours, theirs = (f.from_motion(motion.poses, motion.expression) for f in (centred, shared))
    torch.testing.assert_close(ours.mean(0), torch.zeros(288), atol=1e-3, rtol=0)
    torch.testing.assert_close(ours - ours[0], theirs - theirs[0], atol=1e-4, rtol=0)


def test_a_joint_that_never_moves_does_not_blow_up(features):
    features.fit(torch.zeros(9, 55, 3), torch.zeros(9, 100))
    assert features.from_motion(torch.zeros(2, 55, 3), torch.zeros(2, 100)).abs().max() < 1e-4


def test_any_numbers_stand_for_true_rotations(features):
    turns = features.rotations(torch.randn(2, 3, 288))
    torch.testing.assert_close(turns @ turns.mT, torch.eye(3).expand_as(turns), atol=1e-5, rtol=0)


def test_wrists_are_seen_from_the_chest_as_the_whole_body_has_them(features):
    poses = 0.5 * torch.randn(6, 55, 3)
    rest = torch.from_numpy(REST_JOINTS).float()
    body = forward_kinematics(axis_angle_to_matrix(poses), rest, PARENTS)
    chest, wrists = joint("spine3"), [joint("left_wrist"), joint("right_wrist")]
    away = body.positions[:, wrists] - body.positions[:, [chest]]
    expected = away @ body.rotations[:, chest]  # rows: R^T (wrist - chest)
    found = features.wrists(features.from_motion(poses, torch.zeros(6, 100)))
    torch.testing.assert_close(found, expected, atol=1e-4, rtol=0)


def test_points_are_where_the_whole_body_has_them(features):
    poses = 0.5 * torch.randn(6, 55, 3)
    poses[:, [joint(name) for name in ("pelvis", "left_hip", "right_hip")]] = 0
    rest = torch.from_numpy(REST_JOINTS).float()
    body = forward_kinematics(axis_angle_to_matrix(poses), rest, PARENTS).positions
    expected = body[:, [joint(name) for name in POINTS]] - body[:, :1]
    found = features.points(features.from_motion(poses, torch.zeros(6, 100)))
    torch.testing.assert_close(found, expected, atol=1e-4, rtol=0)


@pytest.mark.parametrize("seen", ["wrists", "points"])
def test_gradients_of_places_are_right(features, seen):
    tiny, x = features.double(), 0.3 * torch.randn(1, 288, dtype=torch.float64)
    assert torch.autograd.gradcheck(getattr(tiny, seen), (x.requires_grad_(),), atol=1e-4)


def test_a_mask_over_parts_reaches_all_their_numbers_and_no_others(features):
    for number, part in enumerate(PARTS):
        mask = features.of_parts(torch.eye(4, dtype=torch.bool)[number])
        names = ("jaw", "expression") if part == "face" else (part,)
        expected = torch.zeros(288, dtype=torch.bool)
        for name in names:
            expected[features.parts[name]] = True
        assert torch.equal(mask, expected)


def test_statistics_travel_in_the_state_dict(features, motion):
    other = HolisticFeatures(CURVES)
    other.load_state_dict(features.state_dict())
    seen = (f.from_motion(motion.poses, motion.expression) for f in (features, other))
    assert torch.equal(*seen)
