"""The motion prior: a variational auto-encoder between clips of gestures and latent tokens.

Paper:    AM C.1, Fig. A.7
Notebook: notebooks/12_motion_prior.ipynb
"""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.losses import kl_to_standard_normal
from s2glib.papers.amuse.config import PriorConfig
from s2glib.papers.amuse.motion_features import MotionFeatures, motion_features
from s2glib.papers.amuse.temporal_prior import TemporalMotionDecoder, TemporalMotionEncoder
from s2glib.papers.amuse.transformer_prior import TransformerMotionDecoder, TransformerMotionEncoder


class MotionPosterior(NamedTuple):
    """What the encoder believes about a clip's tokens."""

    mean: Float[Tensor, "batch tokens dim"]
    log_var: Float[Tensor, "batch tokens dim"]

    def sample(self, generator: torch.Generator | None) -> Float[Tensor, "batch tokens dim"]:
        """Mean + std * noise, so that gradients reach both."""
        place = self.mean.device if generator is None else generator.device
        noise = torch.randn(self.mean.shape, generator=generator, device=place).to(self.mean)
        return self.mean + (self.log_var / 2).exp() * noise


class MotionPrior(nn.Module):
    """P_E and P_D: `encode` a clip to a posterior over tokens, `decode` tokens to a clip."""

    config_class = PriorConfig

    def __init__(self, config: PriorConfig):
        super().__init__()
        self.config = config
        self.features: MotionFeatures = motion_features(config.features)
        if config.backbone == "transformer":
            self.encoder: nn.Module = TransformerMotionEncoder(config)
            self.decoder: nn.Module = TransformerMotionDecoder(config)
        else:
            self.decoder = TemporalMotionDecoder(config)
            self.encoder = TemporalMotionEncoder(config, self.decoder.posture)

    def encode(self, motion: Float[Tensor, "batch frames features"]) -> MotionPosterior:
        """The posterior over a clip's latent tokens."""
        return MotionPosterior(*self.encoder(motion))

    def decode(
        self, tokens: Float[Tensor, "batch tokens dim"]
    ) -> Float[Tensor, "batch frames features"]:
        """The clip that latent tokens stand for."""
        return self.decoder(tokens)

    def forward(
        self, motion: Float[Tensor, "batch frames features"]
    ) -> Float[Tensor, "batch frames features"]:
        """Reconstruct through the posterior's mean."""
        return self.decode(self.encode(motion).mean)


class PriorLosses(NamedTuple):
    """L_rec, its velocity and joint-position companions (ours), and L_KL."""

    reconstruction: Tensor
    velocity: Tensor
    position: Tensor
    kl: Tensor

    def total(self, *, kl: float, position: float = 8.0) -> Float[Tensor, ""]:
        """Weighted sum; `position` is per metre."""
        return self.reconstruction + self.velocity + position * self.position + kl * self.kl


def prior_losses(
    prior: MotionPrior,
    motion: Float[Tensor, "batch frames features"],
    *,
    generator: torch.Generator | None,
) -> PriorLosses:
    """Reconstruct through a sampled latent and compare features, speeds and joint places."""
    posterior = prior.encode(motion)
    drawn = prior.decode(posterior.sample(generator))
    places = prior.features.positions(torch.cat([motion, drawn]))
    true, made = places.chunk(2)
    return PriorLosses(
        (drawn - motion).abs().mean(),
        (drawn - motion).diff(dim=-2).abs().mean(),
        ((made - true).square().sum(-1) + 1e-6).sqrt().mean(),
        kl_to_standard_normal(*posterior).sum(dim=(-2, -1)).mean(),
    )
