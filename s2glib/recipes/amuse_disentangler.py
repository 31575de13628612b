"""Train the speech disentangler: the full-factor swap (ours), or the paper's quadruples.

Paper:    AM B.4
Notebook: notebooks/09_disentanglement.ipynb
"""

from functools import partial
from typing import Literal, NamedTuple

import numpy as np
import torch
from accelerate import Accelerator
from torch import Tensor, nn

from s2glib.corpus.build import Request, speech_set
from s2glib.corpus.script import split
from s2glib.data.windows import noise_floor
from s2glib.papers.amuse.augmentation import gain_and_tilt, mask, shift
from s2glib.papers.amuse.config import SPEECH_PRESETS, SpeechConfig
from s2glib.papers.amuse.cross_reconstruction import (
    Donors,
    factor_swap_losses,
    quadruple_losses,
)
from s2glib.papers.amuse.disentangler import SpeechDisentangler, SpeechLatents
from s2glib.papers.amuse.front_end import standardized
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.speech_data import FactorBatch, FactorTable, QuadrupleBatch
from s2glib.recipes.stage import Stage

FACTOR_SWAP = Course(steps=6000, batch=32, learning_rate=1.5e-3, betas=(0.9, 0.98), warm_up=40)
QUADRUPLES = Course(steps=2000, batch=6, learning_rate=6e-4, betas=(0.9, 0.98), warm_up=40)
CYCLE_FROM = 0.65  # share of the course after which decoded speech must be recognised


class FactorSwapStep(NamedTuple):
    """A batch and whether the cycle term counts yet."""

    batch: FactorBatch
    cycle: bool


class FactorSwapObjective(nn.Module):
    """Holds the model; one call is one forward pass of the full-factor swap."""

    def __init__(self, model: SpeechDisentangler):
        super().__init__()
        self.model = model

    def forward(self, step: FactorSwapStep) -> tuple[Tensor, dict[str, Tensor]]:
        """The weighted loss and its terms."""
        target, donors, emotion, style = step.batch
        losses = factor_swap_losses(self.model, target, donors, emotion, style, cycle=step.cycle)
        return losses.total(), losses._asdict()


class QuadrupleObjective(nn.Module):
    """Holds the model; one call is one forward pass of the paper's seven losses.

    Args:
        model: the disentangler.
        content_weight: of L_con; 1 is the paper's.
        reduction: mean (authors' code) or sum (as printed).
    """

    def __init__(
        self,
        model: SpeechDisentangler,
        *,
        content_weight: float = 1.0,
        reduction: Literal["mean", "sum"] = "mean",
    ):
        super().__init__()
        self.model, self.content_weight = model, content_weight
        self.reduction: Literal["mean", "sum"] = reduction

    def forward(self, batch: QuadrupleBatch) -> tuple[Tensor, dict[str, Tensor]]:
        """The weighted loss and its terms."""
        losses = quadruple_losses(self.model, *batch, reduction=self.reduction)
        return losses.total(content=self.content_weight), losses._asdict()


def draw_factor_swap(
    table: FactorTable, model: SpeechDisentangler, course: Course, chance: Chance
) -> FactorSwapStep:
    """Targets stay clean; donors are augmented, each in the way its factor allows."""
    batch = table.factor_batch(course.batch, chance.rng)
    config, generator = model.config, chance.generator
    silence = standardized(noise_floor(config.n_mels), config)

    def heard(x: Tensor, *, gain: float, tilt: float, moved: bool) -> Tensor:
        if moved:
            x = shift(x, silence, earliest=100, latest=12, generator=generator)
        x = gain_and_tilt(x, config.std, gain=gain, tilt=tilt, generator=generator)
        return mask(x, longest=30, widest=8, generator=generator)

    donors = Donors(
        content=heard(batch.donors.content, gain=1.0, tilt=0.3, moved=False),
        emotion=heard(batch.donors.emotion, gain=0.7, tilt=0.2, moved=True),
        style=heard(batch.donors.style, gain=0.7, tilt=0.2, moved=True),
    )
    return FactorSwapStep(batch._replace(donors=donors), chance.progress >= CYCLE_FROM)


def factor_table(name: str, config: SpeechConfig) -> FactorTable:
    """The clips of a split as standardised windows."""
    cells = split(name)
    speech = speech_set([Request(cell) for cell in cells], config.window)
    windows = torch.from_numpy(speech.windows)
    return FactorTable(cells, ((windows - config.mean) / (2 * config.std)).half())


@torch.no_grad()
def encode_all(model: SpeechDisentangler, table: FactorTable, batch: int = 128) -> SpeechLatents:
    """Latents of every clip of a table, computed on the GPU where there is one."""
    place = Accelerator().device
    model.eval().to(place)
    parts = [
        model.encode(table.clips(index).to(place))
        for index in np.array_split(np.arange(len(table.factors)), len(table.factors) // batch + 1)
    ]
    model.cpu()
    return SpeechLatents(*(torch.cat(latents).cpu() for latents in zip(*parts, strict=True)))


def accuracies(model: SpeechDisentangler, table: FactorTable) -> dict[str, float]:
    """EA and SA on a table of clips, in percent."""
    latents = encode_all(model, table)
    labels = torch.from_numpy(table.factors)
    right = {
        "EA": model.emotion_head(latents.emotion).argmax(-1) == labels[:, 2],
        "SA": model.style_head(latents.style).argmax(-1) == labels[:, 1],
    }
    return {name: 100 * float(hits.float().mean()) for name, hits in right.items()}


def train(stage: Stage) -> None:
    """The stage `amuse-disentangler`: train, remember the emotions' centres, publish."""
    torch.manual_seed(stage.seed)
    model = SpeechDisentangler(SPEECH_PRESETS[stage.preset])
    table = factor_table("train", model.config)
    course = stage.course(FACTOR_SWAP)
    draw = partial(draw_factor_swap, table, model, course)
    kept, record = stage.train("amuse-disentangler", FactorSwapObjective(model), course, draw)
    model = kept.model.eval()
    model.remember_emotions(encode_all(model, table).emotion, torch.from_numpy(table.factors[:, 2]))
    figures = accuracies(model, factor_table("validation", model.config))
    stage.publish("amuse-disentangler", model, record, figures)
