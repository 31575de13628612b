"""What a Predictor gains from company: one voice alone, and all voices together, for equally long.

PT warns that its figures on BEAT-X come from one speaker and "potential for overfitting". The gap
between training and test clips of that speaker shows it; the runs are short.

Paper:    PT B (Experiments on BEAT-X)
Notebook: notebooks/17_motion_distances.ipynb
"""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import torch

from s2glib.corpus.script import TRAIN_SPEAKERS, Cell, split
from s2glib.papers.probtalk import PQVAE, PREDICTOR_PRESETS, Predictor
from s2glib.papers.probtalk.speech_features import MELS
from s2glib.recipes.holistic_data import holistic_clips
from s2glib.recipes.holistic_speech import log_mel_tracks
from s2glib.recipes.predictor_scores import held_out, nothing_given, token_scores
from s2glib.recipes.probtalk_pqvae import trained_pqvae
from s2glib.recipes.probtalk_predictor import LESSONS, PredictorData, PredictorObjective
from s2glib.recipes.records import recorded_figures
from s2glib.recipes.report import Row, over_draws
from s2glib.recipes.stage import Stage

STAGE = "probtalk-speakers"
STEPS = 400
_WARM_UP = 40
SEEDS = (0, 1, 2)
ERROR = "cross-entropy"
NAMES = ("one voice", "all voices")


def train(stage: Stage) -> None:
    """The stage `probtalk-speakers`: a voice for each seed. It leaves a record only.

    After the last voice, seeds begin again with the first.
    """
    pqvae = trained_pqvae(stage, PREDICTOR_PRESETS[stage.preset].motion)
    voice, steps = TRAIN_SPEAKERS[stage.seed % len(TRAIN_SPEAKERS)], stage.steps or STEPS
    own = {name: [c for c in split(name) if c.speaker == voice] for name in ("train", "test")}
    figures: dict[str, float] = {}
    for name, cells in zip(NAMES, (own["train"], split("train")), strict=True):
        model = short_run(replace(stage, steps=steps), name, pqvae, cells)
        figures |= {f"{name}: {s}": error_on(pqvae, model, own[s]) for s in own}
    stage.note(stage.name, {"course": {"steps": steps}, "voice": voice}, figures)


def short_run(stage: Stage, name: str, pqvae: PQVAE, cells: list[Cell]) -> Predictor:
    """A Predictor that saw some of the clips."""
    config, lesson = PREDICTOR_PRESETS[stage.preset], LESSONS[stage.preset]
    config = replace(config, speech=MELS, speakers=len(TRAIN_SPEAKERS))
    lesson = replace(lesson, course=replace(stage.course(lesson.course), warm_up=_WARM_UP))
    clips = holistic_clips(cells, pqvae.features, hear=log_mel_tracks)
    data = PredictorData(clips, pqvae, config.context_parts)
    torch.manual_seed(stage.seed)
    model = Predictor(config)
    part, draw = f"{stage.name}-{name.replace(' ', '-')}", partial(data.draw, lesson, model.mask)
    kept, _ = stage.train(part, PredictorObjective(model, lesson), lesson.course, draw)
    return kept.model.eval()


def error_on(pqvae: PQVAE, model: Predictor, cells: list[Cell]) -> float:
    """Cross-entropy of all tokens of the first windows, from the speech alone."""
    clips = holistic_clips(cells, pqvae.features, hear=log_mel_tracks)
    windows = held_out(clips, pqvae.config.frames)
    return token_scores(pqvae, model, windows, nothing_given(windows))[ERROR]


def speaker_rows(runs: Path) -> list[Row]:
    """The recorded runs: errors on test clips of the voice, and by how much they exceed training's.

    Raises:
        FileNotFoundError: if there is no record.
    """
    figures = recorded_figures(runs, STAGE)

    def recorded(name: str, values: list[float]) -> Row:
        return over_draws(name, np.array(values), len(values))._replace(recorded=True)

    rows = []
    for name in NAMES:
        tests, trains = ([run[f"{name}: {s}"] for run in figures] for s in ("test", "train"))
        gaps = [test - train for test, train in zip(tests, trains, strict=True)]
        rows.append(recorded(f"{name}: {ERROR}, test", tests))
        rows.append(recorded(f"{name}: {ERROR}, test - train", gaps))
    return rows
