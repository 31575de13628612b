import functools
from dataclasses import replace

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from smplx.lbs import lbs
from torch.autograd import gradcheck

from s2glib.body import PARENTS, BodyModel, axis_angle_to_matrix, linear_blend_skinning

JOINTS = 55
identity = torch.eye(3, dtype=torch.float64).expand(JOINTS, 3, 3)
origin = torch.zeros(3, dtype=torch.float64)


@functools.cache
def random_body(vertices=70, parents=PARENTS, shape=6, face=4, seed=0):
    """A body with everything that a body can have, in no sensible shape."""
    joints = len(parents)
    generator = torch.Generator().manual_seed(seed)

    def normal(*size):
        return torch.randn(*size, dtype=torch.float64, generator=generator)

    surface, regressor = normal(vertices, 3), normal(joints, vertices).softmax(-1)
    return BodyModel(
        vertices=surface,
        faces=torch.arange(12).reshape(4, 3),
        weights=normal(vertices, joints).mul(3).softmax(-1),
        joints=regressor @ surface,
        parents=parents,
        colors=normal(vertices, 3).sigmoid(),
        shape_directions=normal(vertices, 3, shape),
        expression_directions=normal(vertices, 3, face),
        pose_directions=normal(vertices, 3, 9 * (joints - 1)) / 10,
        joint_regressor=regressor,
    )


def distances(points):
    return torch.cdist(points, points)


def random_pose(*batch, joints=JOINTS, seed=1):
    generator = torch.Generator().manual_seed(seed)
    axis_angle = torch.randn(*batch, joints, 3, dtype=torch.float64, generator=generator)
    return axis_angle_to_matrix(axis_angle)


def peer(body, rotations, coefficients):
    directions = torch.cat([body.shape_directions, body.expression_directions], dim=-1)
    return lbs(
        betas=coefficients,
        pose=rotations,
        v_template=body.vertices,
        shapedirs=directions,
        posedirs=body.pose_directions.flatten(0, 1).T,
        J_regressor=body.joint_regressor,
        parents=torch.tensor(body.parents),
        lbs_weights=body.weights,
        pose2rot=False,
    )


@pytest.mark.parametrize(("dtype", "tolerance"), [(torch.float64, 1e-8), (torch.float32, 1e-5)])
def test_skinning_agrees_with_smplx(dtype, tolerance, generator):
    body, rotations = random_body().to(dtype), random_pose(5).to(dtype)
    coefficients = torch.randn(5, 10, dtype=dtype, generator=generator)
    betas, expression = coefficients.split([6, 4], dim=-1)
    still = torch.zeros(5, 3, dtype=dtype)
    ours = linear_blend_skinning(body, rotations, still, betas=betas, expression=expression)
    vertices, joints = peer(body, rotations, coefficients)
    scale = vertices.abs().max().item()
    torch.testing.assert_close(ours.vertices, vertices, atol=tolerance * scale, rtol=0.0)
    torch.testing.assert_close(ours.joints, joints, atol=tolerance * scale, rtol=0.0)


def test_identity_pose_is_the_rest_pose():
    body = random_body()
    ours = linear_blend_skinning(body, identity, origin)
    torch.testing.assert_close(ours.vertices, body.vertices)
    torch.testing.assert_close(ours.joints, body.joints)


@settings(max_examples=20)
@given(st.integers(0, 1000))
def test_turning_the_root_turns_the_whole_body_about_it(seed):
    body, pose, turn = random_body(), random_pose(), random_pose(joints=1, seed=seed)[0]
    turned = torch.cat([(turn @ pose[0])[None], pose[1:]])
    before = linear_blend_skinning(body, pose, -body.joints[0])
    after = linear_blend_skinning(body, turned, -body.joints[0])
    torch.testing.assert_close(after.vertices, before.vertices @ turn.T)
    torch.testing.assert_close(after.joints, before.joints @ turn.T)


@settings(max_examples=20)
@given(st.lists(st.floats(-5, 5), min_size=3, max_size=3))
def test_trans_moves_everything(trans):
    body, pose, step = random_body(), random_pose(), torch.tensor(trans, dtype=torch.float64)
    before = linear_blend_skinning(body, pose, origin)
    after = linear_blend_skinning(body, pose, step)
    torch.testing.assert_close(after.vertices, before.vertices + step)
    torch.testing.assert_close(after.joints, before.joints + step)


def test_a_vertex_of_one_joint_moves_rigidly_with_it():
    body = replace(
        random_body(),
        weights=torch.eye(JOINTS, dtype=torch.float64)[[20] * 70],
        pose_directions=None,
    )
    vertices = linear_blend_skinning(body, random_pose(), origin).vertices
    torch.testing.assert_close(distances(vertices), distances(body.vertices))


def test_a_batch_is_its_frames_one_by_one(generator):
    body, rotations = random_body(), random_pose(2, 3)
    trans = torch.randn(2, 3, 3, dtype=torch.float64, generator=generator)
    betas = torch.randn(2, 1, 6, dtype=torch.float64, generator=generator)
    together = linear_blend_skinning(body, rotations, trans, betas=betas)
    for i, j in [(0, 0), (1, 2)]:
        alone = linear_blend_skinning(body, rotations[i, j], trans[i, j], betas=betas[i, 0])
        torch.testing.assert_close(together.vertices[i, j], alone.vertices)
        torch.testing.assert_close(together.joints[i, j], alone.joints)


@settings(max_examples=12)
@given(st.integers(1, 6), st.booleans())
def test_missing_coefficients_are_zero(given_number, regress):
    body = random_body() if regress else replace(random_body(), joint_regressor=None)
    betas = torch.linspace(-1, 1, given_number, dtype=torch.float64)
    padded = torch.cat([betas, torch.zeros(6 - given_number, dtype=torch.float64)])
    ours = linear_blend_skinning(body, random_pose(), origin, betas=betas)
    full = linear_blend_skinning(body, random_pose(), origin, betas=padded)
    torch.testing.assert_close(ours.vertices, full.vertices)


def test_joints_follow_the_shape_only_through_a_regressor():
    body, betas = random_body(), torch.ones(6, dtype=torch.float64)
    fixed = replace(body, joint_regressor=None)
    shaped = body.vertices + body.shape_directions.sum(-1)
    moved = linear_blend_skinning(body, identity, origin, betas=betas)
    stayed = linear_blend_skinning(fixed, identity, origin, betas=betas)
    torch.testing.assert_close(moved.joints, body.joint_regressor @ shaped)
    torch.testing.assert_close(stayed.joints, body.joints)
    torch.testing.assert_close(stayed.vertices, shaped)


def test_gradients(generator):
    body = random_body(vertices=12, parents=(-1, 0, 1, 1), shape=2, face=2)

    def skin(axis_angle, trans, betas, expression):
        rotations = axis_angle_to_matrix(axis_angle)
        return linear_blend_skinning(body, rotations, trans, betas=betas, expression=expression)

    sizes = [(2, 4, 3), (2, 3), (2, 2), (2, 2)]
    inputs = [torch.randn(s, dtype=torch.float64, generator=generator) for s in sizes]
    assert gradcheck(skin, [value.requires_grad_() for value in inputs])


@pytest.mark.parametrize("name", ["betas", "expression"])
def test_more_coefficients_than_directions_are_refused(name):
    too_many = {name: torch.zeros(7, dtype=torch.float64)}
    with pytest.raises(ValueError, match=rf"knows \d {name}, got 7"):
        linear_blend_skinning(random_body(), identity, origin, **too_many)
    bare = replace(random_body(), shape_directions=None, expression_directions=None)
    with pytest.raises(ValueError, match=f"knows 0 {name}"):
        linear_blend_skinning(bare, identity, origin, **too_many)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("vertices", torch.zeros(70, 2), r"vertices must be \(any, 3\), got \(70, 2\)"),
        ("faces", torch.zeros(4, 4, dtype=torch.int64), r"faces must be \(any, 3\)"),
        ("faces", torch.full((4, 3), 70), "faces must name vertices 0 to 69"),
        ("faces", torch.full((4, 3), -1), "faces must name vertices 0 to 69"),
        ("weights", torch.zeros(70, 54), r"weights must be \(70, 55\)"),
        ("joints", torch.zeros(54, 3), "one parent for each of 54 joints"),
        ("parents", (0, *PARENTS[1:]), "joint 0 has parent 0"),
        ("colors", torch.zeros(70), r"colors must be \(70, 3\)"),
        ("shape_directions", torch.zeros(3, 70, 6), r"shape_directions must be \(70, 3, any\)"),
        ("expression_directions", torch.zeros(70, 3), "expression_directions must be"),
        ("pose_directions", torch.zeros(70, 3, 495), r"pose_directions must be \(70, 3, 486\)"),
        ("joint_regressor", torch.zeros(70, 55), r"joint_regressor must be \(55, 70\)"),
    ],
)
def test_bodies_whose_parts_do_not_fit_are_refused(name, value, message):
    with pytest.raises(ValueError, match=message):
        replace(random_body(), **{name: value})


def test_a_body_changes_its_floats_and_keeps_its_faces():
    body = random_body().to(torch.float32)
    assert body.vertices.dtype == body.joint_regressor.dtype == torch.float32
    assert body.faces.dtype == torch.int64
