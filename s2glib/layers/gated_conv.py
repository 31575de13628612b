"""Gated convolutions over time: one half of the channels decides what passes of the other.

Paper:    PT A.2 (motion context encoder, after PixelCNN)
Notebook: notebooks/06_masked_prediction.ipynb
"""

from jaxtyping import Float
from torch import Tensor, nn


def gated(both: Float[Tensor, "*b channels time"]) -> Float[Tensor, "*b half time"]:
    """Tanh of the first half of the channels, times the sigmoid of the second: their gate."""
    a, b = both.chunk(2, dim=-2)
    return a.tanh() * b.sigmoid()


class GatedConv(nn.Module):
    """tanh(a) * sigmoid(b) of one convolution's two halves, mixed, and added to the input.

    Where time is halved or the width changes, the input is added through a convolution.

    Args:
        channels: numbers per frame that come in.
        width: numbers per frame that go out.
        kernel: frames that a convolution sees.
        stride: 1, or 2 to halve time.
    """

    def __init__(self, channels: int, width: int, kernel: int, stride: int = 1):
        super().__init__()
        padding = (kernel - 1) // 2
        self.conv = nn.Conv1d(channels, 2 * width, kernel, stride, padding)
        self.mix = nn.Conv1d(width, width, 1)
        plain = stride == 1 and channels == width
        self.skip = nn.Identity() if plain else nn.Conv1d(channels, width, kernel, stride, padding)

    def forward(self, x: Float[Tensor, "batch channels time"]) -> Tensor:
        """Refine a track; (batch, width, time / stride)."""
        return self.mix(gated(self.conv(x))) + self.skip(x)
