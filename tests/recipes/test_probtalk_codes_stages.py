"""The PQ-VAE and the study of codes through their recipes: narrow networks, made-up clips."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import torch

from s2glib.checkpoint import load_checkpoint, read_metadata
from s2glib.corpus import Cell
from s2glib.papers.probtalk import PAPER_PQVAE, PQVAE, PQVAE_PRESETS, TEACHING_PQVAE
from s2glib.recipes import Chance, Course, Stage, Training, code_scores, probtalk_codes
from s2glib.recipes import probtalk_pqvae as recipe
from s2glib.recipes.holistic_data import HolisticClips, Tracks

NARROW = {"frames": 32, "widths": (8, 8, 8, 8), "latent": 16, "codes": 8}
STRAIGHT = {"paper": 0, "teaching": 8}
CONFIGS = {
    name: replace(config, straight=STRAIGHT[name], **NARROW)
    for name, config in (("paper", PAPER_PQVAE), ("teaching", TEACHING_PQVAE))
}
COURSE = Course(steps=3, batch=4, learning_rate=1e-3, warm_up=1)
CELLS = [Cell(s, "voice_01", "anger", 0) for s in range(6)]


def made_up(cells, features):
    torch.manual_seed(0)
    return HolisticClips(cells, Tracks(torch.randn(100, features.size) for _ in cells))


def chance():
    return Chance(np.random.default_rng(0), torch.Generator().manual_seed(0), 0.0)


@pytest.fixture
def _corpus(monkeypatch):
    """Few clips of noise, few steps, few codes."""

    def fitted(cells, config):
        return PQVAE(config).features

    for module in (recipe, probtalk_codes):
        monkeypatch.setattr(module, "split", lambda name: CELLS)
        monkeypatch.setattr(module, "holistic_clips", made_up)
        monkeypatch.setattr(module, "fitted_features", fitted)
    monkeypatch.setattr(recipe, "motion_cells", lambda: CELLS)
    for name, config in CONFIGS.items():
        monkeypatch.setitem(PQVAE_PRESETS, name, config)
        monkeypatch.setitem(recipe.COURSES, name, COURSE)


def test_three_steps_move_networks_and_codes():
    model = PQVAE(CONFIGS["teaching"])
    before = {name: value.clone() for name, value in model.state_dict().items()}
    draw = partial(recipe.draw, made_up(CELLS, model.features), 32, COURSE)
    losses = [log.loss for log in Training(recipe.PQVAEObjective(model), COURSE).run(draw)]
    assert np.isfinite(losses).all()
    moved = {n for n, v in model.state_dict().items() if not torch.equal(v, before[n])}
    assert {name for name, _ in model.named_parameters()} | {"quantizer.tables.vectors"} <= moved


def test_a_batch_is_drawn_from_its_chance():
    clips = made_up(CELLS, PQVAE(CONFIGS["teaching"]).features)
    first, second = (recipe.draw(clips, 32, COURSE, chance()) for _ in range(2))
    assert first.shape == (4, 32, 288)
    assert torch.equal(first, second)


def test_the_weights_of_the_loss_are_the_configs():
    weights = {"commitment": 7.0, "wrists": 3.0, "movement": 5.0}
    model = PQVAE(replace(CONFIGS["teaching"], **weights)).eval()
    with torch.no_grad():
        loss, terms = recipe.PQVAEObjective(model)(torch.randn(2, 32, 288))
    rest = recipe.pqvae_losses(model, torch.zeros(1, 8, 288))._replace(**terms)
    torch.testing.assert_close(loss, rest.total(**weights))


@pytest.mark.usefixtures("_corpus")
@pytest.mark.parametrize("preset", ["paper", "teaching"])
def test_the_stage_leaves_a_checkpoint_and_the_figures_that_evaluate_prints(tmp_path, preset):
    recipe.train(Stage("probtalk-pqvae", tmp_path, preset=preset))
    path = tmp_path / "checkpoints" / "probtalk-pqvae.safetensors"
    model = load_checkpoint(path, PQVAE)
    figures = read_metadata(path)["figures"]
    scores = code_scores.code_scores(model, made_up(CELLS, model.features))
    assert figures["wrist error in cm"] == pytest.approx(scores.wrist.mean(), rel=0.05)
    record = json.loads((tmp_path / "runs" / f"probtalk-pqvae-{preset}-0.json").read_text())
    assert record["figures"] == figures
    assert record["config"]["groups"] == 4


def test_arms_of_equal_memory_and_of_equal_bits():
    arms = probtalk_codes.arms(TEACHING_PQVAE)
    memory = {name: arms[name].codes * 512 for name in ("PQ 4 x 128", "VQ 128")}  # any chunking
    assert set(memory.values()) == {65_536}
    bits = {a.groups * np.log2(a.codes) for name, a in arms.items() if name not in memory}
    assert bits == {12}
    assert arms["PQ 4 x 128"] == TEACHING_PQVAE
    assert arms["VQ 4096"].revive_below * 4096 == pytest.approx(TEACHING_PQVAE.revive_below * 128)


@pytest.mark.usefixtures("_corpus")
def test_the_study_leaves_a_record_that_rows_are_read_from(tmp_path, monkeypatch):
    small = {n: a for n, a in probtalk_codes.arms(CONFIGS["teaching"]).items() if "4096" not in n}
    monkeypatch.setattr(probtalk_codes, "arms", lambda config: small)
    for seed in probtalk_codes.SEEDS:
        probtalk_codes.train(Stage("probtalk-codes", tmp_path, steps=2, seed=seed))
    rows = {row.name: row.value for row in code_scores.study_rows(tmp_path / "runs")}
    record = json.loads((tmp_path / "runs" / "probtalk-codes-teaching-0.json").read_text())
    assert record["course"]["steps"] == 2
    for name in small:
        assert f"short runs: {name}: perplexity / codes" in rows
    assert rows["short runs: part-wise error, PQ / VQ, equal memory, worst seed"] > 0
    assert record["figures"].keys() == {
        f"{name}: {what}"
        for name in small
        for what in ("wrist error, cm", "part-wise error", "perplexity / codes")
    }


@pytest.mark.parametrize(("best", "numbers"), [("VQ 4096", 4096 * 512), ("RQ 4 x 8", 32 * 512)])
def test_the_verdict_names_the_best_at_equal_bits_and_what_it_needs(tmp_path, best, numbers):
    for seed, off in enumerate((0.0, 1.0)):
        errors = dict.fromkeys(probtalk_codes.EQUAL_BITS, 5.0 + off) | {best: 4.0 + off}
        figures = {f"{name}: wrist error, cm": error for name, error in errors.items()}
        path = tmp_path / f"probtalk-codes-teaching-{seed}.json"
        path.write_text(json.dumps({"figures": figures}))
    verdict = probtalk_codes.equal_bits_verdict(tmp_path)
    assert f"{best} wins: wrists 4.5 cm off with {numbers} numbers" in verdict
    assert f"PQ 4 x 8 5.5 cm with {8 * 512}" in verdict
