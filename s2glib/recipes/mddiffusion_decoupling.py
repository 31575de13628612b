"""Train the motion decoupler on pairs of frames of one clip.

The paper has no labels and much time. Where films come with keypoints, the teaching size first
learns to put its own on the limbs; without, it begins with points on what moves.

Paper:    MDD B.1, B.5
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.folders import cache_folder
from s2glib.layers import PyramidFeatures, load_public, vgg19_features
from s2glib.papers.mddiffusion import (
    DECOUPLING_PRESETS,
    DecouplingConfig,
    MotionDecoupler,
    decoupling_losses,
    label_error,
)
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.footage import train_and_test
from s2glib.recipes.image_augmentation import Augmentation
from s2glib.recipes.limb_points import ALONG, LIMBS, limb_points, mirrored_keypoints
from s2glib.recipes.stage import Stage
from s2glib.recipes.video_data import VideoFrames, starting_keypoints
from s2glib.recipes.video_scores import film_errors, wrists_explained
from s2glib.warping import ThinPlateSpline, random_tps

VGG_19 = "weights/vgg19-dcbb9e9d.pth"  # in the cache folder, if the reader has put it there
DROPOUT = 0.5  # share of the warps; authors' code
DROPOUT_RISES, DROPOUT_ENDS = 0.05, 0.175  # shares of the course; authors' code
MEASURED = ("made", "warped", "mean")


@dataclass(frozen=True)
class Lesson:
    """How the decoupler is taught.

    Attributes:
        course: steps, batch, rates.
        weights: of the loss terms, see `DecouplingLosses.total`.
        moving: how much more the moving quarter of a clip's pixels counts (ours).
        near: without labels, frames between source and driving at first, and the share of the
            course by which it is any number; None: any from the start.
        labelled: how keypoints are first put on the limbs, where films have labels (ours).
    """

    course: Course
    weights: dict[str, float] = field(default_factory=dict)
    moving: float = 0.0
    near: tuple[int, float] | None = None
    labelled: Course | None = None


LESSONS = {
    "paper": Lesson(  # rate and betas [MDD B.5]; batch, decay and the weights of 10: authors' code
        Course(steps=100_000, batch=20, learning_rate=2e-4, betas=(0.5, 0.999), weight_decay=1e-4),
        {"perceptual": 10.0, "equivariance": 10.0, "warp": 10.0},
    ),
    "teaching": Lesson(
        Course(steps=6000, batch=8, learning_rate=1e-3, betas=(0.5, 0.999), weight_decay=1e-4),
        {"perceptual": 1.0, "warped": 1.0, "equivariance": 0.5, "warp": 0.1, "labelled": 10.0},
        moving=6.0,
        near=(10, 0.4),
        labelled=Course(steps=2000, batch=16, learning_rate=1e-3),
    ),
}


class DecouplingStep(NamedTuple):
    """A batch, and the random choices that go with it."""

    source: Float[Tensor, "batch 3 size size"]
    driving: Float[Tensor, "batch 3 size size"]
    weight: Float[Tensor, "batch 1 size size"]
    labels: Float[Tensor, "batch k n 2"] | None
    bend: ThinPlateSpline
    dropout: float


class LabelledPictures(NamedTuple):
    """Pictures, and where their keypoints should be."""

    pictures: Float[Tensor, "batch 3 size size"]
    labels: Float[Tensor, "batch k n 2"]


class DecouplingObjective(nn.Module):
    """Holds the model; one call rebuilds driving pictures and weighs what went wrong."""

    def __init__(self, model: MotionDecoupler, features: nn.Module, weights: dict[str, float]):
        super().__init__()
        self.model, self.features, self.weights = model, features, weights

    def forward(self, step: DecouplingStep) -> tuple[Tensor, dict[str, Tensor]]:
        """The weighted loss and its terms."""
        losses = decoupling_losses(
            self.model,
            step.source,
            step.driving,
            self.features,
            step.bend,
            dropout=step.dropout,
            weight=step.weight,
            match_warped="warped" in self.weights,
            labels=step.labels,
        )
        return losses.total(**self.weights), losses._asdict()


class LabelObjective(nn.Module):
    """Holds the keypoint predictor; one call compares its keypoints with labels."""

    def __init__(self, keypoints: nn.Module):
        super().__init__()
        self.keypoints = keypoints

    def forward(self, step: LabelledPictures) -> tuple[Tensor, dict[str, Tensor]]:
        """The error, which is the only term."""
        error = label_error(self.keypoints(step.pictures), step.labels)
        return error, {"labelled": error}


def draw(video: VideoFrames, lesson: Lesson, labelled: bool, chance: Chance) -> DecouplingStep:
    """Pairs of frames, each mirrored and coloured by chance; a bend; how many warps may drop out.

    Without labels pairs are near ones at first. With labels every limb has one warp, for which no
    other can stand in: none drops out.
    """
    count, longest = lesson.course.batch, int(video.lengths.max())
    furthest = longest if labelled else reach(lesson, chance.progress, longest)
    source, driving, clips = video.pairs(count, chance.rng, furthest=furthest)
    augmentation = Augmentation.draw(count, chance.rng)
    return DecouplingStep(
        augmentation.change(video.images(source)),
        augmentation.change(video.images(driving)),
        augmentation.mirror(1 + lesson.moving * video.moving(clips)),
        labels_of(video, driving, augmentation) if labelled else None,
        random_tps(count, generator=chance.generator),
        0.0 if labelled else warp_dropout(chance.progress),
    )


def draw_labelled(video: VideoFrames, course: Course, chance: Chance) -> LabelledPictures:
    """Frames, mirrored and coloured by chance, and their labels."""
    rows = chance.rng.integers(len(video.frames), size=course.batch)
    augmentation = Augmentation.draw(course.batch, chance.rng)
    pictures = augmentation.change(video.images(rows))
    return LabelledPictures(pictures, labels_of(video, rows, augmentation))


def labels_of(
    video: VideoFrames, rows: np.ndarray, augmentation: Augmentation
) -> Float[Tensor, "batch k n 2"]:
    """Points on the limbs, as they are seen in the augmented pictures."""
    there = video.keypoints[rows]
    mirrored = augmentation.mirrored[:, None, None]
    return limb_points(torch.where(mirrored, mirrored_keypoints(there), there))


def reach(lesson: Lesson, progress: float, longest: int) -> int:
    """How many frames may lie between source and driving: grows in proportion."""
    if lesson.near is None:
        return longest
    first, by = lesson.near
    return round(first * (longest / first) ** min(1.0, progress / by))


def warp_dropout(progress: float) -> float:
    """TPS dropout: rises, stays, and ends  (authors' code; epochs 10 and 35 of 200)."""
    if progress >= DROPOUT_ENDS:
        return 0.0
    return DROPOUT * min(1.0, progress / DROPOUT_RISES)


def picture_features(preset: str) -> nn.Module:
    """VGG-19 for the paper's preset if its public file is there, else colours and edges."""
    path = cache_folder() / VGG_19
    if preset != "paper" or not path.exists():
        return PyramidFeatures()
    features = vgg19_features()
    load_public(features, path)
    return features


def fit_decoupler(
    stage: Stage, part: str, config: DecouplingConfig, lesson: Lesson, video: VideoFrames
) -> tuple[MotionDecoupler, dict[str, Any]]:
    """A decoupler trained on films, and the record of its run."""
    torch.manual_seed(stage.seed)
    model = MotionDecoupler(config)
    labels = lesson.labelled if has_labels(video, config) else None
    labelled = labels is not None
    if stage.preset != "paper":
        model.keypoints.start_at(first_keypoints(video, config, labelled, stage.seed))
    before = put_on_limbs(stage, part, model, labels, video) if labels else {}
    model, record = teach(stage, part, model, lesson, video, labelled=labelled)
    return model, record | before


def teach(
    stage: Stage,
    part: str,
    model: MotionDecoupler,
    lesson: Lesson,
    video: VideoFrames,
    *,
    labelled: bool,
) -> tuple[MotionDecoupler, dict[str, Any]]:
    """A decoupler after the course, and the record of its run."""
    objective = DecouplingObjective(model, picture_features(stage.preset), lesson.weights)
    course = stage.course(lesson.course)
    kept, record = stage.train(part, objective, course, partial(draw, video, lesson, labelled))
    return kept.model.eval(), record


def has_labels(video: VideoFrames, config: DecouplingConfig) -> bool:
    """Whether keypoints are known somewhere, and the model has as many as limbs have."""
    groups = (config.transforms, config.points)
    return groups == (len(LIMBS), len(ALONG)) and bool(video.keypoints.isfinite().any())


def first_keypoints(
    video: VideoFrames, config: DecouplingConfig, labelled: bool, seed: int
) -> Float[Tensor, "k n 2"]:
    """Where keypoints begin: at the labels' mean places, or where something moves."""
    if labelled:
        return limb_points(video.keypoints).nanmean(dim=0)
    rng = np.random.default_rng(seed)
    return starting_keypoints(video, config.transforms, config.points, rng)


def put_on_limbs(
    stage: Stage, part: str, model: MotionDecoupler, course: Course, video: VideoFrames
) -> dict[str, Any]:
    """Teach the keypoint predictor the labels; the record of that, for the run's record.

    A step costs a tenth of the decoupler's, so a short run has four times as many of them.
    """
    steps = min(course.steps, 4 * (stage.steps or course.steps))
    course = replace(course, seed=stage.seed, steps=steps)
    drawn = partial(draw_labelled, video, course)
    kept, record = stage.train(f"{part}-labels", LabelObjective(model.keypoints), course, drawn)
    model.keypoints.load_state_dict(kept.keypoints.state_dict())
    return {"labels": record}


def train(stage: Stage) -> None:
    """The stage `mddiffusion-decoupling`."""
    config = DECOUPLING_PRESETS[stage.preset]
    video, test = train_and_test(stage.data, config.size)
    model, record = fit_decoupler(stage, stage.name, config, LESSONS[stage.preset], video)
    stage.publish(stage.name, model, record, decoupler_figures(model, video, test))


def decoupler_figures(
    model: MotionDecoupler, video: VideoFrames, test: VideoFrames
) -> dict[str, float]:
    """How well held-out films are rebuilt, and whether wrists are in the keypoints."""
    shares = film_errors(model, test).moving.shares()
    figures = {f"{name} / copied": shares[name] for name in shares if name in MEASURED}
    if video.has_keypoints and test.has_keypoints:
        figures["wrists R2"] = float(wrists_explained(model.keypoints, video, test).mean())
    return figures
