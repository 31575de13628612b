"""Train the listener for stressed vowels on the corpus' exact times.

Paper:    -
Notebook: notebooks/13_latent_diffusion.ipynb
"""

from functools import partial
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.corpus.script import Cell, split
from s2glib.papers.amuse.augmentation import gain_and_tilt
from s2glib.papers.amuse.config import SPEECH_PRESETS, SpeechConfig
from s2glib.papers.amuse.stress_listener import (
    StressConfig,
    StressListener,
    stress_loss,
    stress_targets,
)
from s2glib.recipes.amuse_disentangler import factor_table
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.speech_data import FactorTable, stress_times
from s2glib.recipes.stage import Stage

STRESS = Course(steps=1500, batch=48, learning_rate=2e-3, warm_up=50)


class StressStep(NamedTuple):
    """Speech and where its beats are."""

    filterbank: Float[Tensor, "batch frames mels"]
    targets: Float[Tensor, "batch frames"]


class StressObjective(nn.Module):
    """Holds the listener."""

    def __init__(self, model: StressListener):
        super().__init__()
        self.model = model

    def forward(self, step: StressStep) -> tuple[Tensor, dict[str, Tensor]]:
        """The loss."""
        loss = stress_loss(self.model.logits(step.filterbank), step.targets)
        return loss, {"stress": loss}


def true_stresses(cells: list[Cell], config: SpeechConfig) -> Float[Tensor, "n frames"]:
    """Targets for the windows of cells."""
    return stress_targets(stress_times(cells), config.frames, 100 / config.pool)


def draw_stress(
    table: FactorTable, targets: Tensor, std: float, course: Course, chance: Chance
) -> StressStep:
    """Clips a little louder or softer, brighter or darker."""
    index = chance.rng.integers(len(table.factors), size=course.batch)
    heard = gain_and_tilt(table.clips(index), std, gain=2.0, tilt=0.5, generator=chance.generator)
    return StressStep(heard, targets[torch.from_numpy(index)])


@torch.no_grad()
def stress_correlation(listener: StressListener, heard: Tensor, targets: Tensor) -> float:
    """Correlation between heard and true stress over all frames."""
    heard = torch.cat([listener(x.float()) for x in heard.split(128)])
    return float(torch.corrcoef(torch.stack([heard.flatten(), targets.flatten()]))[0, 1])


def train_stress(stage: Stage) -> None:
    """Train and publish `amuse-stress`."""
    torch.manual_seed(stage.seed)
    config = SPEECH_PRESETS[stage.preset]
    listener = StressListener(StressConfig(n_mels=config.n_mels))
    table, course = factor_table("train", config), stage.course(STRESS)
    draw = partial(draw_stress, table, true_stresses(split("train"), config), config.std, course)
    kept, record = stage.train("amuse-stress", StressObjective(listener), course, draw)
    held_out = factor_table("validation", config).windows
    figures = {
        "correlation with true stress": stress_correlation(
            kept.model.eval(), held_out, true_stresses(split("validation"), config)
        )
    }
    stage.publish("amuse-stress", kept.model, record, figures)
