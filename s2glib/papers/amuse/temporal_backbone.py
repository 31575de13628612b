"""The small backbone that trains on a laptop: convolutions over tokens of four frames.

Emotion and style are statistics of the whole window, without positions. Content is a short
sequence, so that it can say when; it flattens to the paper's 256 numbers.

Paper:    AM B.1 (roles of E_c, E_e, E_s and D), networks: ours
Notebook: notebooks/09_disentanglement.ipynb
"""

import torch
from einops import rearrange
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers import AdaptiveLayer, ContextBlock, TimeResampling, TransformerLayer
from s2glib.papers.amuse.config import SpeechConfig

FRAMES_PER_TOKEN = 4


def _statistics(tokens: Float[Tensor, "batch n width"]) -> Float[Tensor, "batch two_width"]:
    return torch.cat([tokens.mean(dim=1), tokens.std(dim=1)], dim=-1)


class TokenEmbedding(nn.Module):
    """Four frames of a filterbank become one token."""

    def __init__(self, n_mels: int, width: int):
        super().__init__()
        self.embed = nn.Linear(FRAMES_PER_TOKEN * n_mels, width)

    def forward(
        self, filterbank: Float[Tensor, "batch frames mels"]
    ) -> Float[Tensor, "batch n width"]:
        """Cut into tokens."""
        return self.embed(rearrange(filterbank, "b (n f) m -> b n (f m)", f=FRAMES_PER_TOKEN))


class PooledEncoder(nn.Module):
    """E_e or E_s: mean and spread over time of what two scales of convolution see.

    Args:
        config: sizes.
        latent_dim: numbers in the latent.
    """

    def __init__(self, config: SpeechConfig, latent_dim: int):
        super().__init__()
        width = config.width
        self.embed = TokenEmbedding(config.n_mels, width)
        self.blocks = nn.ModuleList(ContextBlock(width, dropout=config.dropout) for _ in range(3))
        self.merges = nn.ModuleList(nn.Linear(2 * width, width) for _ in range(2))
        self.norm = nn.LayerNorm(width)
        self.project = nn.Linear(4 * width, latent_dim)

    def forward(
        self, filterbank: Float[Tensor, "batch frames mels"]
    ) -> Float[Tensor, "batch latent"]:
        """Encode what does not depend on when."""
        tokens = self.blocks[0](self.embed(filterbank))
        pooled = []
        for merge, block in zip(self.merges, self.blocks[1:], strict=True):
            tokens = block(merge(rearrange(tokens, "b (n pair) d -> b n (pair d)", pair=2)))
            pooled.append(_statistics(self.norm(tokens)))
        return self.project(torch.cat(pooled, dim=-1))


class ContentEncoder(nn.Module):
    """E_c: a sequence of a few short tokens, resampled from the speaker's tempo."""

    def __init__(self, config: SpeechConfig):
        super().__init__()
        width, tokens = config.decoder_width, config.content_tokens
        self.embed = TokenEmbedding(config.n_mels, width)
        self.blocks = nn.ModuleList(ContextBlock(width, dropout=config.dropout) for _ in range(2))
        self.resample = TimeResampling(tokens, config.frames // FRAMES_PER_TOKEN, 2 * width)
        self.positions = nn.Parameter(0.1 * torch.randn(1, tokens, width))
        self.layers = nn.ModuleList(
            TransformerLayer(width, config.heads, 2 * width) for _ in range(config.layers)
        )
        self.norm = nn.LayerNorm(width)
        self.project = nn.Linear(width, config.content_dim // tokens)

    def forward(
        self, filterbank: Float[Tensor, "batch frames mels"]
    ) -> Float[Tensor, "batch content"]:
        """Encode what is said, and in which order."""
        tokens = self.embed(filterbank)
        for block in self.blocks:
            tokens = block(tokens)
        tokens = self.resample(tokens, _statistics(tokens)) + self.positions
        for layer in self.layers:
            tokens = layer(tokens)
        return self.project(self.norm(tokens)).flatten(1)


class TemporalDecoder(nn.Module):
    """D: emotion and style steer how the content tokens are stretched and coloured."""

    def __init__(self, config: SpeechConfig):
        super().__init__()
        width, tokens, steer = config.decoder_width, config.content_tokens, 96
        self.frames, self.unfolded = config.frames // FRAMES_PER_TOKEN, 16
        self.steer = nn.Sequential(
            nn.Linear(config.emotion_dim + config.style_dim, steer),
            nn.GELU(),
            nn.Linear(steer, steer),
        )
        self.embed = nn.Linear(config.content_dim // tokens, width)
        self.positions = nn.Parameter(0.1 * torch.randn(1, tokens, width))
        self.layers = nn.ModuleList(
            AdaptiveLayer(width, config.heads, 2 * width, steer) for _ in range(config.layers)
        )
        self.resample = TimeResampling(self.frames, tokens, steer)
        self.fine_positions = nn.Parameter(0.02 * torch.randn(1, self.frames, width))
        self.unfold = nn.Linear(steer, self.frames * self.unfolded)
        self.spread = nn.Linear(self.unfolded, width)
        self.blocks = nn.ModuleList(
            ContextBlock(width, condition=steer, dropout=config.dropout) for _ in range(3)
        )
        self.norm = nn.LayerNorm(width)
        self.out = nn.Linear(width, FRAMES_PER_TOKEN * config.n_mels)

    def forward(
        self,
        content: Float[Tensor, "batch content"],
        emotion: Float[Tensor, "batch emotion"],
        style: Float[Tensor, "batch style"],
    ) -> Float[Tensor, "batch frames mels"]:
        """Draw the filterbank that the three latents describe."""
        steer = self.steer(torch.cat([emotion, style], dim=-1))
        tokens = content.unflatten(-1, (self.positions.shape[1], -1))
        tokens = self.embed(tokens) + self.positions
        for layer in self.layers:
            tokens = layer(tokens, steer)
        unfolded = self.unfold(steer).unflatten(-1, (self.frames, self.unfolded))
        tokens = self.resample(tokens, steer) + self.fine_positions + self.spread(unfolded)
        for block in self.blocks:
            tokens = block(tokens, steer)
        drawn = self.out(self.norm(tokens))
        return rearrange(drawn, "b n (f m) -> b (n f) m", f=FRAMES_PER_TOKEN)
