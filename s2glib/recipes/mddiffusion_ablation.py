"""What splines, refinement and company are good for: short runs that differ in one thing each.

Splines against the affine regions of MRAA, both with and without refinement; one speaker alone
against four together. The runs of a seed are equally long and end early: they show an order, not
what can be reached.

Paper:    MDD E, Fig. E1; I
Notebook: notebooks/19_judging_video.ipynb
"""

from collections.abc import Sequence
from dataclasses import replace

from s2glib.papers.mddiffusion import DECOUPLING_PRESETS, DecouplingConfig, MotionDecoupler
from s2glib.recipes import mddiffusion_decoupling as decoupling
from s2glib.recipes import mddiffusion_refinement as refinement
from s2glib.recipes.stage import Stage
from s2glib.recipes.video_data import (
    TEST_CLIPS,
    TRAIN_CLIPS,
    Scene,
    VideoFrames,
    films,
    scenes,
)
from s2glib.recipes.video_scores import film_errors

STAGE = "mddiffusion-ablation"
STEPS = 400  # of a decoupler
REPAIRS = 0.4  # as many steps for a refinement
SEEDS = (0, 1, 2)


def train(stage: Stage) -> None:
    """The stage `mddiffusion-ablation`: all runs of one seed. It leaves a record only."""
    steps = stage.steps or STEPS
    config = DECOUPLING_PRESETS[stage.preset]
    train, test = scenes("train", TRAIN_CLIPS), scenes("test", TEST_CLIPS)
    speaker = train[0].cell.speaker
    splines = _decoupler(stage, "splines", config, train, steps)
    affine = _decoupler(stage, "affine", replace(config, warp="affine"), train, steps)
    alone = _decoupler(stage, "alone", config, _of(speaker, train), steps)
    figures: dict[str, float] = {}
    for name, model in (("splines", splines), ("affine", affine)):
        figures |= _with_and_without_repair(stage, name, model, train, test, steps)
    own = _video(_of(speaker, test), config.size)
    for name, model in (("one speaker", alone), ("four speakers", splines)):
        figures[f"{name}: moving"] = film_errors(model, own).moving.shares()["made"]
    stage.note(stage.name, {"course": {"steps": steps}}, figures)


def _decoupler(
    stage: Stage, name: str, config: DecouplingConfig, shots: Sequence[Scene], steps: int
) -> MotionDecoupler:
    lesson = decoupling.LESSONS[stage.preset]
    short = replace(stage, steps=steps)
    video = _video(shots, config.size)
    return decoupling.fit_decoupler(short, f"{stage.name}-{name}", config, lesson, video)[0]


def _with_and_without_repair(
    stage: Stage,
    name: str,
    model: MotionDecoupler,
    train: Sequence[Scene],
    test: Sequence[Scene],
    steps: int,
) -> dict[str, float]:
    """Errors by region, as shares of those of copying the source."""
    lesson, size = refinement.LESSONS[stage.preset], model.config.size
    short, part = replace(stage, steps=round(REPAIRS * steps)), f"{stage.name}-{name}-refined"
    refiner, _ = refinement.fit_refiner(short, part, model, lesson, _video(train, size))
    regions = film_errors(model, _video(test, size), refiner)._asdict()
    return {
        f"{name}{how}: {region}": errors.shares()[guess]
        for region, errors in regions.items()
        for how, guess in (("", "made"), (", refined", "refined"))
    }


def _of(speaker: str, shots: Sequence[Scene]) -> list[Scene]:
    return [shot for shot in shots if shot.cell.speaker == speaker]


def _video(shots: Sequence[Scene], size: int) -> VideoFrames:
    return VideoFrames(films(shots, size))
