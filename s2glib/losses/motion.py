"""Motion losses: match how a motion changes, not only where it is.

Paper:    MDD Sup. B.2, Eqs. B13-B14
Notebook: notebooks/11_losses_and_guidance.ipynb
"""

from jaxtyping import Float
from torch import Tensor


def velocity_loss(
    x: Float[Tensor, "*b frames channels"], x_hat: Float[Tensor, "*b frames channels"]
) -> Float[Tensor, ""]:
    """Mean squared difference of the frame-to-frame changes, over all elements.

    [MDD Eq. B13] sums over the channels: it is this times `channels`. The mean is what the
    authors' code takes, and what the printed weights of 1 were used with.

    Raises:
        ValueError: if the shapes differ or there are fewer than 2 frames.
    """
    return _squared_difference(x, x_hat, order=1)


def acceleration_loss(
    x: Float[Tensor, "*b frames channels"], x_hat: Float[Tensor, "*b frames channels"]
) -> Float[Tensor, ""]:
    """Mean squared difference of the changes of the changes, over all elements.

    [MDD Eq. B14] is this times `channels`, see `velocity_loss`.

    Raises:
        ValueError: if the shapes differ or there are fewer than 3 frames.
    """
    return _squared_difference(x, x_hat, order=2)


def _squared_difference(x: Tensor, x_hat: Tensor, order: int) -> Tensor:
    if x.shape != x_hat.shape or x.ndim < 2 or x.shape[-2] <= order or not x.numel():
        raise ValueError(
            f"expected two motions (..., frames, channels) of one shape and more than {order} "
            f"frames, got {tuple(x.shape)} and {tuple(x_hat.shape)}; frames stand on axis -2"
        )
    return (x - x_hat).diff(n=order, dim=-2).square().mean()  # diff is linear: one will do
