"""Small networks with every part of the large ones."""

from dataclasses import replace

import jaxtyping
import pytest
import torch

from s2glib.papers.amuse import (
    TEACHING_DENOISER,
    TEACHING_EXTRACTOR,
    TEACHING_PRIOR,
    TEACHING_SPEECH,
    LatentDenoiser,
    MotionPrior,
    SpeechCondition,
    SpeechDisentangler,
    SpeechLatents,
)

SPEECH = replace(
    TEACHING_SPEECH,
    styles=5,
    content_dim=64,
    emotion_dim=6,
    style_dim=7,
    width=16,
    layers=1,
    heads=2,
    decoder_width=16,
    content_tokens=8,
)
PRIOR = replace(TEACHING_PRIOR, frames=40, tokens=5, token_dim=6, width=16)
DENOISER = replace(
    TEACHING_DENOISER,
    tokens=5,
    token_dim=6,
    content_dim=64,
    emotion_dim=6,
    style_dim=7,
    frames_per_token=10,
    width=16,
    layers=3,
    heads=2,
    hidden=32,
)


@pytest.fixture(autouse=True)
def seed():
    """Fresh networks draw their weights from torch's global generator."""
    torch.manual_seed(0)


@pytest.fixture
def without_type_hook():
    """What a reader meets: no shape checks at run time, only our own refusals."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.fixture
def generator():
    return torch.Generator().manual_seed(0)


@pytest.fixture
def speech_config():
    return SPEECH


@pytest.fixture
def prior_config():
    return PRIOR


@pytest.fixture
def denoiser_config():
    return DENOISER


@pytest.fixture
def extractor_config():
    return replace(TEACHING_EXTRACTOR, frames=40, width=16, layers=1, hidden=32)


@pytest.fixture
def awake():
    """Give every weight a value, also those that start at zero."""

    def wake(model):
        for parameter in model.parameters():
            torch.nn.init.normal_(parameter, std=0.2)
        return model.eval()

    return wake


@pytest.fixture
def speech(awake):
    return awake(SpeechDisentangler(SPEECH))


@pytest.fixture
def prior(awake):
    return awake(MotionPrior(PRIOR))


@pytest.fixture
def denoiser(awake):
    return awake(LatentDenoiser(DENOISER))


@pytest.fixture
def condition():
    """What speech asks of three windows."""
    latents = SpeechLatents(torch.randn(3, 64), torch.randn(3, 6), torch.randn(3, 7))
    return SpeechCondition(latents, torch.randn(3, 40, 11), torch.zeros(3, 3, dtype=torch.bool))
