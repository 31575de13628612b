import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.nn import functional as F

from s2glib.layers import ContextBlock, ResidualConv, TimeResampling
from s2glib.layers.temporal_conv import interpolation_matrix


@pytest.mark.parametrize("frames", [1, 2, 9])
def test_a_context_block_is_a_width_3_convolution(frames):
    torch.manual_seed(0)
    block = ContextBlock(8).eval()
    kernel = block.mix.weight.unflatten(1, (3, 8)).permute(0, 2, 1)  # out, in, neighbour
    x = torch.randn(2, frames, 8)
    h = F.gelu(block.norm(x)).mT
    expected = x + F.conv1d(h, kernel, block.mix.bias, padding=1).mT
    torch.testing.assert_close(block(x), expected)


def test_a_context_block_listens_to_its_condition():
    torch.manual_seed(0)
    block = ContextBlock(8, condition=4).eval()
    x = torch.randn(1, 5, 8)
    assert (block(x, torch.ones(1, 4)) - block(x, -torch.ones(1, 4))).abs().max() > 0.01


@pytest.mark.parametrize("dilation", [1, 2, 3])
def test_a_residual_convolution_starts_as_the_identity(dilation):
    x = torch.randn(2, 16, 11)
    assert torch.equal(ResidualConv(16, dilation)(x), x)


def test_a_residual_convolution_sees_as_far_as_its_dilation():
    torch.manual_seed(0)
    conv = ResidualConv(8, dilation=3)
    torch.nn.init.ones_(conv.out.weight)
    conv.norm = torch.nn.Identity()  # which looks at all of time
    x = torch.randn(1, 8, 21)
    moved = x.clone()
    moved[..., 10] += 1
    seen = (conv(moved) - conv(x)).abs().amax(dim=(0, 1)) > 1e-7
    assert seen.nonzero().flatten().tolist() == [7, 10, 13]


@given(st.integers(1, 40), st.integers(1, 40))
def test_interpolation_rows_are_weights(n_out, n_in):
    matrix = interpolation_matrix(n_out, n_in)
    assert (matrix >= 0).all()
    torch.testing.assert_close(matrix.sum(dim=1), torch.ones(n_out))


@pytest.mark.parametrize(("n_out", "n_in"), [(7, 7), (16, 8), (88, 32), (5, 2)])
def test_stretching_starts_as_torchs_linear_interpolation(n_out, n_in):
    track = torch.randn(1, 3, n_in)
    expected = F.interpolate(track, n_out, mode="linear", align_corners=False)
    torch.testing.assert_close(track @ interpolation_matrix(n_out, n_in).T, expected)


@pytest.mark.parametrize(("n_out", "n_in"), [(8, 16), (32, 88), (2, 5)])
def test_squeezing_starts_as_torchs_antialiased_interpolation(n_out, n_in):
    track = torch.randn(1, 3, 1, n_in)
    expected = F.interpolate(
        track, (1, n_out), mode="bilinear", align_corners=False, antialias=True
    )[:, :, 0]
    torch.testing.assert_close(track[:, :, 0] @ interpolation_matrix(n_out, n_in).T, expected)


def test_resampling_starts_near_interpolation_and_mixes_its_matrices():
    torch.manual_seed(0)
    resample = TimeResampling(12, 6, condition=3, matrices=4)
    x, condition = torch.randn(2, 6, 5), torch.randn(2, 3)
    plain = interpolation_matrix(12, 6) @ x
    assert (resample(x, condition) - plain).abs().max() < 0.3
    shares = resample.choose(condition).softmax(-1)
    for clip in range(2):
        mixed = sum(share * m for share, m in zip(shares[clip], resample.matrices, strict=True))
        torch.testing.assert_close(resample(x, condition)[clip], mixed @ x[clip])
