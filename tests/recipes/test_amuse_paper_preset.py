"""The paper's preset through the recipes: narrow networks here, all of them on a GPU."""

import json
from dataclasses import replace

import numpy as np
import pytest
import torch

from s2glib.audio import Waveform
from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.corpus import EMOTIONS, SPEAKERS, Cell
from s2glib.corpus.build import WINDOW, MotionSet, SpeechSet
from s2glib.papers.amuse import (
    PAPER_DENOISER,
    PAPER_EXTRACTOR,
    PAPER_PRIOR,
    PAPER_SPEECH,
    TEACHING_SPEECH,
    Amuse,
    FaceConfig,
    MotionExtractor,
    Sampling,
    SpeechDisentangler,
    SpeechFace,
    StressConfig,
    StressListener,
    WholeBodyFeatures,
)
from s2glib.recipes import (
    FactorTable,
    Stage,
    amuse_disentangler,
    amuse_extractor,
    amuse_gestures,
    amuse_prior,
    amuse_stress,
    motion_data,
)

SPEECH = replace(PAPER_SPEECH, n_mels=16, width=8, layers=1, heads=2, decoder_width=8)
THIN = {"layers": 3, "heads": 2, "hidden": 16}
PRIOR = replace(PAPER_PRIOR, token_dim=16, **THIN)
DENOISER = replace(PAPER_DENOISER, token_dim=16, width=16, **THIN)
EXTRACTOR = replace(PAPER_EXTRACTOR, width=16, **THIN)
CELLS = [Cell(c, s, e, t) for c in (0, 1) for s in SPEAKERS[:2] for e in EMOTIONS for t in (0, 1)]
SPLITS = {
    "train": CELLS,
    "validation": CELLS[:4],
    "motion": [cell._replace(take=10) for cell in CELLS[:4]],
}


def of_preset(part, folder, steps=2):
    return Stage(part, folder, preset="paper", steps=steps)


def record(folder, part):
    return json.loads((folder / "runs" / f"{part}-paper-0.json").read_text())


@pytest.fixture
def _corpus(monkeypatch):
    """A few clips that nobody rendered, four to a batch."""
    rng = np.random.default_rng(0)
    torch.manual_seed(0)

    def motion_set(cells):
        poses = [
            rng.normal(0, 0.1, (length, 55, 3)) for length in rng.integers(40, 320, len(cells))
        ]
        return MotionSet([p.astype(np.float16) for p in poses], 30)

    def factor_table(name, config):
        cells = SPLITS[name]
        windows = torch.randn(len(cells), config.frames, config.n_mels).half()
        return FactorTable(cells, windows)

    monkeypatch.setattr(motion_data, "motion_set", motion_set)
    stages = (amuse_disentangler, amuse_stress, amuse_prior, amuse_gestures, amuse_extractor)
    for module in (motion_data, *stages):
        if hasattr(module, "split"):
            monkeypatch.setattr(module, "split", SPLITS.get)
        if hasattr(module, "factor_table"):
            monkeypatch.setattr(module, "factor_table", factor_table)
        for name in ("PRIOR", "DENOISER", "EXTRACTOR", "STRESS", "FACTOR_SWAP"):
            if hasattr(module, name):
                course = replace(getattr(module, name), batch=4)
                monkeypatch.setattr(module, name, course)


@pytest.fixture
def _thin(monkeypatch, _corpus):
    """The paper's preset but for the width and depth of its networks."""
    for presets, config in (
        (amuse_prior.PRIOR_PRESETS, PRIOR),
        (amuse_gestures.DENOISER_PRESETS, DENOISER),
        (amuse_extractor.EXTRACTOR_PRESETS, EXTRACTOR),
    ):
        monkeypatch.setitem(presets, "paper", config)


@pytest.fixture
def _thin_speech(monkeypatch):
    monkeypatch.setitem(amuse_disentangler.SPEECH_PRESETS, "paper", SPEECH)


def trained(folder):
    """Train all that gestures need, from 1024 frames of speech to 300 of motion."""
    checkpoints = folder / "checkpoints"
    save_checkpoint(
        checkpoints / "amuse-disentangler.safetensors", SpeechDisentangler(SPEECH), SPEECH
    )
    face = FaceConfig(n_mels=SPEECH.n_mels)
    save_checkpoint(checkpoints / "amuse-face.safetensors", SpeechFace(face), face)
    listens = StressConfig(n_mels=SPEECH.n_mels)
    save_checkpoint(checkpoints / "amuse-stress.safetensors", StressListener(listens), listens)
    stage = of_preset("amuse-gestures", folder)
    prior = amuse_prior.train_prior(stage).eval().requires_grad_(False)
    amuse_gestures.train_denoiser(stage, prior)
    return Amuse.load(checkpoints, Sampling(steps=2))


@pytest.mark.usefixtures("_thin", "_thin_speech")
def test_two_steps_of_every_network_are_enough_to_gesture(tmp_path):
    amuse = trained(tmp_path)
    assert isinstance(amuse.prior.features, WholeBodyFeatures)
    assert torch.equal(amuse.denoiser.latent_std, torch.ones(1, 16))  # raw latents, as printed
    for part in ("amuse-prior", "amuse-denoiser"):
        assert record(tmp_path, part)["course"]["steps"] == 2
    speech = np.random.default_rng(0).normal(0, 0.1, 16000).astype(np.float32)
    motion = amuse.generate(Waveform(speech, 16000), generator=torch.Generator().manual_seed(0))
    assert motion.frames == 30


@pytest.mark.usefixtures("_thin")
def test_both_judges_see_the_whole_body(tmp_path):
    amuse_extractor.train_motion_judges(of_preset("amuse-extractor", tmp_path))
    path = tmp_path / "checkpoints" / "amuse-extractor.safetensors"
    judge = load_checkpoint(path, MotionExtractor)
    assert isinstance(judge.features, WholeBodyFeatures)
    assert 0 <= record(tmp_path, "amuse-position-judge")["figures"]["GA of GT"] <= 100


@pytest.mark.usefixtures("_corpus", "_thin_speech")
def test_the_disentangler_and_the_listener_take_ten_seconds_unpooled(tmp_path):
    amuse_disentangler.train(of_preset("amuse-disentangler", tmp_path, steps=1))
    amuse_stress.train_stress(of_preset("amuse-gestures", tmp_path, steps=1))
    assert record(tmp_path, "amuse-disentangler")["config"]["frames"] == 1024
    assert -1 <= record(tmp_path, "amuse-stress")["figures"]["correlation with true stress"] <= 1


@pytest.mark.parametrize("config", [PAPER_SPEECH, TEACHING_SPEECH], ids=["paper", "teaching"])
def test_a_table_of_clips_has_the_window_of_its_model(monkeypatch, config):
    def speech_set(requests, window):
        shape = (len(requests), window["frames"], window["n_mels"])
        return SpeechSet(np.full(shape, config.mean, np.float16), np.ones(len(requests)))

    monkeypatch.setattr(amuse_disentangler, "split", lambda name: CELLS[:2])
    monkeypatch.setattr(amuse_disentangler, "speech_set", speech_set)
    windows = amuse_disentangler.factor_table("train", config).windows
    assert windows.shape == (2, config.frames, config.n_mels)
    assert windows.float().abs().max() < 1e-2


def test_the_small_models_window_is_the_one_that_lies_in_the_cache():
    assert TEACHING_SPEECH.window == WINDOW


@pytest.mark.gpu
@pytest.mark.usefixtures("_corpus", "_thin_speech")
def test_the_papers_own_sizes_train_on_a_gpu(tmp_path):
    amuse = trained(tmp_path)
    assert amuse.prior.config == PAPER_PRIOR
    assert amuse.denoiser.config == PAPER_DENOISER
    assert np.isfinite(record(tmp_path, "amuse-denoiser")["curve"][-1]["loss"])
    amuse_extractor.train_motion_judges(of_preset("amuse-extractor", tmp_path))
    assert record(tmp_path, "amuse-extractor")["config"]["width"] == 256
