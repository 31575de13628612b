"""The features that FGD is measured in: auto-encoders of the face, of body and hands, and of all.

The paper names the metric, not the networks; these are its authors' code but for two slips in it.
`LeakyReLU(True)` there has slope 1, which makes three linear maps one; its "velocity" is the
difference of neighbouring channels instead of neighbouring frames. Here the slope is a setting and
time is time.

Paper:    PT B Tab. 7 (FGD), networks: authors' code
Notebook: notebooks/17_motion_distances.ipynb
"""

from typing import NamedTuple, cast

import torch
from einops import rearrange
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.papers.probtalk.config import FeatureConfig
from s2glib.papers.probtalk.motion_features import HolisticFeatures

SEEN = {
    "face": ("jaw", "expression"),
    "body and hands": ("body", "hands"),
    "all": ("jaw", "body", "hands", "expression"),
}
"""What each of the three networks sees: names in `HolisticFeatures.parts`."""


class FeatureLosses(NamedTuple):
    """How a window was rebuilt: where it is, and how it moves."""

    reconstruction: Float[Tensor, ""]
    velocity: Float[Tensor, ""]

    def total(self) -> Float[Tensor, ""]:
        """Both count the same (authors' code)."""
        return self.reconstruction + self.velocity


class FeatureAutoencoder(nn.Module):
    """A window of motion to one vector, and back.

    Args:
        channels: numbers per frame.
        config: sizes.
    """

    def __init__(self, channels: int, config: FeatureConfig):
        super().__init__()
        first, second, third, last = config.widths
        flat = last * ((config.frames - 4 - 4) // 2 + 1 - 2)  # 90 frames become 40
        wide, narrow = config.hidden
        self.encoder = nn.Sequential(
            *_normed(nn.Conv1d(channels, first, 3), first, 0.2),
            *_normed(nn.Conv1d(first, second, 3), second, 0.2),
            *_normed(nn.Conv1d(second, third, 4, stride=2), third, 0.2),
            nn.Conv1d(third, last, 3),
            nn.Flatten(),
            *_normed(nn.Linear(flat, wide), wide, config.slope),
            *_normed(nn.Linear(wide, narrow), narrow, config.slope),
            nn.Linear(narrow, config.code),
        )
        track, back = config.decoder_widths
        self.unfold = nn.Sequential(
            *_normed(nn.Linear(config.code, narrow), narrow, config.slope),
            nn.Linear(narrow, track * config.frames),
            nn.Unflatten(1, (track, config.frames)),
        )
        self.decoder = nn.Sequential(
            *_normed(nn.ConvTranspose1d(track, back, 3), back, 0.2),
            *_normed(nn.ConvTranspose1d(back, back, 3), back, 0.2),
            nn.Conv1d(back, back, 3),
            nn.Conv1d(back, channels, 3),
        )

    def encode(self, motion: Float[Tensor, "batch frames channels"]) -> Float[Tensor, "batch code"]:
        """The features of windows."""
        return self.encoder(rearrange(motion, "b t c -> b c t"))

    def decode(self, code: Float[Tensor, "batch code"]) -> Float[Tensor, "batch frames channels"]:
        """The windows that features stand for."""
        return rearrange(self.decoder(self.unfold(code)), "b c t -> b t c")

    def forward(
        self, motion: Float[Tensor, "batch frames channels"]
    ) -> Float[Tensor, "batch frames channels"]:
        """Rebuild windows from their features."""
        return self.decode(self.encode(motion))


def _normed(layer: nn.Module, width: int, slope: float) -> tuple[nn.Module, ...]:
    """A layer, batch norm and LeakyReLU."""
    return layer, nn.BatchNorm1d(width), nn.LeakyReLU(slope)


class FeatureNets(nn.Module):
    """The three auto-encoders, and the features of motion that they see parts of."""

    config_class = FeatureConfig

    def __init__(self, config: FeatureConfig):
        super().__init__()
        self.config = config
        self.features = HolisticFeatures(config.expression)
        sizes = {kind: len(self._columns(kind)) for kind in SEEN}
        self.nets = nn.ModuleDict(
            {kind: FeatureAutoencoder(size, config) for kind, size in sizes.items()}
        )

    def _columns(self, kind: str) -> list[int]:
        """Where the parts that a network sees stand in the features of a frame."""
        parts = (self.features.parts[name] for name in SEEN[kind])
        return [column for part in parts for column in range(part.start, part.stop)]

    def net(self, kind: str) -> FeatureAutoencoder:
        """One of the networks."""
        return cast(FeatureAutoencoder, self.nets[kind])

    def see(
        self, kind: str, motion: Float[Tensor, "batch frames features"]
    ) -> Float[Tensor, "batch frames channels"]:
        """The part of a motion that one of the networks sees."""
        return motion[..., self._columns(kind)]

    def forward(
        self, motion: Float[Tensor, "batch frames features"]
    ) -> dict[str, Float[Tensor, "batch code"]]:
        """Features of windows, by each network."""
        return {kind: self.net(kind).encode(self.see(kind, motion)) for kind in SEEN}

    def losses(self, motion: Float[Tensor, "batch frames features"]) -> dict[str, FeatureLosses]:
        """How each network rebuilds windows."""
        seen = {kind: self.see(kind, motion) for kind in SEEN}
        return {kind: feature_losses(part, self.net(kind)(part)) for kind, part in seen.items()}


def feature_losses(
    motion: Float[Tensor, "batch frames channels"], rebuilt: Float[Tensor, "batch frames channels"]
) -> FeatureLosses:
    """Mean L1 of the windows, and of their changes from frame to frame."""
    apart = motion - rebuilt
    return FeatureLosses(apart.abs().mean(), apart.diff(dim=-2).abs().mean())


def split_windows(
    motion: Float[Tensor, "n frames features"], length: int
) -> Float[Tensor, "m length features"]:
    """Windows that do not overlap: all of the first of them, then all of the second, and so on."""
    return torch.cat(motion.split(length, dim=1)[: motion.shape[1] // length])
