"""Loss terms that take features, never networks."""

from s2glib.losses.motion import acceleration_loss, velocity_loss
from s2glib.losses.variational import kl_to_standard_normal

__all__ = ["acceleration_loss", "kl_to_standard_normal", "velocity_loss"]
