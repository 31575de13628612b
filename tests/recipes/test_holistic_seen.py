"""What is measured of holistic motion: joints, half windows, borders, mirrors, agreement."""

import numpy as np
import pytest
import torch

from s2glib.body import JOINT_NAMES, REST_JOINTS, joint
from s2glib.papers.amuse.motion_features import SEEN_JOINTS
from s2glib.papers.probtalk import TEACHING_FEATURES, FeatureNets, HolisticFeatures
from s2glib.recipes.holistic_seen import (
    NINE,
    WRISTS,
    border_errors,
    held,
    joint_places,
    look,
    mirrored,
    wrist_agreement,
)


@pytest.fixture
def features():
    return HolisticFeatures(12)


def at_rest(features, count=1, frames=4):
    return features.from_motion(torch.zeros(count, frames, 55, 3), torch.zeros(count, frames, 100))


def test_a_body_at_rest_has_its_joints_where_the_skeleton_has_them(features):
    places = joint_places(features, at_rest(features))
    assert np.allclose(places[0, 0], REST_JOINTS - REST_JOINTS[0], atol=1e-5)


def test_the_nine_points_stand_in_the_order_of_amuse():
    names = [JOINT_NAMES[number] for number in NINE]
    assert names[:7] == list(SEEN_JOINTS[:7])
    assert names[7:] == ["left_middle1", "right_middle1"]


def test_a_raised_left_arm_in_the_mirror_is_a_raised_right_arm(features):
    left, right = torch.zeros(2, 1, 1, 55, 3)
    left[..., joint("left_shoulder"), 2] = 1.0
    right[..., joint("right_shoulder"), 2] = -1.0
    seen = [
        joint_places(features, features.from_motion(p, torch.zeros(1, 1, 100)))
        for p in (left, right)
    ]
    assert np.allclose(mirrored(seen[0]), seen[1], atol=1e-5)
    assert not np.allclose(seen[0], seen[1], atol=0.1)


def test_a_mirror_twice_is_no_mirror(rng):
    joints = rng.normal(size=(3, 55, 3))
    assert np.array_equal(mirrored(mirrored(joints)), joints)


def test_after_a_clips_end_its_last_frame_is_held():
    motion = torch.randn(2, 10, 3)
    stopped = held(motion, np.array([10, 4]))
    assert torch.equal(stopped[0], motion[0])
    assert torch.equal(stopped[1, :4], motion[1, :4])
    assert torch.equal(stopped[1, 3:], motion[1, 3].expand(7, 3))


def test_half_windows_that_leave_their_clip_have_no_code():
    torch.manual_seed(0)
    nets = FeatureNets(TEACHING_FEATURES).eval()
    motion = torch.randn(3, 176, 288)
    seen = look(nets, motion, np.array([176, 175, 230]))
    assert seen.codes["all"].shape == (5, 32)
    expected = nets(motion[[0, 1, 2, 0, 2]].unflatten(1, (2, 88))[[*range(5)], [0, 0, 0, 1, 1]])
    assert np.allclose(seen.codes["face"], expected["face"].detach().numpy(), atol=1e-5)
    assert seen.nine.shape == (3, 176, 9, 3)


def with_jump(rng, at, size):
    real = np.cumsum(rng.normal(0, 0.01, (1, 40, 9, 3)), axis=1)
    made = real.copy()
    made[:, at:, :, 0] += size
    return real, made, np.arange(40)[None] < at


def test_a_jump_at_the_border_counts_as_the_two_accelerations_it_makes(rng):
    errors = border_errors(*with_jump(rng, 20, 0.01))
    assert errors == pytest.approx(2 * 0.01 * 900 / 4)  # of the four frames around it


def test_what_happens_elsewhere_is_no_affair_of_the_border(rng):
    real, made, known = with_jump(rng, 20, 0.0)
    made[:, 23:] += rng.normal(size=made[:, 23:].shape)
    assert border_errors(real, made, known) == pytest.approx(0)


@pytest.mark.parametrize("at", [1, 2, 38, 39])
def test_a_border_near_an_end_has_fewer_frames_but_no_others(rng, at):
    real, made, known = with_jump(rng, at, 0.0)
    far = np.abs(np.arange(40) - at + 0.5) > 6
    made[:, far] += rng.normal(size=made[:, far].shape)
    assert border_errors(real, made, known) == pytest.approx(0)


@pytest.mark.parametrize("at", [0, 40])
def test_without_a_border_there_is_no_error(rng, at):
    real, made, known = with_jump(rng, 20, 0.01)
    both = np.concatenate([known, np.arange(40)[None] < at])
    with pytest.raises(ValueError, match="clip 1 has none"):
        border_errors(real.repeat(2, axis=0), made.repeat(2, axis=0), both)


def test_wrists_that_move_together_agree_and_those_in_turn_disagree():
    speed = 0.02 * (1 + np.sin(np.arange(60) / 4))
    joints = np.zeros((3, 60, 55, 3))
    joints[0, :, WRISTS, 0] = np.cumsum(speed)
    joints[1, :, WRISTS[0], 0] = np.cumsum(speed)
    joints[1, :, WRISTS[1], 1] = np.cumsum(0.04 - speed)
    joints[2, :, WRISTS[0], 0] = np.cumsum(speed)
    assert wrist_agreement([*joints]) == pytest.approx([1, -1, 0], abs=1e-6)
