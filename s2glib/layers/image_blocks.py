"""Blocks for pictures: halve, double, refine, and shrink without aliasing.

Paper:    MDD B.5 (2D convolutions, after TPSMM), B.3 (residual blocks); forms: authors' code
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F


class SameBlock(nn.Sequential):
    """Convolution, instance norm, ReLU: size stays.

    Args:
        inputs: channels in.
        outputs: channels out.
        kernel: odd width of the convolution.
    """

    def __init__(self, inputs: int, outputs: int, kernel: int = 3):
        super().__init__(
            nn.Conv2d(inputs, outputs, kernel, padding=kernel // 2),
            nn.InstanceNorm2d(outputs, affine=True),
            nn.ReLU(),
        )


class DownBlock(nn.Sequential):
    """A `SameBlock`, then the mean of every 2 x 2 pixels."""

    def __init__(self, inputs: int, outputs: int):
        super().__init__(SameBlock(inputs, outputs), nn.AvgPool2d(2))


class UpBlock(nn.Sequential):
    """Every pixel four times, then a `SameBlock`."""

    def __init__(self, inputs: int, outputs: int):
        super().__init__(nn.Upsample(scale_factor=2), SameBlock(inputs, outputs))


class ResidualBlock(nn.Module):
    """Norm, ReLU and convolution, twice, added to the input  [MDD B.3: wide residual networks].

    Args:
        channels: in and out.
        norm: the class of the norms.
    """

    def __init__(
        self,
        channels: int,
        norm: type[nn.InstanceNorm2d] | type[nn.BatchNorm2d] = nn.InstanceNorm2d,
    ):
        super().__init__()
        self.norm1 = norm(channels, affine=True)
        self.conv1 = nn.Conv2d(channels, channels, 3, padding=1)
        self.norm2 = norm(channels, affine=True)
        self.conv2 = nn.Conv2d(channels, channels, 3, padding=1)

    def forward(
        self, x: Float[Tensor, "batch channels h w"]
    ) -> Float[Tensor, "batch channels h w"]:
        """Refine a feature map."""
        h = self.conv1(F.relu(self.norm1(x)))
        return x + self.conv2(F.relu(self.norm2(h)))


class Hourglass(nn.Module):
    """Down to a small picture of everything, and up again with the way down beside it.

    Args:
        inputs: channels in.
        width: channels of the last step up; each step deeper has twice as many.
        widest: no step has more channels than this.
        blocks: steps down, and up.
    """

    def __init__(self, inputs: int, width: int, widest: int, blocks: int):
        super().__init__()
        widths = [min(widest, width * 2**step) for step in range(blocks + 1)]
        kept = [inputs, *widths[1:]]  # channels of the way down
        self.down = nn.ModuleList(DownBlock(*kept[i : i + 2]) for i in range(blocks))
        self.channels = [widths[i] + kept[i] for i in reversed(range(blocks))]
        joined = [widths[-1], *self.channels]
        self.up = nn.ModuleList(UpBlock(joined[i], widths[blocks - 1 - i]) for i in range(blocks))

    def forward(self, x: Float[Tensor, "batch inputs h w"]) -> list[Tensor]:
        """Feature maps of the way up, coarse to fine, with as many channels as `channels` says."""
        kept = [x]
        for block in self.down:
            kept.append(block(kept[-1]))
        h, maps = kept.pop(), []
        for block in self.up:
            h = torch.cat([block(h), kept.pop()], dim=1)
            maps.append(h)
        return maps


def shrink(image: Float[Tensor, "batch channels h w"], factor: int) -> Tensor:
    """A picture `factor` times smaller, blurred first so that fine stripes cannot alias.

    The blur is a Gaussian of (factor - 1) / 2 pixels (authors' code); what is left is read corner
    to corner (ours: every other grid here is).
    """
    if factor == 1:
        return image
    height, width = image.shape[-2:]
    smooth, size = blur(image, (factor - 1) / 2), (height // factor, width // factor)
    return F.interpolate(smooth, size, mode="bilinear", align_corners=True)


def blur(
    image: Float[Tensor, "batch channels h w"], sigma: float
) -> Float[Tensor, "batch channels h w"]:
    """Gaussian blur, cut at four sigma; the edge repeats."""
    reach = round(4 * sigma)
    offsets = torch.arange(-reach, reach + 1, dtype=image.dtype, device=image.device)
    bell = torch.exp(-offsets.square() / (2 * sigma**2))
    channels = image.shape[1]
    kernel = (bell / bell.sum()).expand(channels, 1, 1, -1)
    image = F.pad(image, (reach, reach, reach, reach), mode="replicate")
    image = F.conv2d(image, kernel, groups=channels)
    return F.conv2d(image, kernel.mT, groups=channels)
