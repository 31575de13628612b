import numpy as np
import pytest
import torch
from scipy.ndimage import gaussian_filter

from s2glib.layers import DownBlock, Hourglass, ResidualBlock, SameBlock, UpBlock, shrink


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.mark.parametrize(
    ("block", "size"), [(SameBlock, 8), (DownBlock, 4), (UpBlock, 16)], ids=["same", "down", "up"]
)
def test_blocks_keep_halve_and_double(block, size):
    out = block(3, 5)(torch.randn(2, 3, 8, 8))
    assert out.shape == (2, 5, size, size)
    assert (out >= 0).all()


def test_halving_is_the_mean_of_four_pixels():
    block = DownBlock(3, 5)
    x = torch.randn(2, 3, 8, 8)
    quads = block[0](x).reshape(2, 5, 4, 2, 4, 2)
    torch.testing.assert_close(block(x), quads.mean(dim=(3, 5)))


def test_doubling_repeats_pixels_before_it_looks_at_them():
    block = UpBlock(3, 5)
    x = torch.randn(2, 3, 4, 4)
    torch.testing.assert_close(
        block(x), block[1](x.repeat_interleave(2, -1).repeat_interleave(2, -2))
    )


@pytest.mark.parametrize("norm", [torch.nn.InstanceNorm2d, torch.nn.BatchNorm2d])
def test_a_residual_block_adds_to_what_came_in(norm):
    block = ResidualBlock(4, norm)
    x = torch.randn(2, 4, 8, 8)
    assert not torch.allclose(block(x), x)
    torch.nn.init.zeros_(block.conv2.weight)
    torch.nn.init.zeros_(block.conv2.bias)
    assert torch.equal(block(x), x)


def test_a_residual_block_normalizes_first():
    """Brighter and more contrasty input gets the same update."""
    block, x = ResidualBlock(4), torch.randn(2, 4, 8, 8)
    torch.testing.assert_close(block(3 * x + 1) - (3 * x + 1), block(x) - x, rtol=1e-3, atol=1e-3)


def test_an_hourglass_has_the_papers_channels():
    """164 in; [MDD B.5] after TPSMM: 2048, 1024, 512, 256 and 228 channels on the way up."""
    with torch.device("meta"):
        hourglass = Hourglass(164, 64, 1024, 5)
        maps = hourglass(torch.zeros(1, 164, 64, 64))
    assert hourglass.channels == [2048, 1024, 512, 256, 228]
    assert [tuple(m.shape[1:]) for m in maps] == [
        (2048, 4, 4), (1024, 8, 8), (512, 16, 16), (256, 32, 32), (228, 64, 64)
    ]  # fmt: skip


def test_the_finest_map_of_an_hourglass_ends_with_its_input():
    x = torch.randn(2, 3, 16, 16)
    maps = Hourglass(3, 4, 8, 3)(x)
    assert torch.equal(maps[-1][:, -3:], x)


def test_one_pixel_of_an_hourglass_knows_the_whole_picture():
    x = torch.randn(1, 3, 32, 32, requires_grad=True)
    Hourglass(3, 8, 16, 4)(x)[-1][0, 0, 0, 0].backward()
    assert x.grad[0, :, -1, -1].abs().sum() > 0


def test_shrinking_blurs_as_scipy_does():
    image = torch.randn(1, 2, 24, 32, dtype=torch.float64)
    small = shrink(image, 4)
    blurred = gaussian_filter(image.numpy(), (0, 0, 1.5, 1.5), mode="nearest", truncate=4)
    assert small.shape == (1, 2, 6, 8)
    corners = blurred[..., [0, 0, -1, -1], [0, -1, 0, -1]]
    np.testing.assert_allclose(small[..., [0, 0, -1, -1], [0, -1, 0, -1]], corners, rtol=1e-6)


def test_a_shrunk_ramp_is_a_ramp_between_the_same_corners():
    ramp = torch.linspace(-1, 1, 64, dtype=torch.float64).expand(1, 1, 64, 64)
    small = shrink(ramp, 2)[0, 0, 10]
    torch.testing.assert_close(small[3:-3].diff(), small[16:17].expand(26).diff().clone() + 2 / 31)


def test_fine_stripes_vanish_instead_of_becoming_broad_ones():
    stripes = (torch.arange(64) % 2).double().expand(1, 1, 64, 64)
    assert shrink(stripes, 8)[..., 1:-1].std() < 0.01
    assert stripes[..., ::8].std() == 0
    assert (stripes[..., ::7].std()) > 0.4  # what mere picking makes of them


def test_a_constant_stays_and_a_factor_of_one_does_nothing():
    assert torch.allclose(shrink(torch.full((1, 1, 16, 16), 0.3), 4), torch.tensor(0.3))
    image = torch.randn(1, 1, 8, 8)
    assert shrink(image, 1) is image
