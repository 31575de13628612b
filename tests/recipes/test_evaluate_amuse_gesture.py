"""Judges that read the emotion off a number which the test writes into the hands."""

from itertools import product

import numpy as np
import pytest
import torch
from torch import nn
from torch.nn import functional as F

from s2glib.corpus.build import SpeechSet
from s2glib.corpus.script import EMOTIONS, SPEAKERS, Cell
from s2glib.papers.amuse.config import (
    TEACHING_DENOISER,
    TEACHING_EXTRACTOR,
    TEACHING_PRIOR,
    TEACHING_SPEECH,
)
from s2glib.papers.amuse.disentangler import SpeechDisentangler
from s2glib.papers.amuse.latent_denoiser import LatentDenoiser
from s2glib.papers.amuse.motion_extractor import Judgement, MotionExtractor, PositionJudge
from s2glib.papers.amuse.motion_features import UpperBodyFeatures
from s2glib.papers.amuse.motion_prior import MotionPrior
from s2glib.papers.amuse.pipeline import Amuse, Sampling
from s2glib.papers.amuse.speech_face import FaceConfig, SpeechFace
from s2glib.papers.amuse.stress_listener import StressConfig, StressListener
from s2glib.recipes.evaluate_amuse_gesture import (
    check_statistics,
    generator_rows,
    manner_rows,
    prior_rows,
)
from s2glib.recipes.evaluate_frechet import distances, principal_components
from s2glib.recipes.motion_seen import Judges, look
from s2glib.recipes.speech_clips import encode_clips
from s2glib.recipes.targets import AMUSE_GESTURE

CELLS = [Cell(*f, 2) for f in product((1, 3), SPEAKERS[:4], EMOTIONS)]
EMOTION = np.array([EMOTIONS.index(cell.emotion) for cell in CELLS])
TOLD_BY = 89  # the last hand component


class Reader(MotionExtractor):
    def __init__(self, features):
        nn.Module.__init__(self)
        self.features = features

    def forward(self, motion):
        told = motion[:, 0, TOLD_BY].round().clamp(0, 7).long()
        return Judgement(F.one_hot(told, 8).float(), motion[:, 0, :8])


class SecondReader(PositionJudge):
    __init__, forward = Reader.__init__, Reader.forward


class Identity(MotionPrior):
    def __init__(self):
        nn.Module.__init__(self)

    def forward(self, motion):
        return motion


@pytest.fixture(scope="module")
def features():
    rng = np.random.default_rng(0)
    features = UpperBodyFeatures()
    features.fit(torch.from_numpy(rng.normal(0, 0.3, (60, 55, 3))).float())
    return features


@pytest.fixture(scope="module")
def judges(features):
    return Judges(Reader(features), SecondReader(features))


def swaying(features, size=1.0, seed=0):
    """A smooth motion for every cell, with the emotion written into the hands."""
    rng = np.random.default_rng(seed)
    seconds = np.arange(120)[:, None, None] / 30
    pace, phase = rng.uniform(2, 6, (2, len(CELLS), 1, 55, 3))
    size = np.broadcast_to(size, len(CELLS))[:, None, None, None]
    poses = 0.3 * size * np.sin(pace * seconds + phase)
    motion = features.from_poses(torch.from_numpy(poses).float())
    motion[:, :, TOLD_BY] = torch.from_numpy(EMOTION)[:, None].float()
    return motion


@pytest.fixture(scope="module")
def real(judges, features):
    return look(judges, swaying(features))


def figures(rows):
    return {row.name: row.value for row in rows}


def test_judges_see_rotations_whatever_the_features_hold(judges, features, real):
    six = slice(0, 78)
    stretched = swaying(features)
    raw = stretched * features.std + features.mean
    stretched[..., six] = ((2 * raw - features.mean) / features.std)[..., six]
    seen = look(judges, stretched)
    assert torch.allclose(seen.motion, real.motion, atol=1e-4)
    assert np.allclose(seen.places, real.places, atol=1e-5)


def test_a_prior_that_changes_nothing_costs_nothing(judges, real):
    got = figures(prior_rows(judges, Identity(), real, EMOTION))
    assert got["prior: wrist error, cm"] < 1e-3
    assert got["prior: spread / real"] == pytest.approx(1, abs=1e-5)
    for judge in ("M", "positions"):
        assert got[f"GA of real motion, {judge}"] == got[f"prior: GA / real, {judge}"] == 1


def test_motion_like_the_real_one_has_its_manner(real):
    got = figures(manner_rows(real, real, EMOTION))
    assert all(got[f"{what} of wrists / real"] == 1 for what in ("spread", "speed", "jerk"))


def test_larger_motion_in_anger_shows_in_the_speed_of_the_wrists(judges, features, real):
    size = np.where(EMOTIONS.index("anger") == EMOTION, 2.0, 1.0)
    got = figures(manner_rows(real, look(judges, swaying(features, size)), EMOTION))
    unhurried = got["wrist speed, anger / sadness, real"]
    assert got["wrist speed, anger / sadness, generated"] > 1.5 * unhurried


def test_identical_sets_have_frechet_ratio_zero_and_another_draw_has_one(rng):
    real, others, fresh = rng.normal(size=(3, 400, 30))
    assert np.allclose(distances(real, real, others, count=200).made, 0, atol=1e-9)
    assert distances(real, fresh, others, count=400).ratios.mean() == pytest.approx(1, abs=0.3)
    assert distances(real, fresh + 1, others, count=400).ratios.mean() > 5


def test_principal_components_are_those_of_the_svd(rng):
    clips = rng.normal(size=(40, 60)) * np.linspace(3, 0.1, 60)
    ours = principal_components(torch.from_numpy(clips), 4).numpy()
    theirs = np.linalg.svd(clips - clips.mean(0), full_matrices=False)[2][:4]
    assert np.allclose(np.abs(theirs @ ours), np.eye(4), atol=1e-5)


def test_judges_trained_on_other_statistics_are_refused(features):
    prior = MotionPrior(TEACHING_PRIOR)
    prior.features = features
    other = MotionExtractor(TEACHING_EXTRACTOR)
    with pytest.raises(ValueError, match="MotionExtractor and the prior"):
        check_statistics(prior, Judges(other, SecondReader(features)))


@pytest.fixture
def amuse(features):
    """Networks that were never trained, but move."""
    torch.manual_seed(0)
    prior, denoiser = MotionPrior(TEACHING_PRIOR), LatentDenoiser(TEACHING_DENOISER)
    prior.features = features
    nn.init.normal_(denoiser.out.weight, std=0.1)
    speech, face = SpeechDisentangler(TEACHING_SPEECH), SpeechFace(FaceConfig())
    stress = StressListener(StressConfig())
    return Amuse(speech, prior, denoiser, stress, face, Sampling(steps=2))


@pytest.fixture
def _corpus(monkeypatch):
    rng = np.random.default_rng(0)

    def speech_set(requests, window):
        shape = (len(requests), window["frames"], window["n_mels"])
        windows = rng.normal(-9, 4, shape).astype(np.float16)
        return SpeechSet(windows, np.full(len(requests), 5.0))

    def onset_set(requests):
        return [np.sort(rng.uniform(0, 5, 12)) for _ in requests]

    monkeypatch.setattr("s2glib.recipes.speech_clips.speech_set", speech_set)
    monkeypatch.setattr("s2glib.recipes.evaluate_amuse_gesture.onset_set", onset_set)


@pytest.mark.usefixtures("_corpus")
def test_prior_and_generator_have_a_row_for_every_target(judges, amuse, features, real):
    others = look(judges, swaying(features, seed=1))
    speech = encode_clips(amuse.speech, CELLS)
    rows = prior_rows(judges, amuse.prior, real, EMOTION)
    rows += generator_rows(judges, amuse, real, others, speech)
    names = [row.name for row in rows]
    assert set(AMUSE_GESTURE) <= set(names)
    assert len(names) == len(set(names))
    assert all(np.isfinite(row.value) for row in rows)
    assert figures(rows)["same seed twice, largest difference"] == 0
