"""The motion extractor M, and a second judge built quite differently.

Every figure about generated gestures is read through M. A figure that only M confirms may be a
weakness of M, so a second network judges joint positions instead of rotations.

Paper:    AM D (L_Memo), E
Notebook: notebooks/17_motion_distances.ipynb
"""

from itertools import pairwise
from typing import NamedTuple

import torch
from einops import rearrange
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.layers import TransformerLayer
from s2glib.papers.amuse.config import ExtractorConfig
from s2glib.papers.amuse.motion_features import SEEN_JOINTS, MotionFeatures, motion_features


class Judgement(NamedTuple):
    """Class scores, and the features that distances are measured in."""

    logits: Float[Tensor, "batch classes"]
    features: Float[Tensor, "batch width"]


class MotionExtractor(nn.Module):
    """M: a transformer auto-encoder whose [CLS] token names the emotion  [AM D].

    Each token of the code is decoded back to its frames, so that the features describe the motion
    and not only its class.
    """

    config_class = ExtractorConfig

    def __init__(self, config: ExtractorConfig):
        super().__init__()
        self.config = config
        self.features: MotionFeatures = motion_features(config.features)
        width, tokens = config.width, config.frames // config.patch
        self.embed = nn.Linear(config.patch * config.features, width)
        self.cls = nn.Parameter(0.02 * torch.randn(1, 1, width))
        self.positions = nn.Parameter(0.02 * torch.randn(1, tokens + 1, width))
        self.dropout = nn.Dropout(config.dropout)
        self.layers = nn.ModuleList(
            TransformerLayer(width, config.heads, config.hidden) for _ in range(config.layers)
        )
        self.norm = nn.LayerNorm(width)
        self.classify = nn.Linear(width, config.emotions)
        self.reconstruct = nn.Linear(width, config.patch * config.features)

    def _tokens(self, motion: Tensor) -> Tensor:
        patches = rearrange(motion, "b (n p) f -> b n (p f)", p=self.config.patch)
        h = torch.cat([self.cls.expand(len(motion), -1, -1), self.embed(patches)], dim=1)
        h = self.dropout(h + self.positions)
        for layer in self.layers:
            h = layer(h)
        return self.norm(h)

    def forward(self, motion: Float[Tensor, "batch frames features"]) -> Judgement:
        """Judge clips of features."""
        cls = self._tokens(motion)[:, 0]
        return Judgement(self.classify(cls), cls)

    def losses(
        self, motion: Float[Tensor, "batch frames features"], emotion: Tensor
    ) -> tuple[Float[Tensor, ""], Float[Tensor, ""]]:
        """L_Memo, and the auto-encoder's mean squared error  [AM D]."""
        tokens = self._tokens(motion)
        drawn = self.reconstruct(tokens[:, 1:])
        drawn = rearrange(drawn, "b n (p f) -> b (n p) f", p=self.config.patch)
        return F.cross_entropy(self.classify(tokens[:, 0]), emotion), F.mse_loss(drawn, motion)


class PositionJudge(nn.Module):
    """Names the emotion from nine joint positions and their speeds, by strided convolutions."""

    config_class = ExtractorConfig

    def __init__(self, config: ExtractorConfig):
        super().__init__()
        self.config = config
        self.features: MotionFeatures = motion_features(config.features)
        width = config.width
        channels = (6 * len(SEEN_JOINTS), width, width, width)
        layers: list[nn.Module] = []
        for before, after in pairwise(channels):
            layers += [nn.Conv1d(before, after, 5, stride=2, padding=2), nn.GELU()]
        self.layers = nn.Sequential(*layers)
        self.classify = nn.Sequential(nn.Dropout(0.2), nn.Linear(2 * width, config.emotions))

    def forward(self, motion: Float[Tensor, "batch frames features"]) -> Judgement:
        """Judge clips of features by where the joints are."""
        places = self.features.positions(motion).flatten(-2)  # (batch, frames, 27)
        speeds = F.pad(places.diff(dim=1), (0, 0, 1, 0))
        h = self.layers(torch.cat([3 * places, 30 * speeds], dim=-1).mT)
        pooled = torch.cat([h.mean(-1), h.amax(-1)], dim=-1)
        return Judgement(self.classify(pooled), pooled)
