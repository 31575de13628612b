"""Train the motion prior: the first half of the gesture generator.

Paper:    AM C.1
Notebook: notebooks/12_motion_prior.ipynb
"""

from functools import partial
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.corpus.script import split
from s2glib.layers import in_batches
from s2glib.papers.amuse.config import PRIOR_PRESETS
from s2glib.papers.amuse.motion_prior import MotionPrior, prior_losses
from s2glib.papers.amuse.temporal_prior import (
    TemporalMotionDecoder,
    TemporalMotionEncoder,
    start_from_components,
)
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.motion_data import MotionWindows, fit_features, motion_cells, motion_windows
from s2glib.recipes.stage import Stage

PRIOR = Course(
    steps=6000, batch=32, learning_rate=1e-3, weight_decay=1e-4, warm_up=100, last_rate=0.03
)
KL_RAMP = 300  # steps


class PriorStep(NamedTuple):
    """A batch of motion, the noise of the latent, and how much the KL term counts."""

    motion: Float[Tensor, "batch frames features"]
    generator: torch.Generator
    kl: float


class PriorObjective(nn.Module):
    """Holds the prior; one call is one forward pass."""

    def __init__(self, model: MotionPrior):
        super().__init__()
        self.model = model

    def forward(self, step: PriorStep) -> tuple[Tensor, dict[str, Tensor]]:
        """The weighted loss and its terms."""
        losses = prior_losses(self.model, step.motion, generator=step.generator)
        return losses.total(kl=step.kl), losses._asdict()


def draw_prior(
    windows: MotionWindows, course: Course, chance: Chance, kl_weight: float
) -> PriorStep:
    """Windows that start anywhere in any clip."""
    clips = chance.rng.integers(len(windows.cells), size=course.batch)
    motion = windows.window(clips, windows.any_offset(clips, chance.rng))
    step = chance.progress * course.steps
    return PriorStep(motion, chance.generator, kl_weight * min(1.0, step / KL_RAMP))


def start_linear(prior: MotionPrior, windows: MotionWindows, rng: np.random.Generator) -> None:
    """Start a prior that has linear paths from principal components (ours)."""
    encoder, decoder = prior.encoder, prior.decoder
    assert isinstance(encoder, TemporalMotionEncoder)
    assert isinstance(decoder, TemporalMotionDecoder)
    clips = rng.permutation(len(windows.cells))[:4096]
    start_from_components(encoder, decoder, windows.window(clips, windows.any_offset(clips, rng)))


@torch.no_grad()
def wrist_error(prior: MotionPrior, windows: MotionWindows, count: int = 512) -> float:
    """Centimetres between true and reconstructed wrists, in the first windows of clips."""
    prior.eval()
    motion = windows.first()[:count]
    both = (motion, in_batches(prior, motion))
    true, made = (prior.features.positions(x)[..., 5:7, :] for x in both)
    return 100 * float((true - made).norm(dim=-1).mean())


def train_prior(stage: Stage) -> MotionPrior:
    """Train and publish `amuse-prior`."""
    torch.manual_seed(stage.seed)
    cells = motion_cells()
    prior = MotionPrior(PRIOR_PRESETS[stage.preset])
    prior.features = fit_features(cells, prior.config.features)
    windows = motion_windows(cells, prior.features, prior.config.frames)
    if prior.config.backbone == "temporal":
        start_linear(prior, windows, np.random.default_rng(stage.seed))
    course = stage.course(PRIOR)
    draw = partial(draw_prior, windows, course, kl_weight=prior.config.kl_weight)
    kept, record = stage.train("amuse-prior", PriorObjective(prior), course, draw)
    validation = motion_windows(split("validation"), prior.features, prior.config.frames)
    figures = {"wrist error in cm": wrist_error(kept.model, validation)}
    stage.publish("amuse-prior", kept.model.eval(), record, figures)
    return kept.model
