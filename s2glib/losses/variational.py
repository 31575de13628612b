"""The price of a variational latent: its divergence from the standard normal distribution.

Paper:    AM Sup. C.1, Fig. A.7 (motion prior); the loss as in the authors' code
Notebook: notebooks/12_motion_prior.ipynb
"""

from jaxtyping import Float
from torch import Tensor


def kl_to_standard_normal(
    mean: Float[Tensor, "*shape"], log_var: Float[Tensor, "*shape"]
) -> Float[Tensor, "*shape"]:
    """Kullback-Leibler divergence KL(N(mean, exp(log_var)) || N(0, 1)) of every element, in nats.

    Left unreduced, because a weight means nothing without its reduction: the motion prior here
    takes 1e-4 of the sum over the latent's axes, `kl.sum((-2, -1)).mean()`; AMUSE's code takes
    1e-4 of `kl.mean()`, which weighs less by the size of the latent.
    """
    return (mean.square() + log_var.expm1() - log_var) / 2
