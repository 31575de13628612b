"""Train the refinement network and its discriminator on what the decoupler makes.

Both take their step together. Masks of hands and faces are exact where the renderer knows them; of
films without such masks, hands and faces weigh no more than anything else.

Paper:    MDD B.3, B.5
Notebook: notebooks/04_repairing_pixels.ipynb
"""

from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.checkpoint import load_checkpoint
from s2glib.folders import cache_folder
from s2glib.layers import PyramidFeatures, load_public, vgg16_features
from s2glib.losses import discriminator_loss
from s2glib.papers.mddiffusion import (
    REFINEMENT_PRESETS,
    Masks,
    MotionDecoupler,
    PatchDiscriminator,
    RefinementNet,
    refinement_losses,
)
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.footage import train_and_test
from s2glib.recipes.stage import Stage
from s2glib.recipes.video_data import VideoFrames
from s2glib.recipes.video_scores import film_errors

MEASURED = ("made", "refined")
VGG_16 = "weights/vgg16-397923af.pth"  # in the cache folder, if the reader has put it there


@dataclass(frozen=True)
class Lesson:
    """How refinement is taught: the course, and weights other than the paper's."""

    course: Course
    weights: dict[str, float] = field(default_factory=dict)


LESSONS = {
    "paper": Lesson(  # rates and betas [MDD B.5]; batch, decay: authors' code
        Course(
            steps=50_000,
            batch=20,
            learning_rate=2e-4,
            betas=(0.5, 0.999),
            weight_decay=1e-4,
            slower={"discriminator": 0.2},
        )
    ),
    "teaching": Lesson(  # rates: authors' code
        Course(
            steps=4000,
            batch=8,
            learning_rate=6e-4,
            betas=(0.5, 0.999),
            weight_decay=1e-4,
            slower={"discriminator": 1 / 6},
        ),
        {"perceptual": 1.0, "style": 20.0},  # of colours and edges, not of VGG-16
    ),
}


class RefinementStep(NamedTuple):
    """Frames, and where in the driving ones hands and face are."""

    source: Float[Tensor, "batch 3 size size"]
    driving: Float[Tensor, "batch 3 size size"]
    hand: Float[Tensor, "batch 1 size size"]
    face: Float[Tensor, "batch 1 size size"]


class RefinementObjective(nn.Module):
    """Holds both networks, and the decoupler that stays as it is.

    Args:
        model: the refinement network.
        discriminator: its critic.
        decoupler: trained.
        features: what pictures are compared by.
        weights: of the loss terms, see `RefinementLosses.total`.
    """

    def __init__(
        self,
        model: RefinementNet,
        discriminator: PatchDiscriminator,
        decoupler: MotionDecoupler,
        features: nn.Module,
        weights: dict[str, float],
    ):
        super().__init__()
        self.model, self.discriminator = model, discriminator
        self.decoupler, self.features = decoupler.requires_grad_(False), features
        self.weights = weights

    def train(self, mode: bool = True) -> "RefinementObjective":
        """Training mode for the two networks; the decoupler keeps its statistics."""
        super().train(mode)
        self.decoupler.eval()
        return self

    def forward(self, step: RefinementStep) -> tuple[Tensor, dict[str, Tensor]]:
        """L_ref for the one, L_D for the other, and the terms."""
        with torch.no_grad():
            made = self.decoupler(step.source, step.driving)
        masks = Masks(made.flow.occlusion_masks[-1], step.hand, step.face)
        refined = self.model(made.synthesis.image, masks.visible)
        scores = self._scores_for_the_maker(refined)
        losses = refinement_losses(refined, step.driving, masks, self.features, scores)
        judged = self.discriminator(step.driving), self.discriminator(refined.detach())
        discriminator = discriminator_loss(*judged)
        loss = losses.total(**self.weights) + discriminator
        return loss, losses._asdict() | {"discriminator": discriminator}

    def _scores_for_the_maker(self, refined: Tensor) -> Tensor:
        """The critic's opinion, from which it does not learn itself."""
        self.discriminator.requires_grad_(False)
        scores = self.discriminator(refined)
        self.discriminator.requires_grad_(True)
        return scores


def draw(video: VideoFrames, lesson: Lesson, chance: Chance) -> RefinementStep:
    """Any two frames of a clip."""
    longest = int(video.lengths.max())
    source, driving, _ = video.pairs(lesson.course.batch, chance.rng, furthest=longest)
    pictures = video.images(source), video.images(driving)
    return RefinementStep(*pictures, video.hands(driving), video.faces(driving))


def picture_features(preset: str) -> nn.Module:
    """VGG-16 for the paper's preset if its public file is there, else colours and edges."""
    path = cache_folder() / VGG_16
    if preset != "paper" or not path.exists():
        return PyramidFeatures()
    features = vgg16_features()
    load_public(features, path)
    return features


def fit_refiner(
    stage: Stage,
    part: str,
    decoupler: MotionDecoupler,
    lesson: Lesson,
    video: VideoFrames,
    *,
    begun: RefinementNet | None = None,
) -> tuple[RefinementNet, dict[str, Any]]:
    """A refinement network trained on what a decoupler makes of films, and the run's record.

    It is a new one, unless another has `begun`.
    """
    torch.manual_seed(stage.seed)
    model = begun or RefinementNet(REFINEMENT_PRESETS[stage.preset])
    objective = RefinementObjective(
        model,
        PatchDiscriminator(model.config),
        decoupler,
        picture_features(stage.preset),
        lesson.weights,
    )
    course = stage.course(lesson.course)
    kept, record = stage.train(part, objective, course, partial(draw, video, lesson))
    return kept.model.eval(), record


def train(stage: Stage) -> None:
    """The stage `mddiffusion-refinement`; the decoupler's checkpoint must be there."""
    file = stage.folder / "checkpoints" / "mddiffusion-decoupling.safetensors"
    decoupler = load_checkpoint(file, MotionDecoupler)
    video, test = train_and_test(stage.data, decoupler.config.size)
    model, record = fit_refiner(stage, stage.name, decoupler, LESSONS[stage.preset], video)
    stage.publish(stage.name, model, record, refiner_figures(decoupler, model, test))


def refiner_figures(
    decoupler: MotionDecoupler, model: RefinementNet, test: VideoFrames
) -> dict[str, float]:
    """How well held-out films are rebuilt in each region, before and after refinement."""
    regions = film_errors(decoupler, test, model)._asdict()
    return {
        f"{region}, {name} / copied": share
        for region, errors in regions.items()
        for name, share in errors.shares().items()
        if name in MEASURED
    }
