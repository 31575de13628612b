"""The transformer decoder of Predictor and Refiner: each speaker scales and shifts what it adds.

Paper:    PT A.2, A.3
Notebook: notebooks/06_masked_prediction.ipynb
"""

from typing import Literal

from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional as F

StyleForm = Literal["adain", "adaln"]


def adaptive_instance_norm(
    tokens: Float[Tensor, "batch n width"],
    scale: Float[Tensor, "batch width"],
    shift: Float[Tensor, "batch width"],
) -> Float[Tensor, "batch n width"]:
    """Normalise every channel over time; then scale it by 1 + scale, and shift it."""
    still = tokens - tokens.mean(dim=1, keepdim=True)
    spread = (still.square().mean(dim=1, keepdim=True) + 1e-5).sqrt()
    return still / spread * (1 + scale[:, None]) + shift[:, None]


class AdaptiveInstanceNorm(nn.Module):
    """The text's form: every channel is normalised over time, then scaled and shifted by style."""

    def __init__(self, width: int, style_dim: int):
        super().__init__()
        self.to_scale_shift = nn.Linear(style_dim, 2 * width)

    def forward(
        self, tokens: Float[Tensor, "batch n width"], style: Float[Tensor, "batch style"]
    ) -> Float[Tensor, "batch n width"]:
        """Give tokens the mean and the spread that a style asks for."""
        scale, shift = self.to_scale_shift(style).chunk(2, dim=-1)
        return adaptive_instance_norm(tokens, scale, shift)


class AdaptiveLayerNorm(nn.Module):
    """The released code's form: normalised over channels, behind a gate that starts at zero."""

    def __init__(self, width: int, style_dim: int):
        super().__init__()
        self.norm = nn.LayerNorm(width)
        self.to_scale_shift = nn.Sequential(nn.SiLU(), nn.Linear(style_dim, 2 * width))
        self.gate = nn.Linear(width, width)
        nn.init.zeros_(self.gate.weight)
        nn.init.zeros_(self.gate.bias)

    def forward(
        self, tokens: Float[Tensor, "batch n width"], style: Float[Tensor, "batch style"]
    ) -> Float[Tensor, "batch n width"]:
        """Scale, shift and gate tokens as a style asks."""
        scale, shift = self.to_scale_shift(style)[:, None].chunk(2, dim=-1)
        return self.gate(F.silu(self.norm(tokens) * (1 + scale) + shift))


STYLE_NORMS = {"adain": AdaptiveInstanceNorm, "adaln": AdaptiveLayerNorm}


class StyleLayer(nn.Module):
    """Self-attention, cross-attention and a linear layer, style normalisation after each [PT A.2].

    Post-norm, as the authors' code.

    Args:
        width: numbers per token.
        heads: attention heads.
        hidden: width of the linear layer's middle.
        style_dim: width of the style vector.
        style_norm: "adain", the text's words, or "adaln", the authors' code.
        dropout: share of every sub-layer's output that is dropped.
    """

    def __init__(
        self,
        width: int,
        heads: int,
        hidden: int,
        style_dim: int,
        *,
        style_norm: StyleForm = "adain",
        dropout: float = 0.1,
    ):
        super().__init__()
        self.self_attention = nn.MultiheadAttention(width, heads, dropout, batch_first=True)
        self.cross_attention = nn.MultiheadAttention(width, heads, dropout, batch_first=True)
        self.network = nn.Sequential(
            nn.Linear(width, hidden), nn.ReLU(), nn.Dropout(dropout), nn.Linear(hidden, width)
        )
        form = STYLE_NORMS[style_norm]
        self.styles = nn.ModuleList(form(width, style_dim) for _ in range(3))
        self.norms = nn.ModuleList(nn.LayerNorm(width) for _ in range(3))
        self.dropout = nn.Dropout(dropout)

    def forward(
        self,
        tokens: Float[Tensor, "batch n width"],
        memory: Float[Tensor, "batch m width"],
        style: Float[Tensor, "batch style"],
    ) -> Float[Tensor, "batch n width"]:
        """Refine tokens by each other, by the memory, and by the style."""

        def add(place: int, update: Tensor) -> Tensor:
            return self.norms[place](tokens + self.styles[place](self.dropout(update), style))

        tokens = add(0, self.self_attention(tokens, tokens, tokens, need_weights=False)[0])
        tokens = add(1, self.cross_attention(tokens, memory, memory, need_weights=False)[0])
        return add(2, self.network(tokens))


class StyleDecoder(nn.Module):
    """A stack of style layers, and one style vector for each speaker.

    Args:
        layers: how many.
        width: numbers per token.
        heads: attention heads.
        hidden: width of the linear layers' middle.
        speakers: how many speakers it knows.
        style_dim: numbers per speaker.
        style_norm: "adain", the text's words, or "adaln", the authors' code.
        dropout: share of every sub-layer's output that is dropped.
    """

    def __init__(
        self,
        layers: int,
        width: int,
        heads: int,
        hidden: int,
        *,
        speakers: int,
        style_dim: int,
        style_norm: StyleForm = "adain",
        dropout: float = 0.1,
    ):
        super().__init__()
        self.speakers = nn.Embedding(speakers, style_dim)
        self.layers = nn.ModuleList(
            StyleLayer(width, heads, hidden, style_dim, style_norm=style_norm, dropout=dropout)
            for _ in range(layers)
        )

    def forward(
        self,
        tokens: Float[Tensor, "batch n width"],
        memory: Float[Tensor, "batch m width"],
        speaker: Int[Tensor, " batch"],
    ) -> Float[Tensor, "batch n width"]:
        """Refine tokens in the manner of a speaker; places in time are the caller's affair."""
        style = self.speakers(speaker)
        for layer in self.layers:
            tokens = layer(tokens, memory, style)
        return tokens
