"""Rhythm of speech: onset strength, and the times of onsets and beats in seconds.

Paper:    AM E, MDD H (audio beats of beat alignment); MDD B.5 (onset strength and beat)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np
from jaxtyping import Float

from s2glib.audio.io import check_signal, resample
from s2glib.audio.spectral import WINDOW

# librosa lets a frame fire if none in the 30 ms before was stronger, and then rests for 30 ms.
# It counts both in whole frames of 512 samples. At 22.05 kHz that is one frame; at 16 kHz it is
# none, and neighbouring frames fire for one and the same onset.
RATE = 22050
HOP = 512
FRAME_RATE = RATE / HOP  # 43.07 Hz


def onset_strength(samples: Float[np.ndarray, " n"], sample_rate: int) -> Float[np.ndarray, " t"]:
    """How much energy enters the mel spectrum, at `FRAME_RATE` whatever the sample rate.

    Raises:
        ValueError: if the signal is not finite or shorter than 2048 samples at 22.05 kHz.
    """
    import librosa

    return librosa.onset.onset_strength(y=_at_rate(samples, sample_rate), sr=RATE, hop_length=HOP)


def onset_times(samples: Float[np.ndarray, " n"], sample_rate: int) -> Float[np.ndarray, " onsets"]:
    """Seconds at which something starts, where `onset_strength` rises high; none in silence.

    Raises:
        ValueError: if the signal is not finite or shorter than 2048 samples at 22.05 kHz.
    """
    import librosa

    strength = onset_strength(samples, sample_rate)
    frames = librosa.onset.onset_detect(onset_envelope=strength, sr=RATE, hop_length=HOP)
    return frames / FRAME_RATE


def beat_times(samples: Float[np.ndarray, " n"], sample_rate: int) -> Float[np.ndarray, " beats"]:
    """Seconds of a steady pulse fitted to `onset_strength`; none in silence.

    Raises:
        ValueError: if the signal is not finite or shorter than 2048 samples at 22.05 kHz.
    """
    import librosa

    strength = onset_strength(samples, sample_rate)
    _, frames = librosa.beat.beat_track(onset_envelope=strength, sr=RATE, hop_length=HOP)
    return frames / FRAME_RATE


def _at_rate(samples, sample_rate):
    sound = resample(samples, sample_rate, RATE)
    check_signal(sound, RATE, shortest=WINDOW)
    return sound
