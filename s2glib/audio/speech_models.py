"""Adapters for WavLM and wav2vec2: a folder the reader has, in; features per motion frame, out.

Paper:    PT A.2 (wav2vec2), MDD B.5 (WavLM)
Notebook: notebooks/11_losses_and_guidance.ipynb
"""

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Float32

from s2glib.audio.io import check_signal, resample

if TYPE_CHECKING:
    from torch import nn

RATE = 16000  # Hz, what both models were trained on
RECEPTIVE_FIELD = 400  # samples behind one feature; the next one is 320 samples later
KINDS = ("wav2vec2", "wavlm")


def load_speech_model(folder: str | os.PathLike) -> "nn.Module":
    """Load wav2vec2 or WavLM from a local folder in Hugging Face's layout; nothing is fetched.

    Args:
        folder: holds `config.json` and the weights, e.g. a copy of `wav2vec2-base-960h` for
            ProbTalk or of `wavlm-large` for MDD. A recogniser's output head is left out.

    Returns:
        The encoder, in evaluation mode and float32.

    Raises:
        ImportError: if transformers is not installed.
        ValueError: if the folder holds no such model.
    """
    try:
        from safetensors import SafetensorError
        from transformers import AutoModel
    except ImportError as error:
        raise ImportError(
            "speech models need transformers; install it with: pip install -e '.[pretrained]'"
        ) from error
    _check_kind(Path(folder))
    try:
        model, report = AutoModel.from_pretrained(
            Path(folder), local_files_only=True, dtype="float32", output_loading_info=True
        )
    except (OSError, RuntimeError, SafetensorError) as error:
        raise ValueError(f"the weights in {folder} cannot be read; copy it again") from error
    if missing := set(report["missing_keys"]) - {"masked_spec_embed"}:  # for training only
        raise ValueError(f"{folder} lacks weights such as {min(missing)}; copy it again")
    return model.eval()


def _check_kind(folder: Path) -> None:
    try:
        kind = json.loads((folder / "config.json").read_text())["model_type"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ValueError(
            f"{folder} holds no readable config.json; give a folder in Hugging Face's layout"
        ) from error
    if kind not in KINDS:
        raise ValueError(f"expected a model of type {' or '.join(KINDS)} in {folder}, got {kind}")


def wav2vec2_features(
    model: "nn.Module", samples: Float[np.ndarray, " n"], sample_rate: int = RATE, fps: int = 30
) -> Float32[np.ndarray, "frames dim"]:
    """Last hidden layer, resized linearly to the motion frames  [PT A.2; rate: authors' code].

    Args:
        model: from `load_speech_model`; the paper's has dim = 768.
        samples: mono, in [-1, 1].
        sample_rate: samples per second.
        fps: motion frames per second.

    Returns:
        Features of shape (floor(duration * fps), dim).

    Raises:
        ValueError: if the signal is not finite or shorter than 25 ms.
    """
    hidden = _last_layer(model, samples, sample_rate, epsilon=1e-7)
    return _resize(hidden, len(samples) * fps // sample_rate)


def wavlm_features(
    model: "nn.Module", samples: Float[np.ndarray, " n"], sample_rate: int = RATE, fps: int = 25
) -> Float32[np.ndarray, "frames dim"]:
    """Last layer with its final frame doubled, resized to the motion frames  [MDD B.5].

    A window of 3.2 s gives 159 frames, with the double 160, and 80 motion frames  [authors' code].

    Args:
        model: from `load_speech_model`; the paper's has dim = 1024.
        samples: mono, in [-1, 1].
        sample_rate: samples per second.
        fps: motion frames per second.

    Returns:
        Features of shape (floor(duration * fps), dim).

    Raises:
        ValueError: if the signal is not finite or shorter than 25 ms.
    """
    hidden = _last_layer(model, samples, sample_rate, epsilon=1e-5)
    return _resize(np.pad(hidden, ((0, 1), (0, 0)), "edge"), len(samples) * fps // sample_rate)


def _last_layer(model, samples, sample_rate, epsilon):
    """Standardise the waveform (epsilon as in training) and run the model over all of it."""
    import torch

    sound = resample(samples, sample_rate, RATE)
    check_signal(sound, RATE, shortest=RECEPTIVE_FIELD)
    sound = (sound - sound.mean()) / np.sqrt(sound.var() + epsilon)
    batch = torch.as_tensor(sound[None], dtype=torch.float32, device=model.device)
    with torch.inference_mode():
        return model(batch).last_hidden_state[0].cpu().numpy()


def _resize(
    features: Float32[np.ndarray, "t dim"], frames: int
) -> Float32[np.ndarray, "frames dim"]:
    """Interpolate linearly; first and last rows stay in place (corners aligned)."""
    position = np.linspace(0, len(features) - 1, frames)
    before = np.floor(position).astype(int)
    after = np.ceil(position).astype(int)
    share = (position - before).astype(np.float32)[:, None]
    return features[before] * (1 - share) + features[after] * share
