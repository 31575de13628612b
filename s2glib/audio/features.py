"""The 35 hand-crafted features that MDD feeds to its denoiser beside WavLM.

Paper:    MDD B.5
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np
from jaxtyping import Float, Float32

from s2glib.audio.io import check_signal, resample
from s2glib.audio.rhythm import HOP, RATE, onset_strength
from s2glib.audio.spectral import WINDOW, chroma_cens

PITCH_CLASSES = ("C", "C#", "D", "D#", "E", "F", "F#", "G", "G#", "A", "A#", "B")
HANDCRAFTED_NAMES = (
    "onset strength",
    *(f"mfcc {i}" for i in range(20)),
    *(f"chroma {name}" for name in PITCH_CLASSES),
    "onset",
    "beat",
)


def handcrafted_features(
    samples: Float[np.ndarray, " n"], sample_rate: int, fps: int = 25
) -> Float32[np.ndarray, "frames 35"]:
    """Describe each motion frame by 35 numbers, named in `HANDCRAFTED_NAMES`.

    The sound is resampled to fps * 512 Hz, so that a hop of 512 samples is one motion frame.
    Everything below that the text leaves open is the authors' code.

    | column | content | source |
    |---|---|---|
    | 0 | onset strength | [MDD B.5] |
    | 1-20 | 20 MFCC of 128 mels (Slaney's scale) | [MDD B.5] |
    | 21-32 | 12 pitch classes | [MDD B.5] constant-Q; code: its smoothed form, CENS |
    | 33 | 1 at peaks of column 0 | [MDD B.5] "on-set beat"; neighbours may both fire |
    | 34 | 1 at beats, tempo prior from the sound at 22.05 kHz | authors' code, not in the text |

    The text also lists a tempogram; the code has none, and 35 leaves no room for one.

    Args:
        samples: mono, in [-1, 1].
        sample_rate: samples per second.
        fps: motion frames per second, at least 18: constant-Q bands reach beyond 4 kHz.

    Returns:
        Features of shape (floor(duration * fps), 35).

    Raises:
        ValueError: if the signal is not finite or shorter than 4 motion frames, or fps is below 18.
    """
    import librosa

    rate = fps * HOP
    frames = len(samples) * fps // sample_rate
    sound = resample(samples, sample_rate, rate)
    check_signal(sound, rate, shortest=WINDOW)
    strength = librosa.onset.onset_strength(y=sound, sr=rate, hop_length=HOP)
    columns = [
        strength,
        librosa.feature.mfcc(y=sound, sr=rate, n_mfcc=20, hop_length=HOP).T,
        chroma_cens(sound, rate, hop_length=HOP),
        _one_hot(librosa.onset.onset_detect(onset_envelope=strength, sr=rate), strength),
        _one_hot(_beats(strength, rate, _tempo(samples, sample_rate)), strength),
    ]
    return np.column_stack(columns)[:frames].astype(np.float32)


def _tempo(samples, sample_rate):
    """Beats per minute, estimated where librosa's defaults were tuned."""
    import librosa

    envelope = onset_strength(samples, sample_rate)
    return librosa.feature.tempo(onset_envelope=envelope, sr=RATE, hop_length=HOP).item()


def _beats(strength, rate, tempo):
    import librosa

    return librosa.beat.beat_track(
        onset_envelope=strength, sr=rate, hop_length=HOP, start_bpm=tempo, tightness=100
    )[1]


def _one_hot(peaks, strength):
    marks = np.zeros_like(strength)
    marks[peaks] = 1
    return marks
