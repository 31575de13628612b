"""Rotations in the three forms the papers use: axis-angle, matrix, and six numbers.

Paper:    PT A.2, AM C.2 (6D rotations of SMPL-X joints)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn.functional import normalize


def _sinc(angle: Tensor) -> Tensor:
    """sin(x) / x, one at zero, with a finite gradient there."""
    return torch.sinc(angle / torch.pi)


def _cross_matrix(v: Tensor) -> Tensor:
    """The matrix K for which K u is the cross product of v and u."""
    x, y, z = v.unbind(-1)
    zero = torch.zeros_like(x)
    return torch.stack([zero, -z, y, z, zero, -x, -y, x, zero], dim=-1).unflatten(-1, (3, 3))


def axis_angle_to_matrix(axis_angle: Float[Tensor, "*b 3"]) -> Float[Tensor, "*b 3 3"]:
    """Rodrigues' formula: turn by |v| radians about the axis v / |v|.

    Written on v itself, so that nothing is divided by the angle and the gradient is finite at
    zero: R = I + sin(a)/a K + (1 - cos(a))/a^2 K^2 with a = |v|.
    """
    angle = torch.linalg.vector_norm(axis_angle, dim=-1)[..., None, None]
    K = _cross_matrix(axis_angle)
    identity = torch.eye(3, dtype=K.dtype, device=K.device)
    return identity + _sinc(angle) * K + _sinc(angle / 2).square() / 2 * (K @ K)


def _matrix_to_quaternion(matrix: Tensor) -> Tensor:
    """The unit quaternion (w, x, y, z) of a rotation, with w >= 0.

    The outer product 4 q q^T is linear in R. Each of its rows is a multiple of q; the row with the
    largest diagonal entry is never short, so normalising it is safe at every angle.
    """
    (a, b, c), (d, e, f), (g, h, i) = (row.unbind(-1) for row in matrix.unbind(-2))
    outer = torch.stack(
        [
            *(1 + a + e + i, h - f, c - g, d - b),
            *(h - f, 1 + a - e - i, b + d, c + g),
            *(c - g, b + d, 1 - a + e - i, f + h),
            *(d - b, c + g, f + h, 1 - a - e + i),
        ],
        dim=-1,
    ).unflatten(-1, (4, 4))
    longest = outer.diagonal(dim1=-2, dim2=-1).argmax(dim=-1)[..., None, None]
    quaternion = normalize(outer.take_along_dim(longest, dim=-2).squeeze(-2), dim=-1)
    return torch.where(quaternion[..., :1] < 0, -quaternion, quaternion)


def matrix_to_axis_angle(matrix: Float[Tensor, "*b 3 3"]) -> Float[Tensor, "*b 3"]:
    """Axis times angle in radians, the angle in [0, pi]; at pi either of the two axes is right.

    With the quaternion q = (cos(a/2), sin(a/2) axis) the answer is 2 (a/2) / sin(a/2) times the
    vector part of q, and sin(x) / x is never near zero for half angles up to pi / 2.
    """
    w, vector = _matrix_to_quaternion(matrix).split([1, 3], dim=-1)
    half_angle = torch.atan2(torch.linalg.vector_norm(vector, dim=-1, keepdim=True), w)
    return 2 * vector / _sinc(half_angle)


def matrix_to_sixd(matrix: Float[Tensor, "*b 3 3"]) -> Float[Tensor, "*b 6"]:
    """The first two ROWS, one after the other: a form without jumps, fit for a network's output.

    Zhou et al. (2019), who proposed it, keep two columns; both papers' code keeps rows.
    """
    return matrix[..., :2, :].flatten(-2)


def sixd_to_matrix(sixd: Float[Tensor, "*b 6"]) -> Float[Tensor, "*b 3 3"]:
    """Gram-Schmidt: make any two rows orthonormal; their cross product is the third."""
    a1, a2 = sixd.unflatten(-1, (2, 3)).unbind(-2)
    b1 = normalize(a1, dim=-1)
    b2 = normalize(a2 - (b1 * a2).sum(-1, keepdim=True) * b1, dim=-1)
    return torch.stack([b1, b2, torch.linalg.cross(b1, b2)], dim=-2)
