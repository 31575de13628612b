"""AMUSE's sizes: what the paper prints, and the small model that trains on a laptop.

Every number says where it comes from: a section, the authors' code, or ours.

Paper:    AM B.2-B.5, C.1, D
Notebook: notebooks/09_disentanglement.ipynb
"""

from dataclasses import dataclass, replace
from typing import Literal


@dataclass(frozen=True)
class SpeechConfig:
    """The speech disentangler: one filterbank in, three latents, one filterbank out."""

    n_mels: int = 128  # [AM B.5]
    frames: int = 1024  # [AM B.5]
    pool: int = 1  # 10 ms frames averaged into one; authors' code has no pooling
    mean: float = -9.173025  # of log-mels; authors' code
    std: float = 5.062332  # authors' code
    emotions: int = 8  # n_e  [AM B.4]
    styles: int = 30  # n_s, training subjects  [AM B.4]
    content_dim: int = 256  # [AM B.5]
    emotion_dim: int = 256  # [AM B.5]
    style_dim: int = 256  # [AM B.5]
    backbone: Literal["patches", "temporal"] = "patches"  # DeiT [AM B.2]; "temporal" is ours
    width: int = 768  # [AM B.2]
    layers: int = 12  # DeiT-B  [AM B.2]
    heads: int = 12  # DeiT-B  [AM B.2]
    decoder_width: int = 512  # authors' code
    content_tokens: int = 1  # time steps of the content latent; more than one is ours
    dropout: float = 0.1  # authors' code

    @property
    def window(self) -> dict[str, int]:
        """What `speech_window` is to cut."""
        return {"n_mels": self.n_mels, "frames": self.frames, "pool": self.pool}


@dataclass(frozen=True)
class PriorConfig:
    """The motion prior: a clip of gestures to a few latent tokens and back."""

    frames: int = 300  # 10 s at 30 fps; authors' code
    features: int = 333  # 55 joints x 6D + translation; authors' code. 90 is ours
    tokens: int = 1  # [AM C.1]
    token_dim: int = 128  # authors' code
    backbone: Literal["transformer", "temporal"] = "transformer"  # [AM C.1]; "temporal" is ours
    width: int = 128  # authors' code
    layers: int = 9  # authors' code
    heads: int = 4  # authors' code
    hidden: int = 512  # authors' code
    kl_weight: float = 1e-4  # authors' code


@dataclass(frozen=True)
class DenoiserConfig:
    """The latent denoiser: noisy motion latents and (c, e, s) in, clean latents out."""

    tokens: int = 1  # [AM C.1]
    token_dim: int = 128  # authors' code
    content_dim: int = 256  # [AM B.5]
    emotion_dim: int = 256  # [AM B.5]
    style_dim: int = 256  # [AM B.5]
    track_features: int = 0  # per frame; time tracks beside (c, e, s) are ours
    frames_per_token: int = 0  # frames of a track that belong to one latent token; ours
    global_tokens: int = 0  # leading tokens without a place in time; ours
    backbone: Literal["tokens", "adaptive"] = "tokens"  # conditions as tokens [AM C.1]
    width: int = 128  # authors' code
    layers: int = 9  # authors' code
    heads: int = 4  # authors' code
    hidden: int = 512  # authors' code
    levels: int = 1000  # authors' code
    prediction: Literal["noise", "x0"] = "noise"  # authors' code; "x0" is ours


@dataclass(frozen=True)
class ExtractorConfig:
    """The motion extractor M that the metrics look through."""

    frames: int = 300  # 10 s at 30 fps; authors' code
    features: int = 333  # authors' code; 90 is ours
    patch: int = 1  # frames per token; more than one is ours
    width: int = 256  # authors' code
    layers: int = 8  # authors' code
    heads: int = 4  # authors' code
    hidden: int = 1024  # authors' code
    emotions: int = 8  # n_e  [AM D]
    dropout: float = 0.1  # authors' code


PAPER_SPEECH = SpeechConfig()
PAPER_PRIOR = PriorConfig()
PAPER_DENOISER = DenoiserConfig()
PAPER_EXTRACTOR = ExtractorConfig()

TEACHING_SPEECH = replace(
    PAPER_SPEECH,
    n_mels=64,
    frames=352,
    pool=2,
    mean=-6.3,
    std=3.4,
    styles=24,
    emotion_dim=32,
    style_dim=32,
    backbone="temporal",
    width=96,
    layers=2,
    heads=4,
    decoder_width=128,
    content_tokens=32,
)
TEACHING_PRIOR = replace(
    PAPER_PRIOR,
    frames=120,
    features=90,
    tokens=9,
    token_dim=48,
    backbone="temporal",
    width=96,
)
TEACHING_DENOISER = replace(
    PAPER_DENOISER,
    tokens=9,
    token_dim=48,
    emotion_dim=32,
    style_dim=32,
    track_features=11,
    frames_per_token=15,
    global_tokens=1,
    backbone="adaptive",
    layers=5,
    hidden=384,
    prediction="x0",
)
TEACHING_EXTRACTOR = replace(
    PAPER_EXTRACTOR, frames=120, features=90, patch=4, width=64, layers=2, hidden=128
)

SPEECH_PRESETS = {"paper": PAPER_SPEECH, "teaching": TEACHING_SPEECH}
PRIOR_PRESETS = {"paper": PAPER_PRIOR, "teaching": TEACHING_PRIOR}
DENOISER_PRESETS = {"paper": PAPER_DENOISER, "teaching": TEACHING_DENOISER}
EXTRACTOR_PRESETS = {"paper": PAPER_EXTRACTOR, "teaching": TEACHING_EXTRACTOR}
