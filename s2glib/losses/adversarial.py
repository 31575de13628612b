"""Adversarial losses: one network learns to tell, the other not to be told.

Least squares (LSGAN): a real patch should score 1, a made one 0; the maker wants 1.

Paper:    MDD Sup. B.3 (L_D and L_G of Eq. B21); least squares: authors' code
Notebook: notebooks/04_repairing_pixels.ipynb
"""

from jaxtyping import Float
from torch import Tensor


def discriminator_loss(
    real: Float[Tensor, "*patches"], fake: Float[Tensor, "*patches_fake"]
) -> Float[Tensor, ""]:
    """Half of mean (real - 1)^2 + mean fake^2, over scores of patches."""
    return ((real - 1).square().mean() + fake.square().mean()) / 2


def generator_loss(fake: Float[Tensor, "*patches"]) -> Float[Tensor, ""]:
    """Mean (fake - 1)^2, over scores of patches."""
    return (fake - 1).square().mean()
