"""The forward process and its algebra: add noise, take it off, step back once by Bayes' rule.

Paper:    MDD Sup. B.2, Eqs. B10-B12
Notebook: notebooks/10_diffusion.ipynb
"""

from collections.abc import Callable
from typing import Literal, NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor

from s2glib.diffusion.schedule import NoiseSchedule


class Posterior(NamedTuple):
    """The Gaussian q(x_{t-1} | x_t, x_0)."""

    mean: Float[Tensor, "*shape"]
    variance: Float[Tensor, "*ones"]


def add_noise(
    schedule: NoiseSchedule,
    x0: Float[Tensor, "*shape"],
    noise: Float[Tensor, "*shape"],
    t: int | Int[Tensor, "*b"],
) -> Float[Tensor, "*shape"]:
    """Jump from clean data to level `t`: all steps of [MDD Eq. B10] at once.

    Here and below `t` is one level for everything, or a tensor (*b) of levels for the leading
    axes of x; its values are 0..levels-1.

    Raises:
        ValueError: if `t` is no integer, leaves the schedule, or does not fit x's leading axes.
    """
    signal, sigma = _scales(schedule, t, x0)
    return signal * x0 + sigma * noise


def x0_from_noise(
    schedule: NoiseSchedule,
    xt: Float[Tensor, "*shape"],
    noise: Float[Tensor, "*shape"],
    t: int | Int[Tensor, "*b"],
) -> Float[Tensor, "*shape"]:
    """Solve `add_noise` for the clean data."""
    signal, sigma = _scales(schedule, t, xt)
    return (xt - sigma * noise) / signal


def noise_from_x0(
    schedule: NoiseSchedule,
    xt: Float[Tensor, "*shape"],
    x0: Float[Tensor, "*shape"],
    t: int | Int[Tensor, "*b"],
) -> Float[Tensor, "*shape"]:
    """Solve `add_noise` for the noise."""
    signal, sigma = _scales(schedule, t, xt)
    return (xt - signal * x0) / sigma


def posterior(
    schedule: NoiseSchedule,
    x0: Float[Tensor, "*shape"],
    xt: Float[Tensor, "*shape"],
    t: int | Int[Tensor, "*b"],
    *,
    denominator: Literal["alpha_bar", "alpha"] = "alpha_bar",
) -> Posterior:
    """Where x was one level earlier, given both ends  [MDD Eq. B11].

    Args:
        schedule: the noise schedule.
        x0: clean data, or a guess of it.
        xt: the same data at level `t`.
        t: the level, see `add_noise`.
        denominator: the paper prints sqrt(1 - alpha_t) below the noise; only sqrt(1 - alpha-bar_t)
            gives DDPM's mean. "alpha" is the printed formula, kept to show that it fails.

    Returns:
        The mean, and the variance with x's rank; at level 0 these are `x0` and 0.
    """
    alpha_bar = _at(schedule.alpha_bars, t, xt)
    before = _at(schedule.alpha_bars_before, t, xt)
    alpha = alpha_bar / before
    variance = (1 - before) / (1 - alpha_bar) * (1 - alpha)
    if denominator == "alpha":  # [MDD after Eq. B11], as printed
        noise = noise_from_x0(schedule, xt, x0, t)
        mean = (xt - (1 - alpha).sqrt().to(xt) * noise) / alpha.sqrt().to(xt)
    else:
        from_x0 = before.sqrt() * (1 - alpha) / (1 - alpha_bar)
        from_xt = alpha.sqrt() * (1 - before) / (1 - alpha_bar)
        mean = from_x0.to(x0) * x0 + from_xt.to(xt) * xt
    return Posterior(mean, variance.to(xt))


def from_noise_prediction(
    net: Callable[..., Tensor], schedule: NoiseSchedule
) -> Callable[..., Tensor]:
    """Turn `net(xt, t, *condition) -> noise` into `denoise(xt, t, *condition) -> x0`."""

    def denoise(xt: Tensor, t: int | Tensor, *condition: object) -> Tensor:
        return x0_from_noise(schedule, xt, net(xt, t, *condition), t)

    return denoise


def _scales(schedule: NoiseSchedule, t: int | Tensor, x: Tensor) -> tuple[Tensor, Tensor]:
    """Standard deviations of signal and noise at level t, ready to multiply `x`."""
    alpha_bar = _at(schedule.alpha_bars, t, x)
    return alpha_bar.sqrt().to(x), (1 - alpha_bar).sqrt().to(x)  # rounded last: 1 - alpha-bar


def _at(table: Tensor, t: int | Tensor, x: Tensor) -> Tensor:
    """Entry t of a float64 table, with one trailing axis for each axis of `x` that t lacks."""
    t = torch.as_tensor(t, device="cpu")
    if t.dtype.is_floating_point or t.dtype == torch.bool or ((t < 0) | (t >= len(table))).any():
        raise ValueError(f"levels must be integers in 0..{len(table) - 1}, got {t.tolist()}")
    if t.shape != x.shape[: t.ndim]:
        raise ValueError(
            f"levels of shape {tuple(t.shape)} do not fit data of shape {tuple(x.shape)}; "
            "pass one level, or one for each entry of the leading axes"
        )
    return table[t].reshape(t.shape + (1,) * (x.ndim - t.ndim))
