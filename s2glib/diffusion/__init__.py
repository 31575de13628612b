"""Denoising diffusion: noise schedules, the forward process, samplers and guidance."""

from s2glib.diffusion.guidance import guided
from s2glib.diffusion.process import (
    Posterior,
    add_noise,
    from_noise_prediction,
    noise_from_x0,
    posterior,
    x0_from_noise,
)
from s2glib.diffusion.samplers import sample_ddim, sample_ddpm, timesteps
from s2glib.diffusion.schedule import NoiseSchedule

__all__ = [
    "NoiseSchedule",
    "Posterior",
    "add_noise",
    "from_noise_prediction",
    "guided",
    "noise_from_x0",
    "posterior",
    "sample_ddim",
    "sample_ddpm",
    "timesteps",
    "x0_from_noise",
]
