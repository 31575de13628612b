import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from s2glib.body import (
    JOINT_NAMES,
    BodyModel,
    Motion,
    forward_kinematics,
    joint_positions,
    mannequin,
    read_bvh,
    write_bvh,
)

HIERARCHY = """HIERARCHY
ROOT Hips
{
  OFFSET 0 1 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest Bone
  {
    OFFSET 0 2 0
    CHANNELS 3 Yrotation Xrotation Zrotation
    End Site
    {
      OFFSET 0 3 0
    }
  }
}
"""
MOTION = "MOTION\nFrames: 2\nFrame Time: 0.033333\n1 2 3 10 20 30 40 50 60\n0 0 0 0 0 0 0 0 0\n"


@pytest.fixture(scope="module")
def body() -> BodyModel:
    return mannequin()


@pytest.fixture
def read(tmp_path):
    """Read a text as if it stood in a file."""

    def from_text(text: str, **encoding):
        path = tmp_path / "motion.bvh"
        path.write_bytes(text.encode(**encoding))
        return read_bvh(path)

    return from_text


def random_motion(frames: int = 5, fps: float = 30, seed: int = 0) -> Motion:
    generator = torch.Generator().manual_seed(seed)
    poses = torch.randn(frames, 55, 3, generator=generator)
    trans = torch.randn(frames, 3, generator=generator)
    return Motion(poses, trans, torch.zeros(frames, 100), fps)


def test_names_tree_and_places_are_read(read):
    bvh = read(HIERARCHY + MOTION)
    assert bvh.names == ("Hips", "Chest Bone")
    assert bvh.parents == (-1, 0)
    assert bvh.offsets.tolist() == [[0, 1, 0], [0, 2, 0]]
    assert bvh.root.tolist() == [[1, 2, 3], [0, 0, 0]]
    assert bvh.fps == 30


def test_rotations_agree_with_scipy(read):
    turns = read(HIERARCHY + MOTION).rotations[0].numpy()
    hips = Rotation.from_euler("ZXY", [10, 20, 30], degrees=True).as_matrix()
    chest = Rotation.from_euler("YXZ", [40, 50, 60], degrees=True).as_matrix()
    np.testing.assert_allclose(turns, [hips, chest], atol=1e-6)


@pytest.mark.parametrize("order", ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"])
def test_any_order_of_rotations_is_understood(read, order):
    channels = " ".join(f"{axis}rotation" for axis in order)
    text = HIERARCHY.replace("Yrotation Xrotation Zrotation", channels) + MOTION
    expected = Rotation.from_euler(order, [40, 50, 60], degrees=True).as_matrix()
    np.testing.assert_allclose(read(text).rotations[0, 1].numpy(), expected, atol=1e-6)


def test_positions_may_follow_rotations(read):
    mixed = "Zrotation Yposition Xrotation Xposition Yrotation Zposition"
    text = HIERARCHY.replace("Xposition Yposition Zposition Zrotation Xrotation Yrotation", mixed)
    bvh = read(text + MOTION.replace("1 2 3 10 20 30", "10 2 20 1 30 3"))
    plain = read(HIERARCHY + MOTION)
    assert torch.equal(bvh.root, plain.root)
    assert torch.equal(bvh.rotations, plain.rotations)


def test_a_root_without_positions_stands_at_its_offset(read):
    text = HIERARCHY.replace("6 Xposition Yposition Zposition", "3")
    bvh = read(text + MOTION.replace("1 2 3 10", "10").replace("0 0 0 0 0 0 0 0 0", "0 0 0 0 0 0"))
    assert bvh.root.tolist() == [[0, 1, 0], [0, 1, 0]]


def test_positions_of_other_joints_are_read_over(read):
    text = HIERARCHY.replace("3 Yrotation", "6 Xposition Yposition Zposition Yrotation")
    bvh = read(
        text
        + MOTION.replace("30 40", "30 7 8 9 40").replace(
            "0 0 0 0 0 0 0 0 0", "0 0 0 0 0 0 1 2 3 0 0 0"
        )
    )
    assert torch.equal(bvh.rotations, read(HIERARCHY + MOTION).rotations)


@pytest.mark.parametrize("end", ["\r\n", "\r", "\n\n", "\t\n"])
def test_line_ends_do_not_matter(read, end):
    bvh = read((HIERARCHY + MOTION).replace("\n", end))
    assert torch.equal(bvh.rotations, read(HIERARCHY + MOTION).rotations)


def test_braces_case_scientific_notation_and_a_byte_order_mark_are_understood(read):
    text = (HIERARCHY + MOTION).replace("Hips\n{", "Hips {").replace("Zrotation", "ZROTATION")
    text = text.replace("1 2 3 10", "1e0 +2.0E+00 .3e1 1000e-2")
    bvh = read(text, encoding="utf-8-sig")
    assert torch.equal(bvh.root, read(HIERARCHY + MOTION).root)
    assert torch.equal(bvh.rotations, read(HIERARCHY + MOTION).rotations)


@pytest.mark.parametrize(
    ("seconds", "fps"),
    [("0.033333", 30), ("0.0333333", 30), ("0.04", 25), (".008333", 120), ("0.0333667", 29.97)],
)
def test_rounded_frame_times_give_the_rate_that_was_meant(read, seconds, fps):
    bvh = read(HIERARCHY + MOTION.replace("0.033333", seconds))
    assert bvh.fps == pytest.approx(fps, rel=1e-6 if fps == int(fps) else 1e-4)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("HIERARCHY", "HIERARCH", "line 1: expected HIERARCHY, got 'HIERARCH'"),
        ("ROOT", "JOINT", "line 2: expected ROOT, got 'JOINT'"),
        ("OFFSET 0 1 0", "OFFSET 0 1", "line 5: expected numbers, got something else"),
        ("CHANNELS 6", "CHANNELS six", "line 5: expected a whole number, got 'six'"),
        ("CHANNELS 6", "CHANNELS 7", r"line 6: expected Xposition or .* got 'JOINT'"),
        ("Yrotation\n", "Zrotation\n", "line 5: Hips has a channel twice"),
        ("3 Yrotation", "3 Wrotation", r"line 9: expected Xposition or .* got 'Wrotation'"),
        ("End Site", "End", "line 11: expected Site, got '{'"),
        ("  }\n}\n", "  }\n", "line 15: expected JOINT or End or }, got 'MOTION'"),
        ("MOTION", "ROOT", "line 16: expected MOTION, got 'ROOT'"),
        ("Frames: 2", "Frames: 3", "line 20: expected 3 frames"),
        ("Frames: 2", "Frames: -2", "line 17: expected a whole number, got '-2'"),
        ("Time: 0.033333", "Time: 0", "line 18: expected a frame time above zero"),
        ("0.033333", "0.033333 5", "line 18: expected the end of the line, got '5'"),
        ("50 60", "50", "line 19: expected 9 numbers, got 8"),
        ("50 60", "50 sixty", "line 19: expected numbers"),
        ("50 60", "50 nan", "line 19: expected finite numbers"),
    ],
)
def test_a_malformed_file_is_refused_with_its_line(read, old, new, complaint):
    text = (HIERARCHY + MOTION).replace(old, new, 1)
    with pytest.raises(ValueError, match=complaint):
        read(text)


def test_a_file_without_frames_is_refused(read):
    with pytest.raises(ValueError, match="at least one"):
        read(HIERARCHY + "MOTION\nFrames: 0\nFrame Time: 0.1\n")


@given(cut=st.integers(min_value=0, max_value=len(HIERARCHY + MOTION) - 20))
def test_a_file_that_was_cut_short_is_refused(tmp_path_factory, cut):
    path = tmp_path_factory.getbasetemp() / "cut.bvh"
    path.write_text((HIERARCHY + MOTION)[:cut])
    with pytest.raises(ValueError, match=r"cut\.bvh, line \d+"):
        read_bvh(path)


def test_a_file_of_bytes_is_refused(tmp_path):
    (tmp_path / "noise.bvh").write_bytes(bytes(range(256)))
    with pytest.raises(ValueError, match="is no text"):
        read_bvh(tmp_path / "noise.bvh")


@pytest.mark.parametrize("fps", [25, 30, 29.97, 120])
def test_a_motion_survives_the_round_trip(body, tmp_path, fps):
    motion = random_motion(fps=fps)
    write_bvh(tmp_path / "motion.bvh", motion, body)
    bvh = read_bvh(tmp_path / "motion.bvh")
    rest = torch.zeros(55, 3)
    for number, parent in enumerate(bvh.parents):
        rest[number] = bvh.offsets[number] + (rest[parent] if parent >= 0 else 0)
    positions = forward_kinematics(bvh.rotations, rest, bvh.parents).positions
    positions = positions + bvh.root[:, None]
    order = [bvh.names.index(name) for name in JOINT_NAMES]
    torch.testing.assert_close(
        positions[:, order], joint_positions(motion, body), atol=1e-4, rtol=0
    )
    assert bvh.fps == pytest.approx(fps, rel=1e-8)


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_turn_by_a_right_angle_about_x_survives(body, tmp_path, sign):
    motion = random_motion()
    poses = torch.zeros_like(motion.poses)
    poses[:, :, 0] = sign * math.pi / 2
    write_bvh(tmp_path / "x.bvh", Motion(poses, motion.trans, motion.expression, 30), body)
    expected = Rotation.from_rotvec([sign * math.pi / 2, 0, 0]).as_matrix()
    turns = read_bvh(tmp_path / "x.bvh").rotations.numpy()
    np.testing.assert_allclose(turns, np.broadcast_to(expected, turns.shape), atol=1e-6)


def test_our_roots_have_no_offset_so_that_all_readers_agree(body, tmp_path):
    moved = BodyModel(
        body.vertices,
        body.faces,
        body.weights,
        body.joints + torch.tensor([1.0, 2, 3]),
        body.parents,
    )
    motion = random_motion()
    write_bvh(tmp_path / "motion.bvh", motion, moved)
    bvh = read_bvh(tmp_path / "motion.bvh")
    assert bvh.offsets[0].tolist() == [0, 0, 0]
    torch.testing.assert_close(bvh.root, joint_positions(motion, moved)[:, 0], atol=1e-5, rtol=0)


def test_another_skeleton_is_refused(tmp_path):
    joints = torch.zeros(2, 3)
    stick = BodyModel(joints, torch.zeros(0, 3, dtype=torch.int64), torch.eye(2), joints, (-1, 0))
    with pytest.raises(ValueError, match="55 joints, the body 2"):
        write_bvh(tmp_path / "stick.bvh", random_motion(), stick)
    assert list(tmp_path.iterdir()) == []


def test_a_long_motion_is_written_block_by_block(body, tmp_path, monkeypatch):
    motion = random_motion()
    write_bvh(tmp_path / "whole.bvh", motion, body)
    monkeypatch.setattr("s2glib.body.bvh.BLOCK", 2)
    write_bvh(tmp_path / "blocks.bvh", motion, body)
    assert (tmp_path / "blocks.bvh").read_text() == (tmp_path / "whole.bvh").read_text()
