"""Spectral pictures of speech: the log-mel filterbank AMUSE looks at, MFCC, chroma, tempogram.

Paper:    AM B.2, B.5 (filterbank), AM C.3 (MFCC), MDD B.5 (MFCC, chroma, tempogram)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import warnings
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Float32

from s2glib.audio.io import check_signal

LOWEST = 20.0  # Hz, where the first mel filter begins
PREEMPHASIS = 0.97
FLOOR = np.finfo(np.float32).eps  # smallest power whose logarithm is taken: silence is -15.94
WINDOW = 2048  # samples; librosa's default, which all three papers keep
BLOCK = 1024  # frames of a filterbank that are computed together: 10 s


def filterbank(
    samples: Float[np.ndarray, " n"],
    sample_rate: int = 16000,
    n_mels: int = 128,
    frames: int | None = 1024,
) -> Float32[np.ndarray, "frames mels"]:
    """Kaldi's log-mel filterbank, as the Audio Spectrogram Transformer reads it.

    Windows of 25 ms every 10 ms, none reaching beyond the signal, so that 10 s at 16 kHz give
    998 frames. An offset of the waveform plays no part: every window loses its mean. Beside the
    result a constant 20 MB are held, however long the speech.

    Args:
        samples: mono, in [-1, 1].
        sample_rate: samples per second.
        n_mels: number of mel filters between 20 Hz and half the sample rate.
        frames: how many frames to return, padded with zeros or cut; None returns what there is.

    Returns:
        The natural logarithm of the power in each filter, not standardised.

    Raises:
        ValueError: if the signal is not finite or shorter than one window.
    """
    length, hop = sample_rate * 25 // 1000, sample_rate * 10 // 1000
    check_signal(samples, sample_rate, shortest=length)
    windows = np.lib.stride_tricks.sliding_window_view(samples, length)[::hop][:frames]
    bank = np.zeros((len(windows) if frames is None else frames, n_mels), np.float32)
    for start in range(0, len(windows), BLOCK):
        block = windows[start : start + BLOCK]
        power = _power_spectrum(block.astype(np.float64))  # (t, n_fft / 2 + 1)
        mel = power @ mel_filters(power.shape[-1], sample_rate, n_mels)  # (t, n_mels)
        np.log(np.maximum(mel, FLOOR), out=bank[start : start + len(block)])
    return bank


def _power_spectrum(windows: Float[np.ndarray, "t length"]) -> Float32[np.ndarray, "t bins"]:
    length = windows.shape[-1]
    windows -= windows.mean(axis=-1, keepdims=True)
    windows[:, 1:] -= PREEMPHASIS * windows[:, :-1]  # the right side is evaluated first
    windows[:, 0] *= 1 - PREEMPHASIS
    windows *= np.hanning(length)
    spectrum = np.fft.rfft(windows, n=1 << (length - 1).bit_length())  # next power of two
    return (spectrum.real**2 + spectrum.imag**2).astype(np.float32)


@lru_cache
def mel_filters(
    bins: int, sample_rate: int = 16000, n_mels: int = 128
) -> Float32[np.ndarray, "bins mels"]:
    """Triangles of equal width on the mel scale, each rising to 1 at its centre.

    Args:
        bins: length of the power spectrum, from 0 Hz to half the sample rate.
        sample_rate: samples per second.
        n_mels: number of triangles.
    """
    nyquist = sample_rate / 2
    mel = _hertz_to_mel(np.linspace(0, nyquist, bins))[:, None]
    edges = np.linspace(_hertz_to_mel(LOWEST), _hertz_to_mel(nyquist), n_mels + 2)
    left, centre, right = edges[:-2], edges[1:-1], edges[2:]
    rising, falling = (mel - left) / (centre - left), (right - mel) / (right - centre)
    filters = np.minimum(rising, falling).clip(min=0).astype(np.float32)
    filters.setflags(write=False)  # the cache hands the same array to everybody
    return filters


def _hertz_to_mel(hertz):
    return 1127 * np.log1p(hertz / 700)


def standardize(
    filterbank: Float[np.ndarray, "*b frames mels"], mean: float, std: float
) -> Float[np.ndarray, "*b frames mels"]:
    """Centre a filterbank and give it a standard deviation of one half, as AST does."""
    return (filterbank - mean) / (2 * std)


def mfcc(
    samples: Float[np.ndarray, " n"],
    sample_rate: int,
    *,
    coefficients: int = 13,
    n_mels: int = 128,
    hop_length: int = 128,
) -> Float[np.ndarray, "frames coefficients"]:
    """Mel-frequency cepstrum on HTK's mel scale, frame i centred on sample i * hop_length.

    The defaults are those of AMUSE without its speech model  [AM C.3; sizes: authors' code].
    ProbTalk's alternative is 64 coefficients of 256 mels, hop 535 at 16 kHz  [authors' code].
    """
    import librosa

    check_signal(samples, sample_rate, shortest=WINDOW)
    cepstrum = librosa.feature.mfcc(
        y=samples,
        sr=sample_rate,
        n_mfcc=coefficients,
        n_mels=n_mels,
        hop_length=hop_length,
        htk=True,
    )
    return cepstrum.T


def chroma(
    samples: Float[np.ndarray, " n"], sample_rate: int, *, hop_length: int = 512
) -> Float[np.ndarray, "frames 12"]:
    """Constant-Q chromagram: the strength of the twelve pitch classes C, C#, ... B  [MDD B.5]."""
    import librosa

    return _pitch_classes(librosa.feature.chroma_cqt, samples, sample_rate, hop_length)


def chroma_cens(
    samples: Float[np.ndarray, " n"], sample_rate: int, *, hop_length: int = 512
) -> Float[np.ndarray, "frames 12"]:
    """The same chromagram, quantised and smoothed over 41 frames  [MDD, authors' code]."""
    import librosa

    return _pitch_classes(librosa.feature.chroma_cens, samples, sample_rate, hop_length)


def _pitch_classes(method, samples, sample_rate, hop_length):
    check_signal(samples, sample_rate, shortest=WINDOW)
    if sample_rate < 9000:  # B7 is 3951 Hz, and its band is wider than a semitone
        raise ValueError(f"seven octaves need a rate of 9000 Hz or more, got {sample_rate}")
    with warnings.catch_warnings():  # low notes in a short clip, silence: both count as 0
        warnings.filterwarnings("ignore", "n_fft=|Trying to estimate tuning", UserWarning)
        return method(y=samples, sr=sample_rate, hop_length=hop_length).T


def tempogram(
    samples: Float[np.ndarray, " n"], sample_rate: int, *, hop_length: int = 512, lags: int = 384
) -> Float[np.ndarray, "frames lags"]:
    """How strongly the onsets around each frame repeat at each lag, in frames  [MDD B.5]."""
    import librosa

    check_signal(samples, sample_rate, shortest=WINDOW)
    return librosa.feature.tempogram(
        y=samples, sr=sample_rate, hop_length=hop_length, win_length=lags
    ).T
