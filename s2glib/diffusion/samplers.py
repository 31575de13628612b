"""Samplers: from noise to data, one denoising step at a time.

Paper:    MDD Sup. B.2, Eq. B11, and B.5 (DDPM Algorithm 2; DDIM Eqs. 12 and 16)
Notebook: notebooks/10_diffusion.ipynb
"""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Literal

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.diffusion.process import posterior
from s2glib.diffusion.schedule import NoiseSchedule


def timesteps(
    levels: int,
    steps: int,
    spacing: Literal["leading", "trailing", "linspace"] = "leading",
    offset: int = 0,
) -> list[int]:
    """Choose which levels a sampler visits, noisiest first.

    "leading" counts up from level 0 and never sees the last level; "trailing" counts down from the
    last and never sees level 0 [MDD, authors' code: 999, 979, ..., 19]; "linspace" visits both.

    Args:
        levels: levels of the schedule.
        steps: how many of them to visit.
        spacing: see above.
        offset: added to every level [AM, authors' code: leading + 1 gives 981, 961, ..., 1].

    Raises:
        ValueError: if that many levels do not exist, or the offset pushes one out of the schedule.
    """
    if not 1 <= steps <= levels:
        raise ValueError(f"steps must be 1 to {levels}, the levels there are; got {steps}")
    visited = {
        "leading": np.arange(steps)[::-1] * (levels // steps),
        "trailing": (levels - np.arange(steps) * (levels / steps)).round() - 1,
        "linspace": np.linspace(levels - 1, 0, steps),
    }
    if spacing not in visited:
        raise ValueError(f"spacing must be one of {', '.join(visited)}; got {spacing!r}")
    chosen = [int(level) + offset for level in visited[spacing].round()]
    if chosen[0] >= levels or chosen[-1] < 0:
        raise ValueError(f"offset {offset} leaves levels 0..{levels - 1}; use a smaller one")
    return chosen


def sample_ddpm(
    denoise: Callable[[Tensor, int], Tensor],
    xt: Float[Tensor, "*shape"],
    schedule: NoiseSchedule,
    *,
    generator: torch.Generator | None,
) -> Iterator[Float[Tensor, "*shape"]]:
    """Walk down all levels, drawing each x from its posterior  [DDPM Algorithm 2].

    Args:
        denoise: `denoise(xt, t)` predicts x0; t is an int.
        xt: noise at the last level.
        schedule: the noise schedule.
        generator: source of the noise, on xt's device; None takes torch's global one.

    Yields:
        x after each step; the last item is the sample. No gradient flows.
    """
    for t in reversed(range(schedule.levels)):
        with torch.no_grad():
            mean, variance = posterior(schedule, denoise(xt, t), xt, t)  # [MDD Eq. B11]
            xt = mean + variance.sqrt() * _noise_like(xt, generator)  # variance 0 at the last step
        yield xt


def sample_ddim(
    denoise: Callable[[Tensor, int], Tensor],
    xt: Float[Tensor, "*shape"],
    schedule: NoiseSchedule,
    *,
    timesteps: Sequence[int],
    eta: float = 0.0,
    clip: float | None = None,
    generator: torch.Generator | None = None,
) -> Iterator[Float[Tensor, "*shape"]]:
    """Walk down the chosen levels, jumping from each to the next and at last to clean data.

    Args:
        denoise: `denoise(xt, t)` predicts x0; t is an int.
        xt: noise at the first of the chosen levels.
        schedule: the noise schedule.
        timesteps: the levels to visit, falling; see the function of that name.
        eta: 0 adds no noise on the way; 1 adds as much as the posterior has  [DDIM Eq. 16].
        clip: clamp each predicted x0 to [-clip, clip]; the noise then follows from the clamped x0.
        generator: source of the noise, needed if eta > 0; None takes torch's global one.

    Yields:
        x after each step; the last item is the sample. No gradient flows.

    Raises:
        ValueError: at the first item, if the levels do not fall strictly inside the schedule, or
            eta or clip is out of range.
    """
    _check_ddim(schedule, timesteps, eta, clip)
    alpha_bars = [*schedule.alpha_bars.tolist(), 1.0]  # so that level -1 is clean data
    for t, t_next in zip(timesteps, [*timesteps[1:], -1], strict=True):
        now, then = alpha_bars[t], alpha_bars[t_next]
        sigma = eta * math.sqrt((1 - then) / (1 - now) * (1 - now / then))  # [DDIM Eq. 16]
        # [DDIM Eq. 12]: sqrt(then) x0 + sqrt(1 - then - sigma^2) noise + sigma (fresh noise), with
        # noise = (xt - sqrt(now) x0) / sqrt(1 - now); terms collected by x0 and xt:
        from_xt = math.sqrt((1 - then - sigma**2) / (1 - now))
        from_x0 = math.sqrt(then) - from_xt * math.sqrt(now)
        with torch.no_grad():
            x0 = denoise(xt, t)
            if clip is not None:
                x0 = x0.clamp(-clip, clip)
            xt = from_x0 * x0 + from_xt * xt
            if sigma > 0:
                xt = xt + sigma * _noise_like(xt, generator)
        yield xt


def _noise_like(x: Tensor, generator: torch.Generator | None) -> Tensor:
    return torch.randn(x.shape, generator=generator, dtype=x.dtype, device=x.device)


def _check_ddim(
    schedule: NoiseSchedule, timesteps: Sequence[int], eta: float, clip: float | None
) -> None:
    walk = [schedule.levels, *timesteps, -1]
    if len(walk) < 3 or any(now <= then for now, then in pairwise(walk)):
        raise ValueError(
            f"timesteps must fall strictly within {schedule.levels - 1}..0, got {list(timesteps)}; "
            "make them with timesteps(levels, steps)"
        )
    if not 0 <= eta <= 1:
        raise ValueError(f"eta must be 0 (no noise) to 1 (the posterior's), got {eta}")
    if clip is not None and not clip > 0:
        raise ValueError(f"clip must be positive or None, got {clip}")
