"""Convolutions over time, and a learned change of the time axis.

Paper:    PT A.1 (residual stacks); for AM: ours
Notebook: notebooks/09_disentanglement.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.layers.conditioning import FiLM


class ContextBlock(nn.Module):
    """Each token sees its two neighbours: a width-3 convolution written as one linear map.

    Args:
        width: numbers per token.
        condition: width of a FiLM condition, or 0 for none.
        dropout: share of the update that is dropped.
    """

    def __init__(self, width: int, *, condition: int = 0, dropout: float = 0.1):
        super().__init__()
        self.norm = nn.LayerNorm(width)
        self.film = FiLM(condition, width) if condition else None
        self.mix = nn.Linear(3 * width, width)
        self.dropout = nn.Dropout(dropout)

    def forward(
        self,
        tokens: Float[Tensor, "batch n width"],
        condition: Float[Tensor, "batch condition"] | None = None,
    ) -> Float[Tensor, "batch n width"]:
        """Add what the neighbourhood suggests."""
        h = self.norm(tokens)
        if self.film is not None and condition is not None:
            h = self.film(h, condition)
        h = F.gelu(h)
        padded = F.pad(h, (0, 0, 1, 1))
        context = torch.cat([padded[:, :-2], h, padded[:, 2:]], dim=-1)
        return tokens + self.dropout(self.mix(context))


class ResidualConv(nn.Module):
    """A dilated convolution over time, added to its input; it starts as the identity."""

    def __init__(self, channels: int, dilation: int = 1):
        super().__init__()
        self.norm = nn.GroupNorm(8, channels)
        self.conv = nn.Conv1d(channels, channels, 3, padding=dilation, dilation=dilation)
        self.out = nn.Conv1d(channels, channels, 1)
        for parameter in self.out.parameters():
            nn.init.zeros_(parameter)

    def forward(self, x: Float[Tensor, "batch channels time"]) -> Tensor:
        """Refine a track."""
        return x + self.out(F.gelu(self.conv(F.gelu(self.norm(x)))))


class TimeResampling(nn.Module):
    """From n_in to n_out tokens by a mixture of learned matrices that a condition chooses.

    Every matrix starts as linear interpolation, so the model begins as a plain resize and can
    learn to stretch time: an angry sentence is faster than a sad one.

    Args:
        n_out: tokens after.
        n_in: tokens before.
        condition: width of the condition vector.
        matrices: how many matrices are mixed.
    """

    def __init__(self, n_out: int, n_in: int, condition: int, matrices: int = 8):
        super().__init__()
        resize = interpolation_matrix(n_out, n_in)
        noise = 0.02 * resize.max() * torch.randn(matrices, n_out, n_in)
        self.matrices = nn.Parameter(resize + noise)
        self.choose = nn.Linear(condition, matrices)

    def forward(
        self, tokens: Float[Tensor, "batch n_in width"], condition: Float[Tensor, "batch condition"]
    ) -> Float[Tensor, "batch n_out width"]:
        """Stretch or squeeze time."""
        shares = F.softmax(self.choose(condition), dim=-1)
        return torch.einsum("bk,koi->boi", shares, self.matrices) @ tokens


def interpolation_matrix(n_out: int, n_in: int) -> Float[Tensor, "n_out n_in"]:
    """Linear interpolation as a matrix whose rows sum to one."""
    centres = (torch.arange(n_out) + 0.5) / n_out * n_in - 0.5
    distance = (centres[:, None] - torch.arange(n_in)).abs()
    weights = (1 - distance / max(1.0, n_in / n_out)).clamp_min(0)
    return weights / weights.sum(dim=1, keepdim=True)
