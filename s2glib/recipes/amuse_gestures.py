"""Train the gesture generator: after the motion prior, the latent denoiser on its latents.

Paper:    AM C.1, C.3
Notebook: notebooks/13_latent_diffusion.ipynb
"""

import math
from functools import partial
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from s2glib.checkpoint import load_checkpoint
from s2glib.corpus.build import Request
from s2glib.corpus.script import split
from s2glib.diffusion import NoiseSchedule, add_noise
from s2glib.papers.amuse.config import DENOISER_PRESETS, SpeechConfig
from s2glib.papers.amuse.disentangler import SpeechDisentangler, SpeechLatents
from s2glib.papers.amuse.front_end import MOTION_FPS, frame_moments, time_tracks
from s2glib.papers.amuse.latent_denoiser import LatentDenoiser, SpeechCondition
from s2glib.papers.amuse.motion_prior import MotionPrior
from s2glib.papers.amuse.stress_listener import StressListener, heard_rhythm
from s2glib.papers.amuse.temporal_prior import TemporalMotionDecoder
from s2glib.recipes.amuse_disentangler import encode_all, factor_table
from s2glib.recipes.amuse_face import train_face
from s2glib.recipes.amuse_prior import train_prior
from s2glib.recipes.amuse_stress import train_stress
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.motion_data import (
    MotionWindows,
    SpeechOfClips,
    edited_performances,
    motion_cells,
    motion_windows,
    speech_row,
)
from s2glib.recipes.speech_data import FactorTable
from s2glib.recipes.stage import Stage

DENOISER = Course(
    steps=30000,
    batch=64,
    learning_rate=1e-3,
    betas=(0.9, 0.99),
    weight_decay=1e-3,
    warm_up=100,
    average=0.998,
)
CONDITION_DROPOUT = 0.1
DONATED = 0.5  # share of conditions whose content, or emotion, comes from another clip
CONDITION_NOISE = 0.3  # of a latent's own spread


class DenoiserStep(NamedTuple):
    """Clean latents, what the speech asks for, and the noise of this step."""

    x0: Float[Tensor, "batch tokens dim"]
    condition: SpeechCondition
    t: Int[Tensor, " batch"]
    noise: Float[Tensor, "batch tokens dim"]


class DenoiserObjective(nn.Module):
    """Holds the denoiser; one call predicts x0 and compares  (L_LD).

    Args:
        model: the denoiser.
        weights: how much each latent number matters to the motion.
    """

    weights: Tensor

    def __init__(self, model: LatentDenoiser, weights: Float[Tensor, "tokens dim"]):
        super().__init__()
        self.model = model
        self.schedule = NoiseSchedule.scaled_linear(model.config.levels)
        self.register_buffer("weights", weights)

    def forward(self, step: DenoiserStep) -> tuple[Tensor, dict[str, Tensor]]:
        """The loss."""
        xt = add_noise(self.schedule, step.x0, step.noise, step.t)
        predicted = self.model(xt, step.t, step.condition)
        target = step.x0 if self.model.config.prediction == "x0" else step.noise
        loss = (self.weights * (predicted - target).square()).mean()
        return loss, {"latent": loss}


def latent_weights(prior: MotionPrior, denoiser: LatentDenoiser) -> Float[Tensor, "tokens dim"]:
    """How far a standardised latent number moves the motion: the size of its decoder column.

    A posture counts for all frames of the window, a local token only for its own.
    """
    decoder = prior.decoder
    assert isinstance(decoder, TemporalMotionDecoder)
    whole = decoder.posture.weight.norm(dim=0) * math.sqrt(prior.config.frames)
    local = decoder.change.weight.norm(dim=0).expand(prior.config.tokens - 1, -1)
    weights = torch.cat([whole[None], local]) * denoiser.latent_std
    return (weights / weights.mean()).detach()


def token_statistics(
    latents: Float[Tensor, "n tokens dim"],
) -> tuple[Float[Tensor, "tokens dim"], Float[Tensor, "tokens dim"]]:
    """Mean and spread for the global token, and one pair shared by all local tokens."""
    whole, local = latents[:, :1], latents[:, 1:].flatten(0, 1)
    count = latents.shape[1] - 1
    mean = torch.cat([whole.mean(0), local.mean(0).expand(count, -1)])
    return mean, torch.cat([whole.std(0), local.std(0).expand(count, -1)])


def balance_latents(
    denoiser: LatentDenoiser, prior: MotionPrior, windows: MotionWindows, seed: int
) -> Float[Tensor, "tokens dim"]:
    """Standardise latents, and weigh them by what they move, where linear paths tell it (ours).

    The paper's latents stay as its prior makes them, and all their numbers count alike.
    """
    if prior.config.backbone == "transformer":
        return torch.ones_like(denoiser.latent_std)
    clips = np.random.default_rng(seed).permutation(len(windows.cells))[:4096]
    offsets = windows.any_offset(clips, np.random.default_rng(seed))
    with torch.no_grad():
        mean, std = token_statistics(prior.encode(windows.window(clips, offsets)).mean)
    denoiser.latent_mean.copy_(mean)
    denoiser.latent_std.copy_(std)
    return latent_weights(prior, denoiser)


class GestureData:
    """Motion windows with the rows of their speech, and latents encoded on the fly.

    Args:
        windows: motion of clips whose speech is known.
        rows: row of the speech that each clip follows.
        felt: row of the speech whose emotion it shows: another one where the clip is an edit.
        speech: what the disentangler hears in each speech clip.
        prior: the trained motion prior.
        config: of the disentangler.
    """

    def __init__(
        self,
        windows: MotionWindows,
        rows: np.ndarray,
        felt: np.ndarray,
        speech: SpeechOfClips,
        prior: MotionPrior,
        config: SpeechConfig,
    ):
        self.windows, self.speech = windows, speech
        self.rows, self.felt = torch.from_numpy(rows), torch.from_numpy(felt)
        self.prior, self.config = prior, config
        self.spread = SpeechLatents(*(latent.std(0) for latent in speech.latents))
        self.of_sentence = _rows_by([cell.sentence for cell in windows.cells], rows)
        self.of_emotion = _rows_by([cell.emotion for cell in windows.cells], felt)

    def draw(self, model: LatentDenoiser, course: Course, chance: Chance) -> DenoiserStep:
        """Windows from anywhere, conditions with fresh noise, some of them dropped."""
        count = course.batch
        clips = chance.rng.integers(len(self.windows.cells), size=count)
        offsets = self.windows.any_offset(clips, chance.rng)
        speech = self.heard(clips)
        latents = self._with_donors(speech.latents, clips, chance)
        condition = self._condition(speech._replace(latents=latents), offsets)
        noisy = SpeechLatents(
            *(
                latent + CONDITION_NOISE * spread * _noise(latent.shape, chance)
                for latent, spread in zip(latents, self.spread, strict=True)
            )
        )
        dropped = torch.rand(count, 3, generator=chance.generator) < CONDITION_DROPOUT
        motion = self.windows.window(clips, offsets).to(model.latent_mean)
        with torch.no_grad():
            x0 = model.standardize(self.prior.to(motion.device).encode(motion).mean)
        t = torch.randint(model.config.levels, (count,), generator=chance.generator)
        condition = condition._replace(latents=noisy, dropped=dropped)
        return DenoiserStep(x0, condition, t, _noise(x0.shape, chance))

    def _with_donors(
        self, latents: SpeechLatents, clips: np.ndarray, chance: Chance
    ) -> SpeechLatents:
        """Half of the time take c from any clip of the sentence, and e from any of the emotion.

        So c is not asked for the emotion that it still whispers, nor e for the clip.
        """
        cells = [self.windows.cells[clip] for clip in clips]
        content = _donors([self.of_sentence[c.sentence] for c in cells], chance)
        emotion = _donors([self.of_emotion[c.emotion] for c in cells], chance)
        swap = torch.from_numpy(chance.rng.random((2, len(clips), 1)) < DONATED)
        heard = self.speech.latents
        return latents._replace(
            content=torch.where(swap[0], heard.content[content], latents.content),
            emotion=torch.where(swap[1], heard.emotion[emotion], latents.emotion),
        )

    def condition(self, clips: np.ndarray, offsets: np.ndarray) -> SpeechCondition:
        """What the speech of these clips asks of windows at these frames."""
        return self._condition(self.heard(clips), offsets)

    def heard(self, clips: np.ndarray) -> SpeechOfClips:
        """The speech that these clips follow, with the emotion that they show."""
        index = torch.from_numpy(clips)
        speech = self.speech.take(self.rows[index])
        emotion = self.speech.latents.emotion[self.felt[index]]
        return speech._replace(latents=speech.latents._replace(emotion=emotion))

    def _condition(self, speech: SpeechOfClips, offsets: np.ndarray) -> SpeechCondition:
        begin = torch.from_numpy(offsets)[:, None] / MOTION_FPS
        moments = (begin + frame_moments(self.windows.frames)).float()
        tracks = time_tracks(speech.rhythm, speech.latents.content, moments, self.config)
        nothing: Bool[Tensor, "batch 3"] = torch.zeros(len(offsets), 3, dtype=torch.bool)
        return SpeechCondition(speech.latents, tracks, nothing)


def _rows_by(keys: list, rows: np.ndarray) -> dict[object, np.ndarray]:
    """The speech rows that share a key."""
    labels = np.array(keys)
    return {key: np.unique(rows[labels == key]) for key in set(keys)}


def _donors(candidates: list[np.ndarray], chance: Chance) -> Tensor:
    """One row out of each list."""
    return torch.tensor([int(chance.rng.choice(rows)) for rows in candidates])


def _noise(shape, chance: Chance) -> Tensor:
    return torch.randn(shape, generator=chance.generator)


@torch.no_grad()
def speech_of(
    model: SpeechDisentangler, stress: StressListener, table: FactorTable
) -> SpeechOfClips:
    """Latents and rhythm of every clip of a table."""
    tracks = [heard_rhythm(windows.float(), stress) for windows in table.windows.split(128)]
    return SpeechOfClips(encode_all(model, table), torch.cat(tracks))


def train(stage: Stage) -> None:
    """The stage `amuse-gestures`: face, stress, prior, and the denoiser on real speech latents."""
    train_face(stage)
    train_stress(stage)
    prior = train_prior(stage).eval().requires_grad_(False)
    train_denoiser(stage, prior)


def train_denoiser(stage: Stage, prior: MotionPrior) -> None:
    """The second half of the stage; disentangler and stress listener must be there."""
    folder = stage.folder / "checkpoints"
    speech = load_checkpoint(folder / "amuse-disentangler.safetensors", SpeechDisentangler)
    torch.manual_seed(stage.seed)
    spoken, performed = split("train"), [*map(Request, motion_cells()), *edited_performances()]
    windows = motion_windows(performed, prior.features, prior.config.frames)
    followed = [c._replace(emotion=clock_of or c.emotion) for c, clock_of in performed]
    rows, felt = speech_row(followed, spoken), speech_row(windows.cells, spoken)
    stress = load_checkpoint(folder / "amuse-stress.safetensors", StressListener)
    heard = speech_of(speech, stress, factor_table("train", speech.config))
    data = GestureData(windows, rows, felt, heard, prior, speech.config)
    denoiser = LatentDenoiser(DENOISER_PRESETS[stage.preset])
    weights = balance_latents(denoiser, prior, windows, stage.seed)
    course = stage.course(DENOISER)
    draw = partial(data.draw, denoiser, course)
    objective = DenoiserObjective(denoiser, weights)
    kept, record = stage.train("amuse-denoiser", objective, course, draw)
    figures = {"latent error": record["curve"][-1]["latent"]}
    stage.publish("amuse-denoiser", kept.model.eval(), record, figures)
