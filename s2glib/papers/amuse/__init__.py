"""AMUSE: emotional speech-driven 3-D body animation by disentangled latent diffusion."""
