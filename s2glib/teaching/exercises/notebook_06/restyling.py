"""Exercise 06-2: every channel gets the mean and the spread that a style asks for.

Paper:    PT A.2 (AdaIN)
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.papers.probtalk import adaptive_instance_norm
from s2glib.teaching.exercises.exercise import Exercise, Mutant


def style_inputs(rng: np.random.Generator) -> Iterator[tuple[Tensor, Tensor, Tensor]]:
    """Two channels of one clip without any style, and clips with styles of their own."""
    tokens = torch.tensor([[[1.0, 10.0], [3.0, 10.0], [5.0, 40.0]]], dtype=torch.float64)
    yield tokens, torch.zeros(1, 2, dtype=torch.float64), torch.zeros(1, 2, dtype=torch.float64)
    shapes = (3, 7, 4), (3, 4), (3, 4)
    tokens, scale, shift = (torch.tensor(rng.normal(size=shape)) for shape in shapes)
    yield 3 * tokens + torch.arange(4), scale, shift


def style_oracle(tokens: Tensor, scale: Tensor, shift: Tensor) -> Tensor:
    """Clip by clip and channel by channel, in numpy."""
    made = np.empty(tokens.shape)
    for clip, channel in np.ndindex(scale.shape):
        track = tokens[clip, :, channel].numpy()
        even = (track - np.mean(track)) / np.sqrt(np.var(track) + 1e-5)
        made[clip, :, channel] = even * (1 + float(scale[clip, channel]))
        made[clip, :, channel] += float(shift[clip, channel])
    return torch.from_numpy(made)


def _normalised(
    tokens: Tensor, scale: Tensor, shift: Tensor, axes: tuple[int, ...], *, unbiased: bool = False
) -> Tensor:
    still = tokens - tokens.mean(axes, keepdim=True)
    spread = (tokens.var(axes, keepdim=True, unbiased=unbiased) + 1e-5).sqrt()
    return still / spread * (1 + scale[:, None]) + shift[:, None]


def over_channels(tokens: Tensor, scale: Tensor, shift: Tensor) -> Tensor:
    """A layer norm."""
    return _normalised(tokens, scale, shift, (2,))


def over_the_batch(tokens: Tensor, scale: Tensor, shift: Tensor) -> Tensor:
    """A batch norm."""
    return _normalised(tokens, scale, shift, (0, 1))


def over_everything(tokens: Tensor, scale: Tensor, shift: Tensor) -> Tensor:
    """One mean and one spread for a whole clip."""
    return _normalised(tokens, scale, shift, (1, 2))


def one_less(tokens: Tensor, scale: Tensor, shift: Tensor) -> Tensor:
    """The variance of a sample, divided by n - 1."""
    return _normalised(tokens, scale, shift, (1,), unbiased=True)


def by_the_variance(tokens: Tensor, scale: Tensor, shift: Tensor) -> Tensor:
    """No root."""
    still = tokens - tokens.mean(1, keepdim=True)
    variance = still.square().mean(1, keepdim=True) + 1e-5
    return still / variance * (1 + scale[:, None]) + shift[:, None]


def bare_scale(tokens: Tensor, scale: Tensor, shift: Tensor) -> Tensor:
    """A scale of zero leaves nothing."""
    return adaptive_instance_norm(tokens, scale - 1, shift)


def nothing_removed(tokens: Tensor, scale: Tensor, shift: Tensor) -> Tensor:
    """Only modulated."""
    return tokens * (1 + scale[:, None]) + shift[:, None]


RESTYLE = Exercise(
    id="06-2",
    title="another style",
    reference=adaptive_instance_norm,
    inputs=style_inputs,
    oracle=style_oracle,
    minutes=10,
    difficulty=2,
    equation="PT A.2",
    tolerance=1e-5,
    mutants=(
        Mutant(
            over_channels,
            "You normalise each token over its channels; that is a layer norm. Take each channel "
            "over time.",
        ),
        Mutant(
            over_the_batch, "You take one mean for all clips of the batch; each clip has its own."
        ),
        Mutant(over_everything, "You take one mean for all channels; each channel has its own."),
        Mutant(
            one_less,
            "Your variance is divided by n - 1; here it is the mean of squares, divided by n.",
        ),
        Mutant(by_the_variance, "You divide by the variance; divide by its root."),
        Mutant(bare_scale, "Your scale of 0 leaves nothing: multiply by 1 + scale."),
        Mutant(
            nothing_removed, "You scale and shift, but you have to take out the old mean first."
        ),
    ),
    hints=(
        "Time is axis 1. `tokens.mean(dim=1, keepdim=True)` is one mean for each clip and channel.",
        "`spread = (still.square().mean(dim=1, keepdim=True) + 1e-5).sqrt()`, of what is left "
        "without the mean.",
        "`scale[:, None]` is the same at all times: "
        "`still / spread * (1 + scale[:, None]) + shift[:, None]`.",
    ),
)
