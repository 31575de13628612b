"""Conditioning: let a vector decide how every token is scaled, shifted and gated.

Paper:    MDD B.2 (FiLM); AM C.1 (conditions e, s, c), form after DiT: ours
Notebook: notebooks/13_latent_diffusion.ipynb
"""

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.layers.attention import SelfAttention


class FiLM(nn.Module):
    """(1 + scale) x + shift, with scale and shift read off a condition vector."""

    def __init__(self, condition: int, width: int):
        super().__init__()
        self.to_scale_shift = nn.Linear(condition, 2 * width)

    def forward(
        self, tokens: Float[Tensor, "batch n width"], condition: Float[Tensor, "batch condition"]
    ) -> Float[Tensor, "batch n width"]:
        """Scale and shift every token alike."""
        scale, shift = self.to_scale_shift(condition)[:, None].chunk(2, dim=-1)
        return tokens * (1 + scale) + shift


class AdaptiveLayer(nn.Module):
    """A transformer layer whose norms and gates follow a condition; it starts as the identity.

    Args:
        width: numbers per token.
        heads: attention heads.
        hidden: width of the two-layer network.
        condition: width of the condition vector.
    """

    def __init__(self, width: int, heads: int, hidden: int, condition: int):
        super().__init__()
        self.norm1 = nn.LayerNorm(width, elementwise_affine=False)
        self.attention = SelfAttention(width, heads)
        self.norm2 = nn.LayerNorm(width, elementwise_affine=False)
        self.network = nn.Sequential(nn.Linear(width, hidden), nn.GELU(), nn.Linear(hidden, width))
        self.modulate = nn.Linear(condition, 6 * width)
        nn.init.zeros_(self.modulate.weight)
        nn.init.zeros_(self.modulate.bias)

    def forward(
        self, tokens: Float[Tensor, "batch n width"], condition: Float[Tensor, "batch condition"]
    ) -> Float[Tensor, "batch n width"]:
        """Refine tokens as the condition asks."""
        modulation = self.modulate(F.silu(condition))[:, None]
        scale1, shift1, gate1, scale2, shift2, gate2 = modulation.chunk(6, dim=-1)
        tokens = tokens + gate1 * self.attention(self.norm1(tokens) * (1 + scale1) + shift1)
        return tokens + gate2 * self.network(self.norm2(tokens) * (1 + scale2) + shift2)
