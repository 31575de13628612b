"""Exercise 04-2: compare which features go together, wherever that is.

Paper:    MDD Eq. B19
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.losses import gram, perceptual_loss, style_loss
from s2glib.teaching.exercises.exercise import Exercise, Mutant

Maps = list[Tensor]


def map_inputs(rng: np.random.Generator) -> Iterator[tuple[Maps, Maps]]:
    """Two channels at two places; then two maps of different sizes, of two pictures."""
    one = torch.tensor([[[[1.0, 2.0]], [[0.0, 3.0]]]], dtype=torch.float64)
    yield [one], [torch.zeros_like(one)]
    shapes = ((2, 3, 4, 5), (2, 4, 2, 3))
    features, features_hat = (
        [torch.tensor(rng.normal(size=shape)) for shape in shapes] for _ in range(2)
    )
    yield features, features_hat


def map_oracle(features: Maps, features_hat: Maps) -> Tensor:
    """Channel against channel, one product at a time."""
    total = 0.0
    for these, those in zip(features, features_hat, strict=True):
        b, c = these.shape[:2]
        pairs = [(n, i, j) for n in range(b) for i in range(c) for j in range(c)]
        entries = (
            np.array([(m[n, i] * m[n, j]).mean() / c for n, i, j in pairs])
            for m in (these.numpy(), those.numpy())
        )
        total += np.abs(next(entries) - next(entries)).mean()
    return torch.tensor(total)


def compared(features: Maps, features_hat: Maps, matrix) -> Tensor:
    """Mean absolute difference of one kind of matrix, summed over the maps."""
    pairs = zip(features, features_hat, strict=True)
    return torch.stack([(matrix(f) - matrix(g)).abs().mean() for f, g in pairs]).sum()


def as_printed(features: Maps, features_hat: Maps) -> Tensor:
    """F F^T without a divisor."""
    return compared(features, features_hat, lambda f: gram(f) * f[0].numel())


def by_places_only(features: Maps, features_hat: Maps) -> Tensor:
    """Divided by the number of places, not by that of channels."""
    return compared(features, features_hat, lambda f: gram(f) * f.shape[1])


def places_by_places(features: Maps, features_hat: Maps) -> Tensor:
    """F^T F: which places are alike."""
    return compared(features, features_hat, lambda f: f.flatten(2).mT @ f.flatten(2) / f[0].numel())


def centred(features: Maps, features_hat: Maps) -> Tensor:
    """The covariance: each channel's mean is taken off."""
    return compared(features, features_hat, lambda f: gram(f - f.mean(dim=(2, 3), keepdim=True)))


def pictures_mixed(features: Maps, features_hat: Maps) -> Tensor:
    """One Gram matrix for the whole batch."""
    return compared(
        features, features_hat, lambda f: gram(f.movedim(1, 0).flatten(1)[None, :, :, None])
    )


def squared(features: Maps, features_hat: Maps) -> Tensor:
    """Squares instead of absolute values."""
    pairs = zip(features, features_hat, strict=True)
    return torch.stack([(gram(f) - gram(g)).square().mean() for f, g in pairs]).sum()


TEXTURE = Exercise(
    id="04-2",
    title="texture without place",
    reference=style_loss,
    inputs=map_inputs,
    oracle=map_oracle,
    minutes=12,
    difficulty=2,
    equation="MDD Eq. B19",
    helpers=(gram,),
    mutants=(
        Mutant(
            as_printed,
            "You compare F F^T itself, as it is printed; divide it by channels x height x width.",
        ),
        Mutant(
            by_places_only,
            "You divide by height x width; the authors divide by the number of channels, too.",
        ),
        Mutant(
            places_by_places,
            "Your matrix compares places with places: put the transposed map second, so that "
            "places are summed over and channels stay.",
        ),
        Mutant(
            centred,
            "You take the mean of each channel off, which makes a covariance; a Gram matrix "
            "leaves the channels as they are.",
        ),
        Mutant(
            pictures_mixed,
            "You make one matrix for the whole batch; every picture has one of its own.",
        ),
        Mutant(squared, "You square the differences; the paper takes absolute values."),
        Mutant(
            perceptual_loss,
            "You compare the maps place by place; make Gram matrices of them first.",
        ),
    ),
    hints=(
        "The lists hold maps (batch, c, h, w). `flat = f.flatten(2)` lays the places in a row: "
        "(batch, c, h w). That is F.",
        "`flat @ flat.mT` is F F^T of every picture, (batch, c, c). Divide it by `f[0].numel()`.",
        "Do this for both maps of a pair, take `.abs().mean()` of the difference, and add up over "
        "the pairs: `sum(... for f, f_hat in zip(features, features_hat))`.",
    ),
)
