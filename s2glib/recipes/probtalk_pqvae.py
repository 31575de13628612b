"""Train the PQ-VAE on windows of holistic motion.

Paper:    PT A.1
Notebook: notebooks/05_product_codes.ipynb
"""

from functools import partial
from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.checkpoint import load_checkpoint
from s2glib.corpus.script import split
from s2glib.papers.probtalk import (
    PQVAE,
    PQVAE_PRESETS,
    HolisticFeatures,
    PQVAEConfig,
    pqvae_losses,
)
from s2glib.recipes.code_scores import code_scores
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.holistic_data import HolisticClips, fitted_features, holistic_clips
from s2glib.recipes.motion_data import motion_cells
from s2glib.recipes.stage import Stage

COURSES = {
    "paper": Course(  # Adam at a constant rate, batch 128: authors' code; so many steps: ours
        steps=40_000,
        batch=128,
        learning_rate=1e-4,
        weight_decay=0.0,
        warm_up=1,
        last_rate=1.0,
        clip=1e9,  # the code clips before there are gradients
    ),
    "teaching": Course(steps=6000, batch=32, learning_rate=3e-3, weight_decay=1e-4),
}
STARTING = 800  # windows that principal components are taken of
FRAMES = {"paper": 176, "teaching": 96}  # of a training window; authors' code, ours


class PQVAEObjective(nn.Module):
    """Holds the PQ-VAE; one call is one forward pass."""

    def __init__(self, model: PQVAE):
        super().__init__()
        self.model = model

    def forward(
        self, motion: Float[Tensor, "batch frames size"]
    ) -> tuple[Tensor, dict[str, Tensor]]:
        """The weighted loss and its terms."""
        losses, config = pqvae_losses(self.model, motion), self.model.config
        total = losses.total(
            commitment=config.commitment, wrists=config.wrists, movement=config.movement
        )
        return total, losses._asdict()


def draw(
    clips: HolisticClips, frames: int, course: Course, chance: Chance
) -> Float[Tensor, "batch frames size"]:
    """Windows that start anywhere in any clip."""
    rows = chance.rng.integers(len(clips.cells), size=course.batch)
    return clips.moving(rows, clips.any_offset(rows, frames, chance.rng), frames)


def fit_pqvae(
    stage: Stage, part: str, model: PQVAE, course: Course, clips: HolisticClips
) -> tuple[PQVAE, dict[str, Any]]:
    """A trained PQ-VAE and the record of its run."""
    drawn = partial(draw, clips, FRAMES[stage.preset], course)
    kept, record = stage.train(part, PQVAEObjective(model), course, drawn)
    return kept.model.eval(), record


def new_pqvae(
    config: PQVAEConfig, seed: int, features: HolisticFeatures, clips: HolisticClips
) -> PQVAE:
    """An untrained PQ-VAE with the statistics of `features`; straight paths begin as components."""
    torch.manual_seed(seed)
    model = PQVAE(config)
    model.features.load_state_dict(features.state_dict())
    rng = np.random.default_rng(seed)
    rows = rng.permutation(len(clips.cells))[:STARTING]
    model.start_straight(
        clips.moving(rows, clips.any_offset(rows, config.frames, rng), config.frames)
    )
    return model


def trained_pqvae(stage: Stage, size: int) -> PQVAE:
    """The PQ-VAE in a stage's folder, frozen.

    Args:
        stage: that builds on it.
        size: numbers a frame that the stage's networks see.

    Raises:
        FileNotFoundError: if there is none.
        ValueError: if it sees others; it is of another preset then.
    """
    path = stage.folder / "checkpoints" / "probtalk-pqvae.safetensors"
    pqvae = load_checkpoint(path, PQVAE).requires_grad_(False)
    if pqvae.config.size != size:
        raise ValueError(
            f"{stage.name} in the {stage.preset} preset sees {size} numbers a frame, {path} "
            f"{pqvae.config.size}; train probtalk-pqvae with --preset {stage.preset} first"
        )
    return pqvae


def train(stage: Stage) -> None:
    """The stage `probtalk-pqvae`."""
    config, cells = PQVAE_PRESETS[stage.preset], motion_cells()
    features = fitted_features(cells, config)
    course = stage.course(COURSES[stage.preset])
    clips = holistic_clips(cells, features)
    model = new_pqvae(config, stage.seed, features, clips)
    model, record = fit_pqvae(stage, stage.name, model, course, clips)
    scores = code_scores(model, holistic_clips(split("validation"), features))
    figures = {
        "wrist error in cm": float(scores.wrist.mean()),
        "part-wise error": float(scores.parts.mean()),
        "perplexity / codes": float(scores.usage.min()),
    }
    stage.publish(stage.name, model, record, figures)
