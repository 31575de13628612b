"""Loss terms that take features, never networks."""

from s2glib.losses.adversarial import discriminator_loss, generator_loss
from s2glib.losses.image import (
    equivariance_loss,
    gram,
    masked_l1,
    perceptual_loss,
    style_loss,
    total_variation,
    warp_loss,
)
from s2glib.losses.motion import acceleration_loss, velocity_loss
from s2glib.losses.variational import kl_to_standard_normal

__all__ = [
    "acceleration_loss",
    "discriminator_loss",
    "equivariance_loss",
    "generator_loss",
    "gram",
    "kl_to_standard_normal",
    "masked_l1",
    "perceptual_loss",
    "style_loss",
    "total_variation",
    "velocity_loss",
    "warp_loss",
]
