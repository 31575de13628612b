"""The motion prior of the paper: transformers with long skips around one latent token.

Paper:    AM C.1, Fig. A.7 (after MLD)
Notebook: notebooks/12_motion_prior.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers import SkipTransformer
from s2glib.papers.amuse.config import PriorConfig

LONGEST = 500  # learned positions; authors' code


def _positions(width: int) -> nn.Parameter:
    return nn.Parameter(torch.rand(1, LONGEST, width))


class TransformerMotionEncoder(nn.Module):
    """Two learned tokens read the motion and become the posterior's mean and log-variance."""

    def __init__(self, config: PriorConfig):
        super().__init__()
        width, self.tokens = config.token_dim, config.tokens
        self.embed = nn.Linear(config.features, width)
        self.readers = nn.Parameter(torch.randn(1, 2 * config.tokens, width))
        self.positions = _positions(width)  # added once; Fig. A.7 draws it in every layer
        layers = [
            nn.TransformerEncoderLayer(
                width, config.heads, config.hidden, activation="gelu", batch_first=True
            )
            for _ in range(config.layers)
        ]
        self.layers = SkipTransformer(layers, width)
        self.norm = nn.LayerNorm(width)

    def forward(self, motion: Float[Tensor, "batch frames features"]) -> tuple[Tensor, Tensor]:
        """Mean and log-variance, (batch, tokens, dim) each."""
        h = torch.cat([self.readers.expand(len(motion), -1, -1), self.embed(motion)], dim=1)
        h = self.norm(self.layers(h + self.positions[:, : h.shape[1]]))
        return h[:, : self.tokens], h[:, self.tokens : 2 * self.tokens]


class TransformerMotionDecoder(nn.Module):
    """Empty frames with positions look at the latent token until they are a motion."""

    def __init__(self, config: PriorConfig):
        super().__init__()
        width, self.frames = config.token_dim, config.frames
        self.positions = _positions(width)
        layers = [
            nn.TransformerDecoderLayer(
                width, config.heads, config.hidden, activation="gelu", batch_first=True
            )
            for _ in range(config.layers)
        ]
        self.layers = SkipTransformer(layers, width)
        self.norm = nn.LayerNorm(width)
        self.out = nn.Linear(width, config.features)

    def forward(
        self, tokens: Float[Tensor, "batch tokens dim"]
    ) -> Float[Tensor, "batch frames features"]:
        """Draw the motion that the tokens describe."""
        queries = self.positions[:, : self.frames].expand(len(tokens), -1, -1)
        return self.out(self.norm(self.layers(queries, tokens)))
