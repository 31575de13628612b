"""The stage that trains the Predictor, on small networks and made-up motion."""

import json
from dataclasses import replace

import numpy as np
import pytest
import torch

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.corpus import EMOTIONS, SPEAKERS, Cell
from s2glib.corpus.build import timing_of
from s2glib.papers.probtalk import (
    PAPER_PREDICTOR,
    PQVAE,
    TEACHING_PQVAE,
    TEACHING_PREDICTOR,
    Predictor,
)
from s2glib.papers.probtalk.pipeline import ProbTalk
from s2glib.recipes import probtalk_predictor as recipe
from s2glib.recipes.fit import Chance, Course, Training
from s2glib.recipes.holistic_data import HolisticClips, Tracks
from s2glib.recipes.predictor_scores import (
    _WRISTS,
    GUIDANCES,
    MARGINS,
    SPEED,
    held_out,
    nothing_given,
    predictor_scores,
    rhythm_scores,
    token_scores,
    wise_guidance,
    wrist_speed,
)
from s2glib.recipes.stage import Stage

THIN = {"audio_width": 8, "context_widths": (4, 8, 8), "width": 16, "heads": 2, "layers": 1}
THIN |= {"hidden": 16, "style": 4}
CONFIG = replace(TEACHING_PREDICTOR, **THIN)
PQ = replace(TEACHING_PQVAE, widths=(8, 8, 8, 8))
COURSE = Course(steps=3, batch=8, learning_rate=1e-3, warm_up=1)
LESSON = recipe.Lesson(COURSE, hidden="random", parts=True, unheard=0.3, stress=1.0)
CELLS = [Cell(s, v, e, 0) for s in (0, 1) for v in SPEAKERS[:2] for e in EMOTIONS[:2]]


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.fixture
def clips(rng):
    lengths = rng.integers(120, 230, len(CELLS))
    motion = Tracks(torch.randn(n, 288).cumsum(0) / 10 for n in lengths)
    speech = Tracks(torch.randn(211, 64) for _ in CELLS)
    return HolisticClips(CELLS, motion, speech, np.arange(len(CELLS))[::-1].copy())


@pytest.fixture
def pqvae():
    model = PQVAE(PQ)
    model.features.fit(0.3 * torch.randn(300, 55, 3), torch.rand(300, 100))
    return model.eval().requires_grad_(False)


@pytest.fixture
def data(clips, pqvae):
    return recipe.PredictorData(clips, pqvae, 4)


def chance(progress=0.0, seed=0):
    return Chance(np.random.default_rng(seed), torch.Generator().manual_seed(seed), progress)


def test_three_steps_train_every_part_and_leave_the_pqvae_alone(data, pqvae):
    model = Predictor(CONFIG)
    before = {name: p.clone() for name, p in model.named_parameters()}
    codebooks = {name: value.clone() for name, value in pqvae.state_dict().items()}
    objective = recipe.PredictorObjective(model, LESSON)
    logs = list(Training(objective, COURSE).run(lambda c: data.draw(LESSON, model.mask, c)))
    assert np.isfinite([log.loss for log in logs]).all()
    assert not [n for n, p in model.named_parameters() if torch.equal(p, before[n])]
    assert all(torch.equal(v, codebooks[name]) for name, v in pqvae.state_dict().items())


def test_targets_are_the_codes_of_the_whole_window(data, pqvae):
    rows, offsets = np.array([3, 7]), np.array([0, 2])
    step = data.step(rows, offsets, torch.zeros(2, 176, 4, dtype=torch.bool))
    assert torch.equal(step.target, pqvae.encode(data.clips.moving(rows, offsets, 176)))
    assert torch.equal(step.speech, data.clips.heard(rows, offsets, 176))
    assert step.speaker.tolist() == [SPEAKERS.index(CELLS[row].speaker) for row in rows]


def test_only_what_is_known_is_seen(data):
    known = torch.zeros(1, 176, 4, dtype=torch.bool)
    known[:, 10:40, 1] = True
    step = data.step(np.array([0]), np.array([0]), known)
    motion = data.clips.moving(np.array([0]), np.array([0]), 176)
    assert torch.equal(step.context[:, 10:40, 6:96], motion[:, 10:40, 6:96])
    assert step.context.count_nonzero() == motion[:, 10:40, 6:96].count_nonzero()
    assert torch.equal(step.context_mask, known)


def test_with_one_mask_for_all_parts_a_frame_is_known_whole_or_not_at_all(clips, pqvae):
    known = torch.zeros(1, 176, 4, dtype=torch.bool)
    known[:, 10:40, 1] = True
    known[:, 20:30] = True
    data = recipe.PredictorData(clips, pqvae, 1)
    step = data.step(np.array([0]), np.array([0]), known)
    assert step.context_mask.shape == (1, 176, 1)
    assert step.context_mask[0, :, 0].nonzero()[:, 0].tolist() == [*range(20, 30)]
    assert not step.context[:, 10:20].any()


@pytest.mark.parametrize(("progress", "hidden"), [(0.0, 44), (0.75, 66), (1.0, 88)])
def test_the_curriculum_hides_more_and_more(data, progress, hidden):
    lesson = replace(LESSON, hidden="curriculum")
    step = data.draw(lesson, 128, chance(progress))
    assert ((step.codes == 128).flatten(1).sum(1) == hidden).all()


def test_a_random_share_differs_from_clip_to_clip(data):
    counts = (data.draw(LESSON, 128, chance()).codes == 128).flatten(1).sum(1)
    assert len(counts.unique()) > 4


def test_all_tokens_count_or_the_hidden_ones(data):
    model = Predictor(CONFIG).eval()
    step = data.draw(replace(LESSON, hidden="curriculum"), model.mask, chance())
    plain = replace(LESSON, stress=0.0)
    (whole, terms), (hidden, _) = (
        recipe.PredictorObjective(model, replace(plain, region=region))(step)
        for region in ("all", "hidden")
    )
    odds = model(*step[1:6]).log_softmax(-1).gather(-1, step.target[..., None])[..., 0]
    torch.testing.assert_close(whole, -odds.mean())
    torch.testing.assert_close(hidden, -odds[step.codes == model.mask].mean())
    assert torch.equal(terms["hidden"], hidden)


def test_stresses_are_heard_where_the_clock_has_them(data):
    """Those of a window, counted from its first frame."""
    rows, offsets = np.array([3, 7]), np.array([0, 2])
    step = data.step(rows, offsets, torch.zeros(2, 176, 4, dtype=torch.bool))
    for row, offset, track in zip(rows, offsets, step.stress, strict=True):
        times = timing_of(CELLS[row]).stress_times
        inside = [int(time * 30) - offset for time in times if 0 <= int(time * 30) - offset < 176]
        assert len(inside) > 2
        assert (track[inside] > 0.9).all()
        assert track.mean() < 0.5


def test_saying_when_stresses_come_teaches_what_tokens_look_at_and_not_the_blocks(data):
    model = Predictor(CONFIG)
    step = data.draw(LESSON, model.mask, chance())
    loss, terms = recipe.PredictorObjective(model, replace(LESSON, stress=2.0))(step)
    torch.testing.assert_close(loss, recipe_loss(model, step) + 2 * terms["stress"])
    terms["stress"].backward()
    assert all(p.grad is not None for p in model.audio.parameters())
    assert all(p.grad is None for p in model.decoder.parameters())


def recipe_loss(model, step):
    """The cross-entropy of all tokens."""
    odds = model(*step[1:6]).log_softmax(-1)
    return -odds.gather(-1, step.target[..., None]).mean()


def test_now_and_then_nothing_is_heard(data):
    heard = data.draw(replace(LESSON, unheard=0.0), 128, chance()).speech
    some = data.draw(replace(LESSON, unheard=0.5), 128, chance()).speech
    silent = ~some.flatten(1).any(dim=1)
    assert 0 < silent.sum() < len(silent)
    assert torch.equal(some[~silent], heard[~silent])


def test_token_scores_are_the_cross_entropy_with_all_hidden(data, pqvae):
    model = Predictor(CONFIG).eval()
    windows = held_out(data.clips, 176)
    scores = token_scores(pqvae, model, windows, nothing_given(windows))
    step = data.step(
        np.arange(len(CELLS)), np.zeros(len(CELLS), int), torch.zeros(len(CELLS), 176, 4).bool()
    )
    with torch.no_grad():
        odds = model(torch.full_like(step.target, 128), *step[2:6]).log_softmax(-1)
    real = torch.arange(22) * 8 < torch.from_numpy(windows.lengths)[:, None]
    odds, target = odds[real], step.target[real]
    expected = -odds.gather(-1, target[..., None]).mean()
    assert scores["cross-entropy"] == pytest.approx(float(expected), abs=1e-4)
    assert scores["token accuracy"] == pytest.approx(
        float((odds.argmax(-1) == target).float().mean())
    )
    assert scores["cross-entropy"] != scores["cross-entropy, another's speech"]


def test_rhythm_is_taken_of_decoded_motion_and_of_each_guidance(data, pqvae):
    windows = held_out(data.clips, 176)
    system = ProbTalk(pqvae, Predictor(CONFIG))
    scores = rhythm_scores(system, data.clips, windows, nothing_given(windows), (1.0, 2.5))
    kinds = {"decoded", "guidance 1", "guidance 2.5"}
    assert scores.keys() == {f"{name}, {kind}" for name in (SPEED, *MARGINS) for kind in kinds}


def test_wrists_are_as_fast_as_they_go(rng):
    places = np.zeros((2, 20, 9, 3))
    places[:, :, _WRISTS, 0] = 0.1 * np.arange(20)[:, None] / 30
    places[1, 15:] = places[1, 14:15] + 5  # held after its end, does not count
    assert wrist_speed(places, np.array([20, 15])) == pytest.approx(0.1)


@pytest.mark.parametrize(("fast", "wise"), [(2.0, 1.5), (1.1, 3.0), (9.0, 1.5)])
def test_the_wise_guidance_has_the_best_beats_but_is_not_too_fast(fast, wise):
    tried = {1.0: (1.0, 0.1), 1.5: (1.1, 0.3), 2.0: (1.1, 0.2), 2.5: (1.0, 0.0), 3.0: (fast, 0.4)}
    figures = {}
    for guidance, (speed, margin) in tried.items():
        end = f", guidance {guidance:g}"
        figures |= {SPEED + end: speed} | {name + end: margin for name in MARGINS}
    assert wise_guidance(figures) == wise


def test_where_all_are_too_fast_there_is_no_guidance():
    figures = {f"{name}, guidance 2": 2.0 for name in (SPEED, *MARGINS)}
    assert wise_guidance(figures, (2.0,)) == 1.0


@pytest.mark.parametrize(
    ("preset", "config"),
    [("teaching", CONFIG), ("paper", replace(PAPER_PREDICTOR, motion=288, **THIN))],
)
def test_the_stage_leaves_a_checkpoint_and_its_figures(
    tmp_path, clips, pqvae, monkeypatch, preset, config
):
    save_checkpoint(tmp_path / "checkpoints" / "probtalk-pqvae.safetensors", pqvae, PQ)
    monkeypatch.setitem(recipe.PREDICTOR_PRESETS, preset, config)
    monkeypatch.setitem(recipe.LESSONS, preset, replace(recipe.LESSONS[preset], course=COURSE))
    monkeypatch.setattr(recipe, "holistic_clips", lambda *_, **__: clips)
    recipe.train(Stage("probtalk-predictor", tmp_path, preset=preset, steps=2))
    path = tmp_path / "checkpoints" / "probtalk-predictor.safetensors"
    model = load_checkpoint(path, Predictor)
    run = json.loads((tmp_path / "runs" / f"probtalk-predictor-{preset}-0.json").read_text())
    tried = GUIDANCES if recipe.LESSONS[preset].unheard else (1.0,)
    assert run["figures"].keys() == predictor_scores(pqvae, model, clips, tried).keys()
    chosen = wise_guidance(run["figures"], tried)
    assert model.config == replace(config, speech=64, speakers=24, guidance=chosen)
    assert run["steps"] == 2


def test_without_a_pqvae_the_stage_says_so(tmp_path):
    with pytest.raises(FileNotFoundError, match="probtalk-pqvae"):
        recipe.train(Stage("probtalk-predictor", tmp_path, steps=2))


def test_the_papers_lesson_is_the_authors():
    lesson = recipe.LESSONS["paper"]
    assert (lesson.hidden, lesson.parts, lesson.region) == ("curriculum", False, "all")
    assert (lesson.course.betas, lesson.course.clip) == ((0.9, 0.99), 5.0)
    assert lesson.course.rate(0) == lesson.course.rate(30_000) == 1e-4
