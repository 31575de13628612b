"""The speech disentangler: three encoders, two linear heads, one decoder.

Paper:    AM B.1, Fig. A.1
Notebook: notebooks/09_disentanglement.ipynb
"""

from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from s2glib.papers.amuse.config import SpeechConfig
from s2glib.papers.amuse.speech_decoder import FilterbankDecoder
from s2glib.papers.amuse.speech_encoder import PatchEncoder
from s2glib.papers.amuse.temporal_backbone import ContentEncoder, PooledEncoder, TemporalDecoder


class SpeechLatents(NamedTuple):
    """c, e and s: what is said, in which emotion, by whom."""

    content: Float[Tensor, "*b content"]
    emotion: Float[Tensor, "*b emotion"]
    style: Float[Tensor, "*b style"]


class SpeechDisentangler(nn.Module):
    """Speech to (c, e, s) and back; input and output are standardised filterbanks.

    The heads sit on the latents, as B.4 says; B.2 and the authors' code put them on [CLS] and
    [DIST] instead.
    """

    config_class = SpeechConfig
    emotion_centres: Tensor

    def __init__(self, config: SpeechConfig):
        super().__init__()
        self.config = config
        if config.backbone == "patches":
            self.content_encoder: nn.Module = PatchEncoder(config, config.content_dim)
            self.emotion_encoder: nn.Module = PatchEncoder(config, config.emotion_dim)
            self.style_encoder: nn.Module = PatchEncoder(config, config.style_dim)
            self.decoder: nn.Module = FilterbankDecoder(config)
        else:
            self.content_encoder = ContentEncoder(config)
            self.emotion_encoder = PooledEncoder(config, config.emotion_dim)
            self.style_encoder = PooledEncoder(config, config.style_dim)
            self.decoder = TemporalDecoder(config)
        self.emotion_head = nn.Linear(config.emotion_dim, config.emotions)
        self.style_head = nn.Linear(config.style_dim, config.styles)
        self.register_buffer("emotion_centres", torch.zeros(config.emotions, config.emotion_dim))

    def remember_emotions(
        self, latents: Float[Tensor, "n emotion"], emotion: Int[Tensor, " n"]
    ) -> None:
        """Keep the mean emotion latent of each class: what "in anger" means without a donor."""
        for label in range(self.config.emotions):
            self.emotion_centres[label] = latents[emotion == label].mean(0)

    def encode(self, filterbank: Float[Tensor, "batch frames mels"]) -> SpeechLatents:
        """Take speech apart."""
        return SpeechLatents(
            self.content_encoder(filterbank),
            self.emotion_encoder(filterbank),
            self.style_encoder(filterbank),
        )

    def decode(self, latents: SpeechLatents) -> Float[Tensor, "batch frames mels"]:
        """Put speech together, from latents of any origin."""
        return self.decoder(*latents)

    def forward(
        self, filterbank: Float[Tensor, "batch frames mels"]
    ) -> Float[Tensor, "batch frames mels"]:
        """Self-reconstruction."""
        return self.decode(self.encode(filterbank))
