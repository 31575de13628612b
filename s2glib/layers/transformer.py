"""Transformer layers, and the U-shaped stack whose later layers see the earlier ones.

Paper:    AM C.1, Fig. A.7 (after MLD); AM B.2
Notebook: notebooks/12_motion_prior.ipynb
"""

from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers.attention import SelfAttention


class TransformerLayer(nn.Module):
    """Pre-norm: attention and a two-layer network, each added to what came in.

    Args:
        width: numbers per token.
        heads: attention heads.
        hidden: width of the two-layer network.
        eps: of the layer norms.
    """

    def __init__(self, width: int, heads: int, hidden: int, eps: float = 1e-5):
        super().__init__()
        self.norm1 = nn.LayerNorm(width, eps)
        self.attention = SelfAttention(width, heads)
        self.norm2 = nn.LayerNorm(width, eps)
        self.network = nn.Sequential(nn.Linear(width, hidden), nn.GELU(), nn.Linear(hidden, width))

    def forward(self, tokens: Float[Tensor, "batch n width"]) -> Float[Tensor, "batch n width"]:
        """Refine tokens."""
        tokens = tokens + self.attention(self.norm1(tokens))
        return tokens + self.network(self.norm2(tokens))


class SkipTransformer(nn.Module):
    """A U-Net of transformer layers: layer -k receives layer k's output through a linear map.

    Args:
        layers: an odd number of layers, each called as `layer(tokens, *context)`.
        width: numbers per token.

    Raises:
        ValueError: if the number of layers is even.
    """

    def __init__(self, layers: Sequence[nn.Module], width: int):
        super().__init__()
        if len(layers) % 2 == 0:
            raise ValueError(
                f"a U of layers needs a middle one: give an odd number, not {len(layers)}"
            )
        self.middle = len(layers) // 2
        self.layers = nn.ModuleList(layers)
        self.joins = nn.ModuleList(nn.Linear(2 * width, width) for _ in range(self.middle))

    def forward(self, tokens: Float[Tensor, "batch n width"], *context: Tensor) -> Tensor:
        """Down, through the middle, and up again with skips."""
        kept: list[Tensor] = []
        for layer in self.layers[: self.middle]:
            tokens = layer(tokens, *context)
            kept.append(tokens)
        tokens = self.layers[self.middle](tokens, *context)
        for join, layer in zip(self.joins, self.layers[self.middle + 1 :], strict=True):
            tokens = layer(join(torch.cat([tokens, kept.pop()], dim=-1)), *context)
        return tokens
