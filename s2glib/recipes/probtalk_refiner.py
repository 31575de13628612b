"""Train the Refiner on motion that went through a frozen PQ-VAE's codes.

Paper:    PT A.3, Eqs. 8-10; masks, noise and rates: authors' code
Notebook: notebooks/07_refiner.ipynb
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from s2glib.corpus.script import TRAIN_SPEAKERS, split
from s2glib.layers import in_batches
from s2glib.papers.probtalk import HolisticFeatures
from s2glib.papers.probtalk.config import REFINER_PRESETS
from s2glib.papers.probtalk.keeping import eased
from s2glib.papers.probtalk.masking import part_contexts, window_contexts
from s2glib.papers.probtalk.refiner import Refiner, fill, refiner_losses
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.holistic_data import holistic_clips
from s2glib.recipes.holistic_seen import NINE, border_errors, joint_places
from s2glib.recipes.holistic_speech import hearing
from s2glib.recipes.motion_data import motion_cells
from s2glib.recipes.probtalk_pqvae import trained_pqvae
from s2glib.recipes.probtalk_predictor import PAPER_COURSE, PredictorData
from s2glib.recipes.stage import Stage

_SEED = 11


@dataclass(frozen=True)
class Lesson:
    """How the Refiner is taught.

    Attributes:
        course: steps, batch, rates.
        region: where it is compared with the truth: the "unknown" frames (authors' code) or the
            "known" ones (the text's Eq. 10).
        parts: contexts of any length and of single parts of the body (ours).
        seams: what is known is put back before velocities are compared, so that a jump between
            the two counts (ours).
    """

    course: Course
    region: Literal["unknown", "known"] = "unknown"
    parts: bool = False
    seams: bool = False


LESSONS = {
    "paper": Lesson(PAPER_COURSE),
    "teaching": Lesson(
        Course(steps=4000, batch=16, learning_rate=1e-3, betas=(0.9, 0.99)),
        parts=True,
        seams=True,
    ),
}


class RefinerStep(NamedTuple):
    """True motion, the same after the codes, and what goes with it."""

    motion: Float[Tensor, "batch frames features"]
    made: Float[Tensor, "batch frames features"]
    speech: Float[Tensor, "batch frames speech"]
    context_mask: Bool[Tensor, "batch frames parts"]
    speaker: Int[Tensor, " batch"]


class RefinerObjective(nn.Module):
    """Holds the Refiner; one call is one forward pass."""

    def __init__(self, model: Refiner, lesson: Lesson):
        super().__init__()
        self.model, self.lesson = model, lesson

    def forward(self, step: RefinerStep) -> tuple[Tensor, dict[str, Tensor]]:
        """Eq. 10 and its terms."""
        motion, made, *condition = step
        known = self.model.known(step.context_mask)
        refined = self.model(self.model.meet(motion, made, known), *condition)
        if self.lesson.seams:
            refined = fill(motion, refined, known)
        features, region = self.model.features, self.lesson.region
        losses = refiner_losses(motion, refined, known, features, region=region)
        return losses.total(), losses._asdict()


def draw(data: PredictorData, lesson: Lesson, noise: float, chance: Chance) -> RefinerStep:
    """Windows from anywhere, of which some motion is given; what the codes made is a little off."""
    count, generator = lesson.course.batch, chance.generator
    rows = chance.rng.integers(len(data.clips.cells), size=count)
    offsets = data.clips.any_offset(rows, data.frames, chance.rng)
    contexts = part_contexts if lesson.parts else window_contexts
    step = refiner_step(data, rows, offsets, contexts(count, data.frames, generator))
    return step._replace(made=step.made + noise * torch.randn(step.made.shape, generator=generator))


@torch.no_grad()
def refiner_step(
    data: PredictorData,
    rows: Int[np.ndarray, " n"],
    offsets: Int[np.ndarray, " n"],
    known: Bool[Tensor, "n frames 4"],
) -> RefinerStep:
    """Windows before and after their codes, their speech, and what is given of them."""
    step = data.step(rows, offsets, known)
    motion, made = data.clips.moving(rows, offsets, data.frames), data.pqvae.decode(step.target)
    return RefinerStep(motion, made, step.speech, step.context_mask, step.speaker)


class RefinerScores(NamedTuple):
    """Clip by clip, what is wrong with motion that was decoded from its codes.

    Attributes:
        error: mean absolute error of the features where they are unknown, before the clip's end.
        wrist: cm between true and made wrists in the chest's frame, in the same frames.
        border: see `border_errors`; head, arms and hands.
    """

    error: Float[np.ndarray, " n"]
    wrist: Float[np.ndarray, " n"]
    border: Float[np.ndarray, " n"]


@torch.no_grad()
def refiner_scores(data: PredictorData, refiner: Refiner) -> dict[str, RefinerScores]:
    """Errors in the first windows of clips, with 30 frames known.

    "pasted": what is known over what was decoded, as Eq. 8 has it; "eased": with a smooth way from
    one to the other; "refined".
    """
    count = len(data.clips.cells)
    rows, generator = np.arange(count), torch.Generator().manual_seed(_SEED)
    known = window_contexts(2 * count, data.frames, generator)[count:]
    step = in_batches(
        lambda rows, known: refiner_step(data, rows.numpy(), np.zeros(len(rows), int), known),
        torch.from_numpy(rows),
        known,
    )
    inside = refiner.known(step.context_mask)
    own = torch.arange(data.frames) < torch.from_numpy(data.clips.motion.lengths)[:, None]
    counted = ~inside & own[..., None]
    frames = own & ~known.any(-1)
    results = {
        "pasted": fill(step.motion, step.made, inside),
        "eased": eased(step.motion, step.made, inside),
        "refined": in_batches(refiner.eval().refine, *step),
    }
    real = joint_places(refiner.features, step.motion)[:, :, NINE]
    true_wrists = refiner.features.wrists(step.motion)
    scores = {}
    for name, motion in results.items():
        off = ((motion - step.motion).abs() * counted).sum((1, 2)) / counted.sum((1, 2))
        apart = 100 * (refiner.features.wrists(motion) - true_wrists).norm(dim=-1).mean(-1)
        wrist = (apart * frames).sum(1) / frames.sum(1)
        places = joint_places(refiner.features, motion)[:, :, NINE]
        border = border_errors(real, places, known.any(-1).numpy())
        scores[name] = RefinerScores(off.numpy(), wrist.numpy(), border)
    return scores


def train(stage: Stage) -> None:
    """The stage `probtalk-refiner`; the PQ-VAE must be there."""
    config, lesson = REFINER_PRESETS[stage.preset], LESSONS[stage.preset]
    pqvae = trained_pqvae(stage, HolisticFeatures(config.expression).size)
    lesson, heard = replace(lesson, course=stage.course(lesson.course)), hearing(stage.preset)
    config = replace(config, speech=heard.channels, speakers=len(TRAIN_SPEAKERS))
    torch.manual_seed(stage.seed)
    model = Refiner(config)
    model.features.load_state_dict(pqvae.features.state_dict())
    clips = holistic_clips(motion_cells(), pqvae.features, hear=heard.tracks)
    data = PredictorData(clips, pqvae, config.context_parts)
    objective, drawn = RefinerObjective(model, lesson), partial(draw, data, lesson, config.noise)
    kept, record = stage.train(stage.name, objective, lesson.course, drawn)
    refiner = kept.model.eval()
    held_out = holistic_clips(split("validation"), pqvae.features, hear=heard.tracks)
    scores = refiner_scores(PredictorData(held_out, pqvae, config.context_parts), refiner)
    figures = {
        f"{name}, refined / {before}": float(after.mean() / values.mean())
        for before in ("pasted", "eased")
        for name, after, values in zip(
            RefinerScores._fields, scores["refined"], scores[before], strict=True
        )
    }
    stage.publish(stage.name, refiner, record | {"codes": pqvae.fingerprint()}, figures)
