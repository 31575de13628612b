"""Labels for keypoints: on the limbs, and mirrored with the picture."""

import torch

from s2glib.corpus import KEYPOINT_NAMES
from s2glib.recipes.limb_points import ASIDE, LIMBS, limb_points, mirrored_keypoints

KEYPOINTS = torch.randn(4, 55, 2, generator=torch.Generator().manual_seed(0))
FOREARM = LIMBS.index(("left_elbow", "left_wrist"))


def at(name):
    return KEYPOINTS[:, KEYPOINT_NAMES.index(name)]


def test_the_middle_of_a_limb_is_one_point_and_its_ends_are_two_each():
    points = limb_points(KEYPOINTS)[:, FOREARM]
    torch.testing.assert_close(points[:, :2].mean(1), at("left_elbow"))
    torch.testing.assert_close(points[:, 2], (at("left_elbow") + at("left_wrist")) / 2)
    torch.testing.assert_close(points[:, 3:].mean(1), at("left_wrist"))


def test_points_abreast_lie_square_to_the_limb():
    points = limb_points(KEYPOINTS)[:, FOREARM]
    apart, limb = points[:, 0] - points[:, 1], at("left_wrist") - at("left_elbow")
    torch.testing.assert_close((apart * limb).sum(-1), torch.zeros(4), atol=1e-5, rtol=0)
    torch.testing.assert_close(apart.norm(dim=-1), torch.full((4,), ASIDE[0] - ASIDE[1]))


def test_a_limb_that_points_at_the_camera_has_points_all_the_same():
    points = limb_points(torch.zeros(55, 2))
    assert torch.equal(points, torch.zeros(8, 5, 2))


def test_unknown_keypoints_leave_only_their_own_limbs_unknown():
    some = KEYPOINTS.clone()
    some[:, KEYPOINT_NAMES.index("left_elbow")] = torch.nan
    known = limb_points(some).isfinite().all(-1).all(-1)[0]
    assert known.tolist() == ["left_elbow" not in limb for limb in LIMBS]


def test_in_the_mirror_left_is_right():
    mirrored = mirrored_keypoints(KEYPOINTS)
    for name in ("nose", "left_wrist", "right_ear", "left_middle_tip", "right_pinky1"):
        other = name if name == "nose" else swap(name)
        there = mirrored[:, KEYPOINT_NAMES.index(other)]
        torch.testing.assert_close(there, at(name) * torch.tensor([-1.0, 1.0]))
    assert torch.equal(mirrored_keypoints(mirrored), KEYPOINTS)


def swap(name):
    side, rest = name.split("_", 1)
    return {"left": "right_", "right": "left_"}[side] + rest
