"""Classifier-free guidance: push the prediction away from what it would be without the condition.

Paper:    MDD Sup. B.2, Eq. B16
Notebook: notebooks/11_losses_and_guidance.ipynb
"""

from collections.abc import Callable
from typing import TypeVar

from torch import Tensor

Condition = TypeVar("Condition")


def guided(
    denoise: Callable[[Tensor, int, Condition], Tensor],
    condition: Condition,
    null: Condition,
    scale: float,
) -> Callable[[Tensor, int], Tensor]:
    """Make `denoise(xt, t, condition)` a guided `denoise(xt, t)` that any sampler takes.

    A condition of several parts is guided on just those parts that differ in `null`: speech but
    not the seed frame [MDD], or emotion alone, with (content, emotion, style) and
    (content, no_emotion, style).

    Args:
        denoise: predicts x0, or noise: the formula is the same for both.
        condition: what to generate for, in any form that `denoise` takes.
        null: the same with the guided parts replaced by what training put there on dropping them.
        scale: gamma; 0 ignores the guided parts, 1 is no guidance, above 1 exaggerates.
    """

    def denoise_guided(xt: Tensor, t: int) -> Tensor:
        return scale * denoise(xt, t, condition) + (1 - scale) * denoise(xt, t, null)  # [MDD B16]

    return denoise_guided
