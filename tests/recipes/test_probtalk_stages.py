"""Refiner, feature networks and the study of speakers, through their recipes, on made-up clips."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import torch

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.corpus import EMOTIONS, SPEAKERS, Cell
from s2glib.corpus.script import TRAIN_SPEAKERS
from s2glib.papers.probtalk import (
    FEATURE_PRESETS,
    PAPER_FEATURES,
    PAPER_REFINER,
    PQVAE,
    PREDICTOR_PRESETS,
    REFINER_PRESETS,
    TEACHING_FEATURES,
    TEACHING_PQVAE,
    TEACHING_PREDICTOR,
    TEACHING_REFINER,
    FeatureNets,
    Refiner,
)
from s2glib.recipes import (
    Chance,
    Course,
    Stage,
    Training,
    probtalk_features,
    probtalk_predictor,
    probtalk_speakers,
)
from s2glib.recipes import probtalk_refiner as recipe
from s2glib.recipes.holistic_data import HolisticClips, Tracks
from s2glib.recipes.probtalk_predictor import LESSONS, PredictorData
from s2glib.recipes.report import table

PQ = replace(TEACHING_PQVAE, frames=32, widths=(8, 8, 8, 8), straight=0, latent=16, codes=8)
THIN = {"width": 16, "heads": 2, "layers": 1, "hidden": 16, "style": 4}
REFINER = replace(TEACHING_REFINER, head=16, **THIN)
PREDICTOR = replace(
    TEACHING_PREDICTOR, codes=8, audio_width=8, context_widths=(8, 8, 8), **THIN
)  # fmt: skip
FEATURES = replace(
    TEACHING_FEATURES, frames=16, widths=(8, 8, 8, 4), hidden=(8, 8), code=4, decoder_widths=(2, 8)
)
COURSE = Course(steps=3, batch=4, learning_rate=1e-3, warm_up=1)
CELLS = [Cell(s, v, e, 0) for s in (0, 1) for v in SPEAKERS[:2] for e in EMOTIONS[:3]]


def made_up(cells, features, *, hear=None):
    generator = torch.Generator().manual_seed(0)
    motion = Tracks(torch.randn(50, features.size, generator=generator) for _ in cells)
    speech = Tracks(torch.randn(50, 64, generator=generator) for _ in cells)
    return HolisticClips(list(cells), motion, speech, np.arange(len(cells)))


def chance(progress=0.0, seed=0):
    return Chance(np.random.default_rng(seed), torch.Generator().manual_seed(seed), progress)


@pytest.fixture
def pqvae():
    torch.manual_seed(0)
    return PQVAE(PQ).eval().requires_grad_(False)


@pytest.fixture
def data(pqvae):
    return PredictorData(made_up(CELLS, pqvae.features), pqvae, 4)


@pytest.fixture
def _corpus(monkeypatch, pqvae, tmp_path):
    """Few clips, few steps, narrow networks, and a PQ-VAE to begin with."""
    save_checkpoint(tmp_path / "checkpoints" / "probtalk-pqvae.safetensors", pqvae, PQ)
    for module in (recipe, probtalk_features, probtalk_speakers):
        monkeypatch.setattr(module, "split", lambda name: CELLS)
        monkeypatch.setattr(module, "holistic_clips", made_up)
    monkeypatch.setattr(recipe, "motion_cells", lambda: CELLS)
    for preset, refiner, features in (
        ("teaching", REFINER, FEATURES),
        ("paper", replace(PAPER_REFINER, expression=12, **THIN),
         replace(PAPER_FEATURES, expression=12, frames=16, widths=(8, 8, 8, 4), hidden=(8, 8))),
    ):  # fmt: skip
        monkeypatch.setitem(REFINER_PRESETS, preset, refiner)
        monkeypatch.setitem(FEATURE_PRESETS, preset, features)
        lesson = replace(recipe.LESSONS[preset], course=COURSE)
        monkeypatch.setitem(recipe.LESSONS, preset, lesson)
        monkeypatch.setitem(probtalk_features.COURSES, preset, COURSE)
    monkeypatch.setitem(PREDICTOR_PRESETS, "teaching", PREDICTOR)
    monkeypatch.setitem(LESSONS, "teaching", replace(LESSONS["teaching"], course=COURSE))


def record(folder, part, preset="teaching"):
    return json.loads((folder / "runs" / f"{part}-{preset}-0.json").read_text())


STAGES = {
    "predictor": probtalk_predictor.train,
    "refiner": recipe.train,
    "features": probtalk_features.train,
    "speakers": probtalk_speakers.train,
}
LESSON = replace(recipe.LESSONS["teaching"], course=COURSE)


def test_three_steps_move_every_part_of_the_refiner(data):
    model = Refiner(REFINER)
    before = {name: p.clone() for name, p in model.named_parameters()}
    draw = partial(recipe.draw, data, LESSON, 0.05)
    losses = [
        log.loss for log in Training(recipe.RefinerObjective(model, LESSON), COURSE).run(draw)
    ]
    assert np.isfinite(losses).all()
    still = [name for name, p in model.named_parameters() if torch.equal(p, before[name])]
    assert still == []


def test_a_step_holds_motion_before_and_after_its_codes(data, pqvae):
    rows, offsets = np.array([3, 5]), np.array([0, 7])
    step = recipe.refiner_step(data, rows, offsets, torch.zeros(2, 32, 4, dtype=torch.bool))
    motion = data.clips.moving(rows, offsets, 32)
    assert torch.equal(step.motion, motion)
    torch.testing.assert_close(step.made, pqvae(motion).motion)
    assert step.speaker.tolist() == [SPEAKERS.index(CELLS[row].speaker) for row in rows]


def test_what_the_codes_made_is_a_little_off_and_drawn_from_its_chance(data):
    first, second = (recipe.draw(data, LESSON, 0.05, chance()) for _ in range(2))
    clean = recipe.draw(data, LESSON, 0.0, chance())
    assert torch.equal(first.made, second.made)
    assert float((first.made - clean.made).std()) == pytest.approx(0.05, rel=0.05)
    assert torch.equal(first.motion, clean.motion)


@pytest.mark.parametrize("seams", [True, False])
def test_a_jump_into_what_is_known_counts_only_with_seams(data, seams):
    model = Refiner(REFINER).eval()  # adds nothing yet
    step = recipe.draw(data, LESSON, 0.0, chance())
    step.context_mask[:] = torch.arange(32)[:, None] < 16
    known = model.known(step.context_mask)
    shifted = step._replace(made=step.motion + 3.0 * ~known)
    _, terms = recipe.RefinerObjective(model, replace(LESSON, seams=seams))(shifted)
    torch.testing.assert_close(terms["velocity"], torch.tensor(3.0 / 31))  # one step of 31 jumps
    model.head[-1].bias.data.fill_(1.0)  # moves the known frames too, and the jump stays the same
    _, terms = recipe.RefinerObjective(model, replace(LESSON, seams=seams))(shifted)
    torch.testing.assert_close(terms["velocity"], torch.tensor((3.0 + seams) / 31))


def test_the_texts_region_is_a_lesson(data):
    model = Refiner(REFINER).eval()
    step = recipe.draw(data, LESSON, 0.0, chance())
    lesson = replace(LESSON, region="known")
    _, terms = recipe.RefinerObjective(model, lesson)(step)
    assert terms["body"] == 0  # the input is the truth there, and nothing is added to it


def test_scores_compare_what_is_unknown_and_keep_what_is_known(data):
    torch.manual_seed(0)
    refiner = Refiner(REFINER).eval()
    scores = recipe.refiner_scores(data, refiner)
    for name in recipe.RefinerScores._fields:  # nothing is added yet
        values = [getattr(scores[kind], name) for kind in ("eased", "refined")]
        assert np.allclose(*values)
        assert (values[0] > 0).all()
    refiner.head[-1].bias.data.fill_(5.0)
    assert (recipe.refiner_scores(data, refiner)["refined"].error > 1).all()


def test_easing_mends_the_border_of_a_body_that_rests(pqvae):
    clips = made_up(CELLS, pqvae.features)
    resting = Tracks(0.3 * torch.randn(1, 288).expand(50, -1) for _ in CELLS)
    data = PredictorData(HolisticClips(CELLS, resting, clips.speech, clips.speech_rows), pqvae, 4)
    scores = recipe.refiner_scores(data, Refiner(REFINER))
    assert scores["eased"].border.mean() < 0.5 * scores["pasted"].border.mean()


@pytest.mark.usefixtures("_corpus")
@pytest.mark.parametrize("preset", ["paper", "teaching"])
def test_the_refiners_stage_leaves_a_checkpoint_with_the_statistics_of_the_codes(
    tmp_path, preset, pqvae
):
    recipe.train(Stage("probtalk-refiner", tmp_path, preset=preset))
    refiner = load_checkpoint(tmp_path / "checkpoints" / "probtalk-refiner.safetensors", Refiner)
    assert torch.equal(refiner.features.mean, pqvae.features.mean)
    figures = record(tmp_path, "probtalk-refiner", preset)["figures"]
    assert {"error, refined / pasted", "border, refined / eased"} <= set(figures)
    assert np.isfinite(list(figures.values())).all()


@pytest.mark.usefixtures("_corpus")
@pytest.mark.parametrize("preset", ["paper", "teaching"])
def test_the_feature_networks_stage_leaves_all_three_in_one_file(tmp_path, preset):
    probtalk_features.train(Stage("probtalk-features", tmp_path, preset=preset))
    path = tmp_path / "checkpoints" / "probtalk-features.safetensors"
    assert set(load_checkpoint(path, FeatureNets).nets) == {"face", "body and hands", "all"}
    figures = record(tmp_path, "probtalk-features", preset)["figures"]
    assert all(share > 0 for share in figures.values())


def test_three_steps_move_every_feature_network(pqvae):
    nets = FeatureNets(FEATURES)
    before = {name: p.clone() for name, p in nets.named_parameters()}
    draw = partial(probtalk_features.draw, made_up(CELLS, pqvae.features), 16, COURSE)
    objective = probtalk_features.FeatureObjective(nets)
    assert np.isfinite([log.loss for log in Training(objective, COURSE).run(draw)]).all()
    assert all(not torch.equal(p, before[name]) for name, p in nets.named_parameters())


@pytest.mark.usefixtures("_corpus")
def test_one_voice_and_all_voices_leave_a_record_that_rows_are_read_from(tmp_path, monkeypatch):
    seen = []
    whole = probtalk_speakers.short_run

    def noting(stage, name, pqvae, cells):
        seen.append((name, {cell.speaker for cell in cells}))
        return whole(stage, name, pqvae, cells)

    monkeypatch.setattr(probtalk_speakers, "short_run", noting)
    probtalk_speakers.train(Stage("probtalk-speakers", tmp_path, steps=2))
    assert seen == [("one voice", {SPEAKERS[0]}), ("all voices", set(SPEAKERS[:2]))]
    figures = record(tmp_path, "probtalk-speakers")["figures"]
    rows = {row.name: row for row in probtalk_speakers.speaker_rows(tmp_path / "runs")}
    gap = rows["one voice: cross-entropy, test - train"]
    assert gap.value == figures["one voice: test"] - figures["one voice: train"]
    assert all(row.recorded for row in rows.values())
    assert "(recorded)" in table(list(rows.values()))


@pytest.mark.usefixtures("_corpus")
def test_the_study_goes_round_the_voices_and_fits_the_papers_preset_to_the_corpus(
    tmp_path, monkeypatch
):
    monkeypatch.setitem(PREDICTOR_PRESETS, "paper", replace(PREDICTOR, speech=768, speakers=4))
    monkeypatch.setitem(LESSONS, "paper", replace(LESSONS["paper"], course=COURSE))
    seed = len(TRAIN_SPEAKERS)
    probtalk_speakers.train(Stage("probtalk-speakers", tmp_path, "paper", seed=seed, steps=2))
    path = tmp_path / "runs" / f"probtalk-speakers-paper-{seed}.json"
    run = json.loads(path.read_text())
    assert run["voice"] == TRAIN_SPEAKERS[0]
    assert np.isfinite(list(run["figures"].values())).all()


@pytest.mark.usefixtures("_corpus")
@pytest.mark.parametrize("part", ["predictor", "refiner", "features", "speakers"])
def test_a_pqvae_of_another_preset_is_refused(tmp_path, part):
    config = replace(PQ, expression=100)
    path = tmp_path / "checkpoints" / "probtalk-pqvae.safetensors"
    save_checkpoint(path, PQVAE(config), config)
    stage = Stage(f"probtalk-{part}", tmp_path)
    with pytest.raises(ValueError, match=rf"{stage.name} .* 288 numbers a frame, .* 376; train"):
        STAGES[part](stage)


def test_without_a_record_the_study_says_what_to_do(tmp_path):
    with pytest.raises(FileNotFoundError, match="--retrain"):
        probtalk_speakers.speaker_rows(tmp_path)
