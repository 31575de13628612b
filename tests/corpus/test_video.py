from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from s2glib.body.motion import Motion
from s2glib.body.rotations import axis_angle_to_matrix
from s2glib.body.skeleton import FACE_CURVES, JOINT_NAMES, PELVIS_HEIGHT, joint
from s2glib.corpus.appearance import HELD_OUT, appearances
from s2glib.corpus.puppet.drawing import Part
from s2glib.corpus.puppet.pose import KEYPOINT_NAMES, OWN_PARTS
from s2glib.corpus.video import Video, render_frames, render_video, resample_motion
from s2glib.data.samples import Clip

LOOK = appearances("voice_01")[0]
DOWN = {"left_shoulder": (0.0, 0.0, -1.2), "right_shoulder": (0.0, 0.0, 1.2)}


def pose(frames=1, *, fps=25.0, curves=None, trans=(0.0, PELVIS_HEIGHT, 0.0), **joints) -> Motion:
    """A body that stands still with its arms down, some joints turned, some curves pulled."""
    poses, expression = torch.zeros(frames, 55, 3), torch.zeros(frames, 100)
    for name, turn in (DOWN | joints).items():
        poses[:, joint(name)] = torch.tensor(turn)
    for name, value in (curves or {}).items():
        expression[:, FACE_CURVES.index(name)] = value
    return Motion(poses, torch.tensor(trans).repeat(frames, 1), expression, fps)


def bent(left: float, right: float) -> dict:
    """Elbows bent so that the hands come forward and up."""
    return {"left_elbow": (0.0, -left, 0.0), "right_elbow": (0.0, right, 0.0)}


def mirrored(motion: Motion) -> Motion:
    swap = {"left": "right", "right": "left"}
    names = [
        swap.get(n.split("_")[0], n.split("_")[0]) + n[len(n.split("_")[0]) :] for n in JOINT_NAMES
    ]
    poses = motion.poses[:, [JOINT_NAMES.index(n) for n in names]] * torch.tensor([1.0, -1.0, -1.0])
    return replace(motion, poses=poses, trans=motion.trans * torch.tensor([-1.0, 1.0, 1.0]))


def pixel(video: Video, name: str) -> np.ndarray:
    """Where a keypoint of the first frame is, in pixels from the centre of the first one."""
    return (video.keypoints[0, KEYPOINT_NAMES.index(name)] + 1) / 2 * (video.parts.shape[-1] - 1)


def centroid(mask: np.ndarray) -> np.ndarray:
    rows, columns = np.nonzero(mask)
    return np.array([columns.mean(), rows.mean()])


def grow(mask: np.ndarray) -> np.ndarray:
    """A mask and its neighbouring pixels: anti-aliased edges bleed by one."""
    padded = np.pad(mask, 1)
    shifts = [np.roll(padded, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return np.any(shifts, axis=0)[1:-1, 1:-1]


@pytest.mark.parametrize("size", [64, 100, 256])
def test_a_film_has_the_size_that_was_asked_for(size):
    video = render_frames(pose(2), LOOK, size)
    assert video.frames.shape == (2, size, size, 3)
    assert video.parts.shape == (2, size, size)
    assert video.keypoints.shape == (2, 55, 2)
    assert video.visible.shape == (2, 55)


def test_the_same_motion_gives_the_same_bytes():
    motion = pose(2, **bent(1.0, 1.5))
    first, second = (render_frames(motion, LOOK, 64) for _ in range(2))
    assert first.frames.tobytes() == second.frames.tobytes()
    assert first.parts.tobytes() == second.parts.tobytes()


def test_keypoints_do_not_depend_on_the_size():
    small, large = (render_frames(pose(**bent(1.0, 1.5)), LOOK, size) for size in (64, 256))
    corner = (small.keypoints * 63 + 64) / 128  # share of the picture's width
    np.testing.assert_allclose(corner, (large.keypoints * 255 + 256) / 512, atol=1e-5)


@pytest.mark.parametrize("side", ["left", "right"])
def test_hand_pixels_lie_around_the_hand_keypoints(side):
    video = render_frames(pose(**bent(1.9, 1.9)), LOOK, 128)
    hand = video.parts[0] == Part[f"{side.upper()}_HAND"]
    points = [pixel(video, name) for name in KEYPOINT_NAMES if name.startswith(f"{side}_middle")]
    middle = (pixel(video, f"{side}_wrist") + np.mean(points, axis=0)) / 2
    assert np.linalg.norm(centroid(hand) - middle) < 4


def test_the_face_lies_around_the_nose():
    video = render_frames(pose(), LOOK, 128)
    assert np.linalg.norm(centroid(video.face_mask[0]) - pixel(video, "nose")) < 4


def test_a_visible_keypoint_lies_on_its_own_part():
    video = render_frames(pose(**bent(1.2, 0.6)), LOOK, 128)
    for k in np.flatnonzero(video.visible[0]):
        column, row = np.round(pixel(video, KEYPOINT_NAMES[k])).astype(int)
        assert OWN_PARTS[k, video.parts[0, row, column]], KEYPOINT_NAMES[k]


def test_every_keypoint_of_open_raised_hands_is_visible():
    out_and_down = Rotation.from_euler("z", -0.9)
    palm_to_us = Rotation.from_matrix([[0, 0, -1], [1, 0, 0], [0, -1, 0]])
    left = [r.as_rotvec() for r in (out_and_down, out_and_down.inv() * palm_to_us)]
    joints = {f"left_{name}": tuple(r) for name, r in zip(("shoulder", "elbow"), left, strict=True)}
    joints |= {n.replace("left", "right"): (x, -y, -z) for n, (x, y, z) in joints.items()}
    video = render_frames(pose(**joints), LOOK, 256)
    hidden = [name for name, seen in zip(KEYPOINT_NAMES, video.visible[0], strict=True) if not seen]
    assert hidden == []


def test_a_hand_behind_the_back_is_hidden():
    back = tuple(Rotation.from_euler("XZ", [0.8, -1.35]).as_rotvec())
    video = render_frames(pose(left_shoulder=back, left_elbow=(0.0, 0.0, -1.75)), LOOK, 128)
    shown = render_frames(pose(**bent(1.9, 0.0)), LOOK, 128)
    tip = KEYPOINT_NAMES.index("left_middle_tip")
    assert not video.visible[0, tip]
    assert shown.visible[0, tip]
    assert (video.parts == Part.LEFT_HAND).sum() < (shown.parts == Part.LEFT_HAND).sum() / 3


def test_a_hand_outside_the_picture_is_not_visible():
    video = render_frames(pose(left_shoulder=(0.0, 0.0, 0.0)), LOOK, 64)
    wrist = KEYPOINT_NAMES.index("left_wrist")
    assert video.keypoints[0, wrist, 0] > 1
    assert not video.visible[0, wrist]


def test_masks_are_apart_and_inside_the_person():
    video = render_frames(pose(**bent(2.2, 2.0)), LOOK, 64)
    assert not (video.hand_mask & video.face_mask).any()
    assert (video.person_mask | ~(video.hand_mask | video.face_mask)).all()
    assert 0.2 < video.person_mask.mean() < 0.6


def test_what_is_no_person_is_the_same_wall_in_every_frame():
    motions = pose(), pose(**bent(1.9, 0.4))
    first, second = (render_frames(motion, LOOK, 64) for motion in motions)
    wall = ~grow(first.person_mask[0] | second.person_mask[0])
    assert np.array_equal(first.frames[0][wall], second.frames[0][wall])


@pytest.mark.parametrize(
    "change", [{"jaw": (0.3, 0.0, 0.0)}, *({"curves": {c: 1.0}} for c in FACE_CURVES)], ids=str
)
def test_the_face_moves_without_the_rest(change):
    still, moved = (render_frames(pose(**c), LOOK, 128) for c in ({}, change))
    differs = (still.frames != moved.frames).any(axis=-1)[0]
    assert differs.any()
    assert not (differs & ~grow(still.face_mask[0] | moved.face_mask[0])).any()


def test_opening_the_jaw_lowers_the_chin():
    still, moved = (render_frames(pose(jaw=(a, 0.0, 0.0)), LOOK, 256) for a in (0.0, 0.3))
    lowest = [np.flatnonzero(video.face_mask[0].any(axis=1)).max() for video in (still, moved)]
    assert lowest[1] > lowest[0] + 2


def test_a_mirrored_motion_gives_mirrored_keypoints():
    motion = pose(**bent(1.9, 0.7), head=(0.1, 0.3, 0.1))
    video, image = (render_frames(m, LOOK, 64) for m in (motion, mirrored(motion)))
    swap = str.maketrans({"L": "right", "R": "left"})
    names = [n.replace("left", "L").replace("right", "R").translate(swap) for n in KEYPOINT_NAMES]
    other = image.keypoints[:, [KEYPOINT_NAMES.index(name) for name in names]]
    np.testing.assert_allclose(video.keypoints, other * (-1, 1), atol=1e-5)


def test_a_mirrored_motion_gives_mirrored_hands():
    motion = pose(**bent(1.9, 0.7))
    video, image = (render_frames(m, LOOK, 128) for m in (motion, mirrored(motion)))
    hands, flipped = video.hand_mask, image.hand_mask[..., ::-1]
    assert (hands & flipped).sum() > 0.85 * (hands | flipped).sum()


def test_clothes_change_colours_but_no_keypoints():
    one, other = (render_frames(pose(), look, 64) for look in (LOOK, HELD_OUT))
    assert np.array_equal(one.keypoints, other.keypoints)
    assert (one.frames != other.frames).mean() > 0.5


@given(st.integers(1, 90), st.sampled_from([15.0, 24.0, 25.0, 30.0, 60.0]))
@settings(max_examples=15, deadline=None)
def test_a_film_has_as_many_frames_as_fit_its_duration(frames, fps):
    motion = resample_motion(pose(frames, fps=30.0), fps)
    assert motion.frames == max(1, int(frames * fps / 30 + 1e-9))
    assert motion.fps == fps


def test_resampling_turns_joints_along_the_geodesic():
    rng = np.random.default_rng(0)
    motion = pose(31, fps=30.0)
    motion.poses[:, joint("left_elbow")] = torch.tensor(rng.normal(0, 1, (31, 3))).float()
    turned = resample_motion(motion, 25.0)
    keys = Rotation.from_rotvec(motion.poses[:, joint("left_elbow")].double().numpy())
    expected = Slerp(np.arange(31) / 30, keys)(np.arange(25) / 25).as_matrix()
    ours = axis_angle_to_matrix(turned.poses[:, joint("left_elbow")]).numpy()
    np.testing.assert_allclose(ours, expected, atol=2e-5)


def test_resampling_keeps_times_that_both_rates_share():
    motion = pose(60, fps=30.0)
    motion.trans[:, 0] = torch.arange(60) / 30
    np.testing.assert_allclose(
        resample_motion(motion, 25.0).trans[:, 0], np.arange(50) / 25, atol=1e-5
    )


@given(st.integers(0, 10**6))
@settings(max_examples=8, deadline=None)
def test_any_motion_can_be_filmed(seed):
    rng = np.random.default_rng(seed)
    tracks = [
        rng.normal(0, scale, (3, *shape)) for scale, shape in ((2, (55, 3)), (9, (3,)), (2, (100,)))
    ]
    video = render_frames(Motion(*map(torch.from_numpy, tracks), 25.0), LOOK, 32)
    assert np.isfinite(video.keypoints).all()


def test_a_clip_is_filmed_by_its_motion():
    motion = pose(6, fps=30.0)
    nothing = np.zeros(6)
    clip = Clip(
        "s00-voice_01-neutral-t0",
        0,
        "voice_01",
        "neutral",
        0,
        0.5,
        None,
        motion,
        (),
        (),
        nothing,
        nothing.astype(int),
    )
    video = render_video(clip, LOOK, 64)
    assert len(video.frames) == 5
    assert np.array_equal(video.frames, render_frames(motion, LOOK, 64).frames)


@pytest.mark.parametrize("size", [0, 31, 1025, -64])
def test_a_size_out_of_range_is_refused(size):
    with pytest.raises(ValueError, match="size must be from 32 to 1024"):
        render_frames(pose(), LOOK, size)


@pytest.mark.parametrize("fps", [0.0, -25.0, float("nan"), float("inf")])
def test_a_rate_out_of_range_is_refused(fps):
    with pytest.raises(ValueError, match="fps must be finite and above zero"):
        render_frames(pose(), LOOK, 64, fps)
