"""Opening the trained networks: all there, all whole, and made for each other.

Paper:    AM Fig. A.4
Notebook: -
"""

from pathlib import Path

from s2glib.corpus.script import EMOTIONS
from s2glib.papers.amuse.pipeline import Amuse


def open_amuse(folder: Path) -> Amuse:
    """Load AMUSE's networks from a folder.

    Raises:
        ValueError: if there is no such folder, or a network is damaged or does not fit the others.
        FileNotFoundError: if one is missing.
    """
    if not folder.is_dir():
        raise ValueError(f"there is no folder {folder} with trained networks; give --checkpoints")
    amuse = Amuse.load(folder)
    for what, sizes in shared_sizes(amuse).items():
        if len(set(sizes)) > 1:
            raise ValueError(
                f"the networks in {folder} were not made for each other: {what} differ "
                f"({' and '.join(map(str, sizes))}); take all of them from one training"
            )
    return amuse


def shared_sizes(amuse: Amuse) -> dict[str, tuple]:
    """What several networks must agree on, and what each of them has."""
    speech, prior = amuse.speech.config, amuse.prior.config
    denoiser, face = amuse.denoiser.config, amuse.face.config
    return {
        "emotions": (len(EMOTIONS), speech.emotions, face.emotions),
        "mel bands": (speech.n_mels, face.n_mels),
        "content, emotion and style latents": (_latents(speech), _latents(denoiser)),
        "tracks": (3 + speech.content_dim // speech.content_tokens, denoiser.track_features),
        "motion tokens": (
            (prior.tokens, prior.token_dim),
            (denoiser.tokens, denoiser.token_dim),
        ),
        "frames": (
            prior.frames,
            denoiser.frames_per_token * (denoiser.tokens - denoiser.global_tokens),
        ),
    }


def _latents(config) -> tuple[int, int, int]:
    return config.content_dim, config.emotion_dim, config.style_dim
