"""Train the judges: the motion extractor M, a second judge of motion, and a judge of speech.

Each sees real training clips only.

Paper:    AM D
Notebook: notebooks/17_motion_distances.ipynb
"""

from functools import partial
from typing import Any, NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.corpus.script import split
from s2glib.data.windows import noise_floor
from s2glib.papers.amuse.augmentation import gain_and_tilt, mask, shift
from s2glib.papers.amuse.config import EXTRACTOR_PRESETS, SPEECH_PRESETS
from s2glib.papers.amuse.front_end import standardized
from s2glib.papers.amuse.motion_extractor import MotionExtractor, PositionJudge
from s2glib.papers.amuse.speech_judge import SpeechJudge
from s2glib.recipes.amuse_disentangler import factor_table
from s2glib.recipes.fit import Chance, Course
from s2glib.recipes.motion_data import MotionWindows, fit_features, motion_cells, motion_windows
from s2glib.recipes.speech_data import FactorTable
from s2glib.recipes.stage import Stage

EXTRACTOR = Course(steps=3000, batch=48, learning_rate=1e-3, weight_decay=0.1, warm_up=100)
SPEECH_JUDGE = Course(steps=5000, batch=48, learning_rate=2e-3, weight_decay=0.02, warm_up=30)
INPUT_NOISE = 0.1


class Labelled(NamedTuple):
    """Inputs and their classes."""

    inputs: Float[Tensor, "batch frames features"]
    emotion: Int[Tensor, " batch"]
    style: Int[Tensor, " batch"]


class ExtractorObjective(nn.Module):
    """L_Memo, and the auto-encoder's error  [AM D]."""

    def __init__(self, model: MotionExtractor):
        super().__init__()
        self.model = model

    def forward(self, batch: Labelled) -> tuple[Tensor, dict[str, Tensor]]:
        """The loss and its terms."""
        emotion, reconstruction = self.model.losses(batch.inputs, batch.emotion)
        loss = emotion + 0.1 * reconstruction
        return loss, {"emotion": emotion, "reconstruction": reconstruction}


class PositionObjective(nn.Module):
    """Cross-entropy of the second judge."""

    def __init__(self, model: PositionJudge):
        super().__init__()
        self.model = model

    def forward(self, batch: Labelled) -> tuple[Tensor, dict[str, Tensor]]:
        """The loss and its terms."""
        loss = F.cross_entropy(self.model(batch.inputs).logits, batch.emotion)
        return loss, {"emotion": loss}


class SpeechJudgeObjective(nn.Module):
    """Cross-entropy of the judge of speech, for emotion and speaker."""

    def __init__(self, model: SpeechJudge):
        super().__init__()
        self.model = model

    def forward(self, batch: Labelled) -> tuple[Tensor, dict[str, Tensor]]:
        """The loss and its terms."""
        opinion = self.model(batch.inputs)
        emotion = F.cross_entropy(opinion.emotion, batch.emotion)
        style = F.cross_entropy(opinion.style, batch.style)
        return emotion + 0.5 * style, {"emotion": emotion, "style": style}


def draw_motion(windows: MotionWindows, course: Course, chance: Chance) -> Labelled:
    """Windows that start within the first quarter second, with a little noise."""
    clips = chance.rng.integers(len(windows.cells), size=course.batch)
    offsets = chance.rng.integers(9, size=course.batch)
    motion = windows.window(clips, offsets)
    motion = motion + INPUT_NOISE * torch.randn(motion.shape, generator=chance.generator)
    return Labelled(motion, windows.emotion[clips], torch.zeros(len(clips), dtype=torch.long))


def draw_speech(table: FactorTable, judge: SpeechJudge, course: Course, chance: Chance) -> Labelled:
    """Real clips: moved, louder or softer, masked, and blurred as decoded speech is blurred."""
    index = chance.rng.integers(len(table.factors), size=course.batch)
    config, generator = judge.config, chance.generator
    silence = standardized(noise_floor(config.n_mels), config)
    x = table.clips(index)
    x = shift(x, silence, earliest=12, latest=12, generator=generator)
    x = gain_and_tilt(x, config.std, gain=0.5, tilt=0.1, generator=generator)
    x = blur(mask(x, longest=30, widest=8, generator=generator), int(chance.rng.integers(3)))
    x = x + 0.05 * chance.rng.random() * torch.randn(x.shape, generator=generator)
    emotion, style = (torch.from_numpy(table.factors[index, column]) for column in (2, 1))
    return Labelled(x, emotion, style)


def blur(x: Float[Tensor, "batch frames mels"], width: int) -> Float[Tensor, "batch frames mels"]:
    """Average over 2 width + 1 frames and, where width > 0, three mels."""
    if width == 0:
        return x
    kernel, padding = (2 * width + 1, 3), (width, 1)
    return F.avg_pool2d(x[:, None], kernel, 1, padding, count_include_pad=False)[:, 0]


@torch.no_grad()
def gesture_accuracy(judge: nn.Module, windows: MotionWindows) -> float:
    """Percent of clips whose first window is recognised."""
    judge.eval()
    guesses = [judge(motion).logits.argmax(-1) for motion in windows.first().split(128)]
    return 100 * float((torch.cat(guesses) == windows.emotion).float().mean())


@torch.no_grad()
def speech_accuracy(judge: SpeechJudge, table: FactorTable) -> float:
    """Percent of clips whose emotion the judge of speech recognises."""
    judge.eval()
    parts = [judge(x.float()).emotion.argmax(-1) for x in table.windows.split(128)]
    return 100 * float((torch.cat(parts).numpy() == table.factors[:, 2]).mean())


def train(stage: Stage) -> None:
    """The stage `amuse-extractor`: M, the second judge of motion, and the judge of speech."""
    train_motion_judges(stage)
    train_speech_judge(stage)


def train_motion_judges(stage: Stage) -> None:
    """M and the judge of positions, on the training takes."""
    torch.manual_seed(stage.seed)
    config = EXTRACTOR_PRESETS[stage.preset]
    cells = motion_cells()
    features = fit_features(cells, config.features)
    windows = motion_windows(cells, features, config.frames)
    validation = motion_windows(split("validation"), features, config.frames)
    course = stage.course(EXTRACTOR)
    draw = partial(draw_motion, windows, course)
    makers: dict[str, tuple[Any, Any]] = {
        "amuse-extractor": (MotionExtractor, ExtractorObjective),
        "amuse-position-judge": (PositionJudge, PositionObjective),
    }
    for part, (model_class, objective_class) in makers.items():
        judge = model_class(config)
        judge.features.load_state_dict(features.state_dict())
        kept, record = stage.train(part, objective_class(judge), course, draw)
        figures = {"GA of GT": gesture_accuracy(kept.model, validation)}
        stage.publish(part, kept.model.eval(), record, figures)


def train_speech_judge(stage: Stage) -> None:
    """The judge of speech, on real filterbanks."""
    torch.manual_seed(stage.seed)
    judge = SpeechJudge(SPEECH_PRESETS[stage.preset])
    table = factor_table("train", judge.config)
    course = stage.course(SPEECH_JUDGE)
    draw = partial(draw_speech, table, judge, course)
    kept, record = stage.train("amuse-speech-judge", SpeechJudgeObjective(judge), course, draw)
    figures = {"EA": speech_accuracy(kept.model, factor_table("validation", judge.config))}
    stage.publish("amuse-speech-judge", kept.model.eval(), record, figures)
