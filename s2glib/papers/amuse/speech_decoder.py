"""The speech decoder of the paper: fuse three latents into one, and draw a filterbank from it.

Paper:    AM B.1, B.5
Notebook: notebooks/09_disentanglement.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.papers.amuse.config import SpeechConfig


def _layers(width: int, heads: int, count: int) -> nn.TransformerEncoder:
    layer = nn.TransformerEncoderLayer(width, heads, 2048, batch_first=True)
    return nn.TransformerEncoder(layer, count, enable_nested_tensor=False)


class Fusion(nn.Module):
    """One embedding from the triplet, by attention between its three tokens  [AM B.1].

    The authors' code concatenates the latents into a single token, over which attention can only
    be the identity; three tokens are the text's cross-attention.
    """

    def __init__(self, config: SpeechConfig):
        super().__init__()
        sizes = (config.content_dim, config.emotion_dim, config.style_dim)
        width = sum(sizes)  # 768  [AM B.5]
        self.embed = nn.ModuleList(nn.Linear(size, width) for size in sizes)
        self.mix = _layers(width, heads=4, count=2)  # [AM B.5]
        self.out = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, config.decoder_width))

    def forward(self, *latents: Float[Tensor, "batch _"]) -> Float[Tensor, "batch width"]:
        """Content, emotion and style in; one vector out."""
        tokens = [embed(latent) for embed, latent in zip(self.embed, latents, strict=True)]
        return self.out(self.mix(torch.stack(tokens, dim=1)).mean(dim=1))


class FilterbankDecoder(nn.Module):
    """D: fusion, four transformer layers, and a linear map to every point of the filterbank."""

    def __init__(self, config: SpeechConfig):
        super().__init__()
        self.shape = (config.frames, config.n_mels)
        self.fusion = Fusion(config)
        self.layers = _layers(config.decoder_width, heads=4, count=4)  # [AM B.5]
        self.out = nn.Sequential(
            nn.LayerNorm(config.decoder_width),
            nn.Linear(config.decoder_width, 1024),
            nn.ReLU(),
            nn.Linear(1024, config.frames * config.n_mels),
        )

    def forward(
        self,
        content: Float[Tensor, "batch content"],
        emotion: Float[Tensor, "batch emotion"],
        style: Float[Tensor, "batch style"],
    ) -> Float[Tensor, "batch frames mels"]:
        """Draw the filterbank that the three latents describe."""
        token = self.fusion(content, emotion, style)[:, None]
        return self.out(self.layers(token)[:, 0]).unflatten(-1, self.shape)
