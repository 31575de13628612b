"""Exercise 07-2: the loss of Eq. 10, part by part, where nothing is known.

Paper:    PT Eq. 10; the mean over parts: authors' code
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.papers.probtalk import PARTS, HolisticFeatures, RefinerLosses, refiner_losses
from s2glib.teaching.exercises.exercise import Exercise, Mutant

FEATURES = HolisticFeatures(expression=4)
GRAINS = ("jaw", "body", "hands", "expression")
Case = tuple[Tensor, Tensor, Tensor, HolisticFeatures]


def loss_inputs(rng: np.random.Generator) -> Iterator[Case]:
    """Four frames of which two are known; then two clips with parts of them known."""
    motion = torch.zeros(1, 4, FEATURES.size, dtype=torch.float64)
    refined = motion.clone()
    for error, name in enumerate(GRAINS, start=1):
        refined[:, 2:, FEATURES.parts[name]] = 0.1 * error
    refined[:, 1] = 0.5
    yield motion, refined, _known([[True] * 4, [True] * 4, [False] * 4, [False] * 4]), FEATURES
    motion, refined = (torch.tensor(rng.normal(size=(2, 5, FEATURES.size))) for _ in range(2))
    parts = rng.random((2, 5, len(PARTS))) < 0.5
    parts[..., 0] = True  # the face is known throughout
    yield motion, refined, FEATURES.of_parts(torch.tensor(parts)), FEATURES


def _known(parts: list[list[bool]]) -> Tensor:
    return FEATURES.of_parts(torch.tensor(parts))[None]


def loss_oracle(
    motion: Tensor, refined: Tensor, known: Tensor, features: HolisticFeatures
) -> RefinerLosses:
    """NumPy, part by part and clip by clip."""
    apart, unknown = (motion - refined).numpy(), ~known.numpy()
    means = []
    for name in GRAINS:
        where = features.parts[name]
        found = np.abs(apart[..., where][unknown[..., where]])
        means.append(found.mean() if found.size else 0.0)
    steps = np.concatenate([np.abs(np.diff(clip, axis=0)) for clip in apart])
    return RefinerLosses(*torch.tensor([*means, steps.mean()], dtype=motion.dtype))


def on_known(
    motion: Tensor, refined: Tensor, known: Tensor, features: HolisticFeatures
) -> RefinerLosses:
    """The text's reading: compared where the input already is the truth."""
    return refiner_losses(motion, refined, known, features, region="known")


def over_all(
    motion: Tensor, refined: Tensor, known: Tensor, features: HolisticFeatures
) -> RefinerLosses:
    """Sums over unknown numbers, divided by how many there are in all."""
    right = refiner_losses(motion, refined, known, features)
    shares = (float((~known[..., features.parts[name]]).to(motion).mean()) for name in GRAINS)
    parts = {n: getattr(right, n) * share for n, share in zip(GRAINS, shares, strict=True)}
    return right._replace(**parts)


def together(
    motion: Tensor, refined: Tensor, known: Tensor, features: HolisticFeatures
) -> RefinerLosses:
    """One mean over all unknown numbers, whatever part they belong to."""
    whole = (motion - refined)[~known].abs().mean()
    velocity = refiner_losses(motion, refined, known, features).velocity
    return RefinerLosses(whole, whole, whole, whole, velocity)


def across_clips(
    motion: Tensor, refined: Tensor, known: Tensor, features: HolisticFeatures
) -> RefinerLosses:
    """The clips of a batch stand in a row, and the step from one to the next counts."""
    right = refiner_losses(motion, refined, known, features)
    steps = (motion - refined).flatten(0, 1).diff(dim=0)
    return right._replace(velocity=steps.abs().mean())


def velocity_inside(
    motion: Tensor, refined: Tensor, known: Tensor, features: HolisticFeatures
) -> RefinerLosses:
    """The mask cuts the velocity, too."""
    right = refiner_losses(motion, refined, known, features)
    both = ~(known[:, 1:] | known[:, :-1])
    steps = (motion - refined).diff(dim=-2).abs() * both
    return right._replace(velocity=steps.sum() / both.sum())


def squared(
    motion: Tensor, refined: Tensor, known: Tensor, features: HolisticFeatures
) -> RefinerLosses:
    """Squares where absolute values should be."""
    apart = motion - refined
    parts = {name: features.parts[name] for name in GRAINS}
    means = {
        name: torch.nan_to_num(apart[..., where][~known[..., where]].square().mean())
        for name, where in parts.items()
    }
    return RefinerLosses(**means, velocity=apart.diff(dim=-2).square().mean())


def nothing_divided(
    motion: Tensor, refined: Tensor, known: Tensor, features: HolisticFeatures
) -> RefinerLosses:
    """The mean of no numbers is NaN."""
    right = refiner_losses(motion, refined, known, features)
    empty = [name for name in GRAINS if known[..., features.parts[name]].all()]
    return right._replace(**{name: torch.nan * getattr(right, name) for name in empty})


COMPARE = Exercise(
    id="07-2",
    title="part by part, where nothing is known",
    reference=refiner_losses,
    inputs=loss_inputs,
    oracle=loss_oracle,
    minutes=12,
    difficulty=3,
    equation="PT Eq. 10",
    mutants=(
        Mutant(
            on_known,
            "You compare where the motion is known: there the input is the truth already. Take the "
            "rest, `~known`.",
        ),
        Mutant(
            over_all,
            "You sum over unknown numbers and divide by all: divide by how many are unknown.",
        ),
        Mutant(
            together,
            "You take one mean over all parts, in which six numbers of the jaw drown: take each "
            "part's own.",
        ),
        Mutant(
            across_clips,
            "Your velocity runs across the clips' borders: the last frame of one clip and the "
            "first of the next have nothing to do with each other.",
        ),
        Mutant(
            velocity_inside,
            "Your velocity leaves known frames out, and with them the step at the border: its term "
            "has no mask.",
        ),
        Mutant(squared, "You take squares; Eq. 10 takes absolute values, L1."),
        Mutant(
            nothing_divided,
            "Where a part is known throughout you divide by 0: let the count be at least 1.",
        ),
    ),
    hints=(
        "`unknown = (~known).to(motion)` is a mask to multiply with; `apart = motion - refined` is "
        "what to mask.",
        "For a part: `where = features.parts[name]`; then `(unknown * apart)[..., where].abs()"
        ".sum()` over `unknown[..., where].sum().clamp_min(1)`.",
        "Velocity: `apart.diff(dim=-2).abs().mean()`, the difference of velocities being the "
        "velocity of the difference. Put all into `RefinerLosses(jaw=..., body=..., hands=..., "
        "expression=..., velocity=...)`.",
    ),
)
