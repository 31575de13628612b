"""The rows of `evaluate probtalk` on made-up clips: real motion gets what real motion should."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import torch

from s2glib.corpus import EMOTIONS, SPEAKERS, Cell
from s2glib.metrics import beat_score, mean_speeds
from s2glib.papers.probtalk import (
    PQVAE,
    TEACHING_FEATURES,
    TEACHING_PQVAE,
    TEACHING_PREDICTOR,
    TEACHING_REFINER,
    FeatureNets,
    Predictor,
    ProbTalk,
    Refiner,
)
from s2glib.recipes import evaluate_holistic, evaluate_variety
from s2glib.recipes import evaluate_probtalk as module
from s2glib.recipes.evaluate_holistic import (
    consistency_row,
    crowd_rows,
    manner_rows,
    real_rows,
    rhythm_rows,
    truth_of,
    truth_rows,
)
from s2glib.recipes.evaluate_refiner import context_rows, refiner_rows
from s2glib.recipes.evaluate_variety import nearest, variety_rows
from s2glib.recipes.holistic_data import HolisticClips, Tracks
from s2glib.recipes.holistic_seen import half_codes, look, mirrored
from s2glib.recipes.targets import PROBTALK

FRAMES = 48
PQ = replace(
    TEACHING_PQVAE, frames=FRAMES, widths=(8, 8, 8, 8), straight=0, latent=16, codes=8
)  # fmt: skip
THIN = {"width": 16, "heads": 2, "layers": 1, "hidden": 16, "style": 4}
FEATURES = replace(
    TEACHING_FEATURES, frames=24, widths=(8, 8, 8, 4), hidden=(8, 8), code=4, decoder_widths=(2, 8)
)
CELLS = [Cell(s, v, e, 2) for s in (0, 1) for v in SPEAKERS[:2] for e in EMOTIONS[:2]]


@pytest.fixture(scope="module")
def probtalk():
    torch.manual_seed(0)
    pqvae = PQVAE(PQ)
    pqvae.features.fit(0.3 * torch.randn(300, 55, 3), torch.rand(300, 100))
    predictor = Predictor(
        replace(TEACHING_PREDICTOR, codes=8, audio_width=8, context_widths=(8, 8, 8), **THIN)
    )
    refiner = Refiner(replace(TEACHING_REFINER, head=16, **THIN))
    refiner.features.load_state_dict(pqvae.features.state_dict())
    torch.nn.init.normal_(refiner.head[-1].weight, std=0.02)
    return ProbTalk(pqvae, predictor, refiner)


@pytest.fixture(scope="module")
def nets(probtalk):
    nets = FeatureNets(FEATURES).eval()
    nets.features.load_state_dict(probtalk.pqvae.features.state_dict())
    return nets


def swaying(cells, features, *, hear=None, seed=0):
    """Smooth motion of a second and a half or more, and noise to hear."""
    rng = np.random.default_rng(seed)
    tracks = []
    for _ in cells:
        seconds = np.arange(rng.integers(FRAMES, 2 * FRAMES))[:, None, None] / 30
        pace, phase = rng.uniform(2, 9, (2, 1, 55, 3))
        poses = torch.from_numpy(0.3 * np.sin(pace * seconds + phase)).float()
        tracks.append(features.from_motion(poses, torch.rand(len(poses), 100)))
    speech = Tracks(torch.from_numpy(rng.normal(size=(150, 64))).float() for _ in cells)
    return HolisticClips(cells, Tracks(tracks), speech, np.arange(len(cells)))


@pytest.fixture(autouse=True)
def _corpus(monkeypatch):
    rng = np.random.default_rng(0)
    onsets = [np.sort(rng.uniform(0, 3, 12)) for _ in CELLS]
    monkeypatch.setattr(evaluate_holistic, "onset_set", lambda requests: onsets)
    for room in (module, evaluate_variety):
        monkeypatch.setattr(room, "split", lambda name: CELLS)
        monkeypatch.setattr(room, "holistic_clips", partial(swaying, seed=1))
    monkeypatch.setattr(module, "OTHERS", len(CELLS))
    monkeypatch.setattr(module, "STEPS", (1, 8))
    monkeypatch.setattr(evaluate_variety, "CLIPS", 3)
    monkeypatch.setattr(evaluate_variety, "SAMPLES", 3)


@pytest.fixture
def clips(probtalk):
    return swaying(CELLS, probtalk.pqvae.features)


@pytest.fixture
def truth(nets, clips):
    others = swaying(CELLS, nets.features, seed=1)
    codes = half_codes(nets, others.first(FRAMES), others.motion.lengths)
    return truth_of(nets, clips, FRAMES, codes)


def figures(rows):
    return {row.name: row.value for row in rows}


def test_real_motion_is_at_no_distance_from_itself(truth):
    got = figures(crowd_rows(truth, truth.seen, "x") + truth_rows(truth, truth.seen, "x"))
    assert len(got) == 9
    assert np.allclose(list(got.values()), 0, atol=1e-6)


def test_real_motion_is_some_way_from_other_real_motion(truth):
    real = figures(real_rows(truth))
    others = truth.seen._replace(codes=truth.others)
    for kind in ("face", "body and hands", "all"):
        distance = real[f"FGD, {kind}, other real clips"]
        assert distance > 0
        moved = figures(crowd_rows(truth, others, "x"))
        ratio = moved[f"FGD, {kind}, x"] / distance
        assert moved[f"FGD ratio, {kind}, x"] == pytest.approx(ratio, rel=0.5)


def test_real_motion_moves_and_keeps_time_as_real_motion_does(truth):
    got = figures(manner_rows(truth, truth.seen, "x") + rhythm_rows(truth, truth.seen, "x"))
    real = figures(real_rows(truth))
    assert got["BC, x"] == real["BC of real motion"]
    assert got["agreement of wrists, x"] == real["agreement of wrists, real motion"]
    assert got["speed of wrists / real, x"] == got["jerk of wrists / real, x"] == 1


def test_both_readings_of_the_error_are_of_the_same_joints(truth):
    moved = truth.seen._replace(joints=truth.seen.joints + np.array([0.03, 0.0, 0.0]))
    got = figures(truth_rows(truth, moved, "x"))
    assert got["MAE, sum over joints, m, x"] == pytest.approx(55 * 0.03)
    assert got["MAE, mean over coordinates, cm, x"] == pytest.approx(1.0)


def test_onsets_weigh_the_same_whatever_their_clip(truth):
    heard = [np.linspace(0.1, 1.4, 40), *([np.array([0.5])] * (len(CELLS) - 1))]
    bodies = [body[:, :22] for body in truth.seen.own]
    speed = mean_speeds(bodies, 30, preset="probtalk")
    scores = [
        beat_score(body, beats, 30, preset="probtalk", reference_speed=speed)
        for body, beats in zip(bodies, heard, strict=True)
    ]
    row = consistency_row("x", truth._replace(onsets=heard), truth.seen)
    assert row.value == pytest.approx(np.average(scores, weights=[40] + 7 * [1]))


def test_beats_after_a_clips_end_do_not_count(truth):
    ends = truth.seen.lengths / 30
    assert all(beats.max() < end for beats, end in zip(truth.onsets, ends, strict=True))


def test_the_best_sample_may_be_the_mirror_of_the_truth(rng):
    truth, far = rng.normal(size=(2, 5, 55, 3))
    assert nearest(np.stack([far, mirrored(truth)]), truth) == pytest.approx(0)
    assert nearest(far[None], truth) > 1


def test_the_best_of_more_samples_is_no_worse(rng):
    truth, samples = rng.normal(size=(5, 55, 3)), rng.normal(size=(4, 5, 55, 3))
    assert nearest(samples, truth) <= nearest(samples[:2], truth)


def test_every_measured_target_has_a_row_and_no_name_comes_twice(probtalk, nets, clips, truth):
    rows = [
        *refiner_rows(probtalk, clips),
        *module.generated_rows(probtalk, nets, clips, truth),
        *context_rows(probtalk, clips),
        *variety_rows(probtalk, clips),
    ]
    names = [row.name for row in rows]
    assert len(names) == len(set(names))
    assert {name for name in PROBTALK if not name.startswith("codes: ")} <= set(names)
    assert {"FGD ratio, all, 1 step", "FGD ratio, all, 8 steps", "BC, not refined"} <= set(names)
    assert all(np.isfinite(row.value) for row in rows)
    best = "best of 32 samples, cm^2"
    assert figures(rows)[best] != figures(rows)[f"{best}, not refined"]
    assert figures(rows)["one second kept: largest change of what is written"] == 0


def test_feature_networks_of_other_statistics_are_refused(probtalk):
    with pytest.raises(ValueError, match="train probtalk-features after probtalk-pqvae"):
        module.check_statistics(probtalk, FeatureNets(FEATURES))


def test_without_a_refiner_there_is_nothing_to_measure(probtalk, clips):
    with pytest.raises(ValueError, match="train probtalk-refiner"):
        refiner_rows(ProbTalk(probtalk.pqvae, probtalk.predictor), clips)


def test_looking_at_motion_does_not_depend_on_its_company(nets, clips):
    motion = clips.first(FRAMES)
    whole = look(nets, motion, clips.motion.lengths)
    one = look(nets, motion[2:3], clips.motion.lengths[2:3])
    assert np.allclose(whole.joints[2], one.joints[0])
