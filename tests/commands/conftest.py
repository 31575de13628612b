"""Untrained networks in the right places, a body, and a sentence that nobody said."""

import json

import numpy as np
import pytest
import soundfile
import torch
from stand_in import capsule_body

from s2glib.__main__ import main
from s2glib.body.mannequin import save_mannequin
from s2glib.checkpoint import save_checkpoint
from s2glib.papers.amuse.config import TEACHING_DENOISER, TEACHING_PRIOR, TEACHING_SPEECH
from s2glib.papers.amuse.disentangler import SpeechDisentangler
from s2glib.papers.amuse.latent_denoiser import LatentDenoiser
from s2glib.papers.amuse.motion_prior import MotionPrior
from s2glib.papers.amuse.speech_face import FaceConfig, SpeechFace
from s2glib.papers.amuse.stress_listener import StressConfig, StressListener
from s2glib.papers.probtalk import PQVAE, TEACHING_PQVAE, TEACHING_PREDICTOR, Predictor
from s2glib.papers.probtalk.config import TEACHING_REFINER
from s2glib.papers.probtalk.refiner import Refiner


def untrained() -> dict[str, torch.nn.Module]:
    """Networks that listen: nothing that training would move away from zero is zero."""
    torch.manual_seed(0)
    speech, prior = SpeechDisentangler(TEACHING_SPEECH), MotionPrior(TEACHING_PRIOR)
    denoiser, face = LatentDenoiser(TEACHING_DENOISER), SpeechFace(FaceConfig())
    torch.nn.init.normal_(speech.emotion_centres, std=3.0)
    for weight in (w for w in denoiser.parameters() if not w.any()):
        torch.nn.init.normal_(weight, std=0.1)
    denoiser.latent_std.fill_(0.1)
    torch.nn.init.uniform_(face.emotion_faces)
    prior.features.fit(0.3 * torch.randn(200, 55, 3))
    return {
        "disentangler": speech,
        "prior": prior,
        "denoiser": denoiser,
        "stress": StressListener(StressConfig()),
        "face": face,
    }


def untrained_holistic() -> dict[str, torch.nn.Module]:
    """ProbTalk's networks."""
    torch.manual_seed(0)
    pqvae, refiner = PQVAE(TEACHING_PQVAE), Refiner(TEACHING_REFINER)
    pqvae.features.fit(0.3 * torch.randn(200, 55, 3), torch.rand(200, 100))
    for parameter in pqvae.decoder.parameters():
        torch.nn.init.normal_(parameter, std=0.1)
    refiner.features.load_state_dict(pqvae.features.state_dict())
    return {"pqvae": pqvae, "predictor": Predictor(TEACHING_PREDICTOR), "refiner": refiner}


def sentence(seconds: float, rate: int = 16000) -> np.ndarray:
    """Four syllables a second of a buzzing voice."""
    time = np.arange(round(seconds * rate)) / rate
    voice = sum(np.sin(2 * np.pi * 120 * k * time) / k for k in range(1, 20))
    return (0.1 * voice * np.sin(2 * np.pi * 2 * time) ** 2).astype(np.float32)


@pytest.fixture(scope="session")
def data(tmp_path_factory):
    """What `data_samples` is to a reader."""
    folder = tmp_path_factory.mktemp("data")
    save_mannequin(capsule_body(), folder / "mannequin.safetensors")
    for system, networks in (("amuse", untrained()), ("probtalk", untrained_holistic())):
        for name, model in networks.items():
            path = folder / "checkpoints" / f"{system}-{name}.safetensors"
            save_checkpoint(path, model, model.config)
    return folder


@pytest.fixture(autouse=True)
def here(tmp_path, data, monkeypatch):
    """Every test works in an empty folder of its own."""
    monkeypatch.setenv("S2G_DATA", str(data))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def record(here):
    """Write a sentence as a sound file."""

    def write(name="speech.wav", seconds=1.0, rate=16000, *, channels=1, subtype=None, gain=1.0):
        samples = np.repeat(gain * sentence(seconds, rate)[:, None], channels, axis=1)
        soundfile.write(here / name, samples, rate, subtype)
        return name

    return write


@pytest.fixture
def swap(here):
    """Run `swap` into the folder `out`, and read what it delivers."""

    def run(*arguments, out="out"):
        assert main(["swap", *arguments, "--out", out]) == 0
        motion = dict(np.load(here / out / "motion.npz"))
        return motion, json.loads((here / out / "report.json").read_text("utf-8"))

    return run
