import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from torch.autograd import gradcheck

from s2glib.body import (
    axis_angle_to_matrix,
    matrix_to_axis_angle,
    matrix_to_sixd,
    sixd_to_matrix,
)

SPECIAL_ANGLES = [0.0, 1e-30, 1e-12, 1e-7, 1e-4, 0.5, 3.0, math.pi - 1e-4, math.pi - 1e-9]
coordinates = st.floats(-10, 10, width=32)
vectors = st.lists(coordinates, min_size=3, max_size=3).map(
    lambda xyz: torch.tensor(xyz, dtype=torch.float64)
)


def axes(count):
    directions = np.random.default_rng(0).normal(size=(count, 3))
    return torch.from_numpy(directions / np.linalg.norm(directions, axis=-1, keepdims=True))


@given(vectors)
def test_axis_angle_to_matrix_agrees_with_scipy(vector):
    expected = Rotation.from_rotvec(vector.numpy()).as_matrix()
    np.testing.assert_allclose(axis_angle_to_matrix(vector), expected, atol=1e-13)


@given(vectors)
def test_matrix_to_axis_angle_agrees_with_scipy(vector):
    matrix = Rotation.from_rotvec(vector.numpy()).as_matrix()
    ours = matrix_to_axis_angle(torch.from_numpy(matrix))
    assert ours.norm() <= math.pi + 1e-12
    np.testing.assert_allclose(Rotation.from_rotvec(ours.numpy()).as_matrix(), matrix, atol=1e-13)


@pytest.mark.parametrize("angle", SPECIAL_ANGLES)
def test_axis_angle_survives_the_round_trip_at_special_angles(angle):
    vectors = axes(50) * angle
    returned = matrix_to_axis_angle(axis_angle_to_matrix(vectors))
    np.testing.assert_allclose(returned, vectors, rtol=1e-12, atol=1e-14)


def test_half_turns_come_back_about_the_same_line():
    vectors = torch.cat([axes(50), torch.eye(3), -torch.eye(3)]) * math.pi
    matrices = Rotation.from_rotvec(vectors.numpy()).as_matrix()
    returned = matrix_to_axis_angle(torch.from_numpy(matrices))
    same_or_opposite = torch.minimum(
        (returned - vectors).norm(dim=-1), (returned + vectors).norm(dim=-1)
    )
    assert same_or_opposite.max() < 1e-12


@pytest.mark.parametrize("angle", [*SPECIAL_ANGLES, math.pi])
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_gradients_are_finite_at_special_angles(angle, dtype):
    vectors = (axes(20) * angle).to(dtype).requires_grad_()
    matrix_to_axis_angle(axis_angle_to_matrix(vectors)).square().sum().backward()
    assert vectors.grad.isfinite().all()
    assert vectors.grad.abs().max() < 10


@pytest.mark.parametrize("angle", SPECIAL_ANGLES)
def test_round_trip_has_the_identity_as_its_derivative(angle):
    vectors = (axes(20) * angle).requires_grad_()
    weights = torch.linspace(-1, 1, 60, dtype=torch.float64).reshape(20, 3)
    (matrix_to_axis_angle(axis_angle_to_matrix(vectors)) * weights).sum().backward()
    torch.testing.assert_close(vectors.grad, weights, atol=1e-7, rtol=0.0)


@pytest.mark.parametrize("angle", [0.0, 1e-4, 1.0, math.pi - 1e-3, 5.0])
def test_gradient_of_axis_angle_to_matrix(angle):
    assert gradcheck(axis_angle_to_matrix, (axes(3) * angle).requires_grad_())


@pytest.mark.parametrize("angle", [0.0, 1e-4, 1.0, math.pi - 1e-3])
def test_gradient_of_matrix_to_axis_angle(angle):
    assert gradcheck(matrix_to_axis_angle, axis_angle_to_matrix(axes(3) * angle).requires_grad_())


def test_gradient_of_gram_schmidt(generator):
    sixd = torch.randn(4, 6, dtype=torch.float64, generator=generator)
    assert gradcheck(sixd_to_matrix, sixd.requires_grad_())


@settings(max_examples=30)
@given(st.lists(st.integers(0, 3), max_size=3), st.sampled_from([torch.float32, torch.float64]))
def test_leading_axes_and_dtype_are_kept(batch, dtype):
    matrix = axis_angle_to_matrix(torch.ones(*batch, 3, dtype=dtype))
    sixd = matrix_to_sixd(matrix)
    assert matrix.shape == (*batch, 3, 3)
    assert sixd.shape == (*batch, 6)
    assert matrix_to_axis_angle(matrix).shape == (*batch, 3)
    assert sixd_to_matrix(sixd).dtype == matrix_to_axis_angle(matrix).dtype == dtype


@given(vectors)
def test_sixd_is_the_first_two_rows_and_gives_the_matrix_back(vector):
    matrix = axis_angle_to_matrix(vector)
    sixd = matrix_to_sixd(matrix)
    assert sixd.tolist() == matrix[0].tolist() + matrix[1].tolist()
    torch.testing.assert_close(sixd_to_matrix(sixd), matrix, atol=1e-13, rtol=0.0)


def test_any_six_numbers_become_a_rotation(generator):
    matrix = sixd_to_matrix(torch.randn(200, 6, dtype=torch.float64, generator=generator))
    identity = torch.eye(3, dtype=torch.float64).expand(200, 3, 3)
    torch.testing.assert_close(matrix @ matrix.mT, identity, atol=1e-12, rtol=0.0)
    torch.testing.assert_close(torch.linalg.det(matrix), identity[:, 0, 0], atol=1e-12, rtol=0.0)


def test_gram_schmidt_keeps_the_first_row_and_the_plane():
    matrix = sixd_to_matrix(torch.tensor([2.0, 0.0, 0.0, 5.0, 3.0, 0.0]))
    torch.testing.assert_close(matrix, torch.eye(3))


@pytest.mark.parametrize("scale", [1e-3, 1.0])
def test_single_precision_is_as_exact_as_it_can_be(scale):
    vectors = (axes(500) * scale).float()
    returned = matrix_to_axis_angle(axis_angle_to_matrix(vectors))
    torch.testing.assert_close(returned, vectors, atol=1e-6 * scale, rtol=1e-6)
