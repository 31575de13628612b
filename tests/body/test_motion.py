from dataclasses import FrozenInstanceError

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.body import (
    PARENTS,
    PELVIS_HEIGHT,
    REST_JOINTS,
    BodyModel,
    Motion,
    joint_positions,
    skin_motion,
)


def tracks(frames=4, dtype=torch.float32):
    generator = torch.Generator().manual_seed(0)
    shapes = {"poses": (55, 3), "trans": (3,), "expression": (100,)}
    return {
        name: torch.randn(frames, *shape, generator=generator).to(dtype)
        for name, shape in shapes.items()
    }


def body(curves=None):
    """A body whose only vertices are its joints; each face curve lifts them by a metre."""
    joints = torch.from_numpy(REST_JOINTS).float()
    lift = None if curves is None else torch.tensor([0.0, 1.0, 0.0])[:, None].expand(55, 3, curves)
    return BodyModel(
        joints,
        torch.zeros(0, 3, dtype=torch.int64),
        torch.eye(55),
        joints,
        PARENTS,
        expression_directions=lift,
    )


@given(st.integers(1, 50), st.sampled_from([24, 25.0, np.float64(30), 120]))
def test_duration_is_frames_over_fps(frames, fps):
    motion = Motion(**tracks(frames), fps=fps)
    assert motion.frames == frames
    assert motion.duration == pytest.approx(frames / float(fps))
    assert type(motion.fps) is float


def test_a_motion_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        Motion(**tracks(), fps=30).fps = 25


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("name", ["poses", "trans", "expression"])
@pytest.mark.parametrize("bad", [float("nan"), float("inf"), float("-inf")])
def test_numbers_that_are_not_finite_are_refused(name, bad):
    given_tracks = tracks()
    given_tracks[name].view(-1)[5] = bad
    with pytest.raises(ValueError, match=f"{name} holds NaN or infinite"):
        Motion(**given_tracks, fps=30)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("name", ["poses", "trans", "expression"])
@pytest.mark.parametrize("shape", [(), (4,), (4, 2), (4, 165), (4, 54, 3), (1, 4, 55, 3)])
def test_wrong_shapes_are_refused(name, shape):
    with pytest.raises(ValueError, match=rf"{name} must be \(frames, "):
        Motion(**{**tracks(), name: torch.zeros(shape)}, fps=30)


@pytest.mark.usefixtures("without_type_hook")
def test_tracks_of_different_lengths_are_refused():
    with pytest.raises(ValueError, match=r"differ in frames: \[4, 3, 4\]"):
        Motion(**{**tracks(), "trans": torch.zeros(3, 3)}, fps=30)


@pytest.mark.usefixtures("without_type_hook")
def test_an_empty_motion_is_refused():
    with pytest.raises(ValueError, match="no frames"):
        Motion(**tracks(0), fps=30)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("fps", [0, -30, float("nan"), float("inf")])
def test_impossible_frame_rates_are_refused(fps):
    with pytest.raises(ValueError, match="fps must be finite and above zero"):
        Motion(**tracks(), fps=fps)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("fps", ["30", None, True, [30]])
def test_frame_rates_that_are_not_numbers_are_refused(fps):
    with pytest.raises(TypeError, match="fps must be a number"):
        Motion(**tracks(), fps=fps)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("value", [np.zeros((4, 3), np.float32), [[0.0] * 3] * 4, None])
def test_what_is_not_a_tensor_is_refused(value):
    with pytest.raises(TypeError, match="trans must be a torch tensor"):
        Motion(**{**tracks(), "trans": value}, fps=30)


@pytest.mark.usefixtures("without_type_hook")
def test_whole_numbers_and_mixed_dtypes_are_refused():
    with pytest.raises(TypeError, match="must hold floats"):
        Motion(**{**tracks(), "trans": torch.zeros(4, 3, dtype=torch.int64)}, fps=30)
    with pytest.raises(TypeError, match="differ in dtype"):
        Motion(**{**tracks(), "trans": torch.zeros(4, 3, dtype=torch.float64)}, fps=30)


def test_the_pelvis_is_where_trans_says():
    motion = Motion(**tracks(), fps=30)
    torch.testing.assert_close(joint_positions(motion, body())[:, 0], motion.trans)


def test_a_standing_body_has_its_soles_just_above_the_floor():
    standing = {**tracks(1), "poses": torch.zeros(1, 55, 3)}
    standing["trans"] = torch.tensor([[0.0, PELVIS_HEIGHT, 0.0]])
    positions = joint_positions(Motion(**standing, fps=30), body())
    assert 0 < positions[..., 1].min() < 0.05


def test_skinned_joints_are_the_joint_positions():
    motion = Motion(**tracks(), fps=30)
    skinned = skin_motion(motion, body())
    torch.testing.assert_close(skinned.joints, joint_positions(motion, body()))
    torch.testing.assert_close(skinned.vertices, skinned.joints)


@pytest.mark.parametrize("curves", [12, 100])
def test_the_face_takes_as_many_curves_as_the_body_knows(curves):
    still = {**tracks(), "poses": torch.zeros(4, 55, 3)}
    skinned = skin_motion(Motion(**still, fps=30), body(curves))
    lift = (skinned.vertices - skinned.joints)[:, 0, 1]
    torch.testing.assert_close(lift, still["expression"][:, :curves].sum(-1), atol=1e-5, rtol=1e-5)


def test_a_long_motion_finds_its_joints_block_by_block(monkeypatch):
    motion = Motion(torch.randn(10, 55, 3), torch.randn(10, 3), torch.zeros(10, 100), fps=30)
    whole = joint_positions(motion, body())
    monkeypatch.setattr("s2glib.body.motion._BLOCK", 3)
    torch.testing.assert_close(joint_positions(motion, body()), whole)
