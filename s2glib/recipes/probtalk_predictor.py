"""Train the Predictor to name the codes that a frozen PQ-VAE gives to motion.

Paper:    PT A.2; losses, masks and rates: authors' code
Notebook: notebooks/06_masked_prediction.ipynb
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.corpus.script import SPEAKERS, TRAIN_SPEAKERS, split
from s2glib.papers.amuse.stress_listener import stress_loss, stress_targets
from s2glib.papers.probtalk import PQVAE, PREDICTOR_PRESETS, Predictor
from s2glib.papers.probtalk.masking import (
    hide_tokens,
    masked_share,
    part_contexts,
    random_shares,
    window_contexts,
)
from s2glib.papers.probtalk.predictor import WINDOW
from s2glib.papers.probtalk.speech_features import MOTION_FPS
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.holistic_data import HolisticClips, holistic_clips
from s2glib.recipes.holistic_speech import hearing
from s2glib.recipes.motion_data import motion_cells
from s2glib.recipes.predictor_scores import GUIDANCES, predictor_scores, wise_guidance
from s2glib.recipes.probtalk_pqvae import trained_pqvae
from s2glib.recipes.speech_data import stress_times
from s2glib.recipes.stage import Stage


@dataclass(frozen=True)
class Lesson:
    """How the Predictor is taught.

    Attributes:
        course: steps, batch, rates.
        hidden: "curriculum": half of the tokens, then more, at last all (authors' code); "random":
            any share, as MaskGIT and as decoding has it.
        parts: contexts of any length and of single parts of the body (ours).
        region: tokens that count in the loss: "all" (authors' code) or the "hidden" ones.
        louder: spread of a clip's loudness, in standardised log-mels (ours).
        unheard: share of clips whose speech is left out, for guidance (ours).
        stress: weight of saying when stressed vowels begin, from what the tokens look at (ours).
    """

    course: Course
    hidden: Literal["curriculum", "random"] = "curriculum"
    parts: bool = False
    region: Literal["all", "hidden"] = "all"
    louder: float = 0.0
    unheard: float = 0.0
    stress: float = 0.0


PAPER_COURSE = Course(  # a constant rate, 100 epochs: authors' code; so many steps: ours
    steps=40_000,
    batch=128,
    learning_rate=1e-4,
    betas=(0.9, 0.99),
    warm_up=1,
    last_rate=1.0,
    clip=5.0,
)
LESSONS = {
    "paper": Lesson(PAPER_COURSE),
    "teaching": Lesson(
        Course(steps=12_000, batch=32, learning_rate=2e-3, betas=(0.9, 0.99), warm_up=300),
        hidden="random",
        parts=True,
        louder=0.3,
        unheard=0.1,
        stress=1.0,
    ),
}


class PredictorStep(NamedTuple):
    """True codes, what is seen of them, and what goes with them.

    `stress` is 1 where a stressed vowel begins, and less around it.
    """

    target: Int[Tensor, "batch time groups"]
    codes: Int[Tensor, "batch time groups"]
    speech: Float[Tensor, "batch frames speech"]
    context: Float[Tensor, "batch frames motion"]
    context_mask: Bool[Tensor, "batch frames parts"]
    speaker: Int[Tensor, " batch"]
    stress: Float[Tensor, "batch frames"]


class PredictorObjective(nn.Module):
    """Holds the Predictor; one call is one guess at all tokens, and at the stresses they hear."""

    def __init__(self, model: Predictor, lesson: Lesson):
        super().__init__()
        self.model, self.lesson = model, lesson
        self.stresses = nn.Linear(model.config.width, WINDOW) if lesson.stress else None

    def forward(self, step: PredictorStep) -> tuple[Tensor, dict[str, Tensor]]:
        """Cross-entropy, and how many of the hidden tokens are right."""
        memory = self.model.listen(step.speech, step.context, step.context_mask)
        logits = self.model.predict(memory, step.speaker, step.codes)
        errors = F.cross_entropy(logits.flatten(0, 2), step.target.flatten(), reduction="none")
        hidden = (step.codes == self.model.mask).flatten()
        right = logits.argmax(-1).flatten() == step.target.flatten()
        unseen = errors[hidden].mean()
        loss = errors.mean() if self.lesson.region == "all" else unseen
        terms = {"hidden": unseen, "accuracy": right[hidden].float().mean()}
        if self.stresses is not None:
            terms["stress"] = stress_loss(self.stresses(memory).flatten(1), step.stress)
            loss = loss + self.lesson.stress * terms["stress"]
        return loss, terms


class PredictorData:
    """Clips, and the codes that their windows have.

    Args:
        clips: motion with speech.
        pqvae: the frozen PQ-VAE.
        parts: columns of the Predictor's context mask.
    """

    def __init__(self, clips: HolisticClips, pqvae: PQVAE, parts: int):
        self.clips, self.pqvae, self.parts = clips, pqvae, parts
        self.frames = pqvae.config.frames
        self.speakers = torch.tensor([SPEAKERS.index(cell.speaker) for cell in clips.cells])

    def draw(self, lesson: Lesson, mask: int, chance: Chance) -> PredictorStep:
        """Windows from anywhere; some tokens hidden, some motion given."""
        count, generator = lesson.course.batch, chance.generator
        rows = chance.rng.integers(len(self.clips.cells), size=count)
        offsets = self.clips.any_offset(rows, self.frames, chance.rng)
        contexts = part_contexts if lesson.parts else window_contexts
        step = self.step(rows, offsets, contexts(count, self.frames, generator))
        if lesson.hidden == "curriculum":
            shares = torch.full((count,), masked_share(chance.progress))
        else:
            shares = random_shares(count, generator)
        louder = lesson.louder * torch.randn(count, 1, 1, generator=generator)
        heard = torch.rand(count, 1, 1, generator=generator) >= lesson.unheard
        codes = hide_tokens(step.target, shares, mask=mask, generator=generator)
        return step._replace(codes=codes, speech=(step.speech + louder) * heard)

    @torch.no_grad()
    def step(
        self,
        rows: Int[np.ndarray, " n"],
        offsets: Int[np.ndarray, " n"],
        known: Bool[Tensor, "n frames 4"],
    ) -> PredictorStep:
        """Windows with all their codes, and what is given of their motion."""
        motion = self.clips.moving(rows, offsets, self.frames)
        target = self.pqvae.encode(motion)
        if self.parts == 1:
            known = known.all(dim=-1, keepdim=True).expand_as(known)
        context = motion * self.pqvae.features.of_parts(known)
        speech = self.clips.heard(rows, offsets, self.frames)
        speaker = self.speakers[torch.from_numpy(rows)]
        seen = known[..., : self.parts]
        times = stress_times([self.clips.cells[row] for row in rows])
        since = times - torch.from_numpy(offsets / MOTION_FPS).float()[:, None]
        stress = stress_targets(since, self.frames, float(MOTION_FPS))
        return PredictorStep(target, target, speech, context, seen, speaker, stress)


def train(stage: Stage) -> None:
    """The stage `probtalk-predictor`; the PQ-VAE must be there."""
    config, lesson = PREDICTOR_PRESETS[stage.preset], LESSONS[stage.preset]
    pqvae = trained_pqvae(stage, config.motion)
    lesson, heard = replace(lesson, course=stage.course(lesson.course)), hearing(stage.preset)
    config = replace(config, speech=heard.channels, speakers=len(TRAIN_SPEAKERS))
    clips = holistic_clips(motion_cells(), pqvae.features, hear=heard.tracks)
    data = PredictorData(clips, pqvae, config.context_parts)
    torch.manual_seed(stage.seed)
    model = Predictor(config)
    objective = PredictorObjective(model, lesson)
    draw = partial(data.draw, lesson, model.mask)
    kept, record = stage.train(stage.name, objective, lesson.course, draw)
    predictor = kept.model.eval()
    held_out = holistic_clips(split("validation"), pqvae.features, hear=heard.tracks)
    record |= {"codes": pqvae.fingerprint()}
    guidances = GUIDANCES if lesson.unheard else (1.0,)
    figures = predictor_scores(pqvae, predictor, held_out, guidances)
    predictor.config = replace(config, guidance=wise_guidance(figures, guidances))
    stage.publish(stage.name, predictor, record, figures)
