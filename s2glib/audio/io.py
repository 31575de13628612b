"""Sound files: read any speech recording as one clean mono waveform, and write one safely.

Paper:    AM B.5, PT A.2, MDD B.5 (speech as the three systems receive it)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import os
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Float32

SHORTEST = 0.5  # seconds
LONGEST = 30 * 60  # seconds before a warning
QUIETEST = 10 ** (-60 / 20)  # peak, -60 dB below full scale
FULL_SCALE = 1 - 2**-15  # the largest 16-bit sample
BLOCK = 10  # seconds that are held in memory at the file's own rate
SUFFIXES = {".wav": "WAV", ".flac": "FLAC"}


@dataclass(frozen=True, eq=False)
class Waveform:
    """Mono sound: finite float32 samples, nominally in [-1, 1].

    Attributes:
        samples: the signal.
        sample_rate: samples per second.

    Raises:
        TypeError: if the samples are not a float32 array.
        ValueError: if they are empty, not one-dimensional or not finite, or the rate is below 1.
    """

    samples: Float32[np.ndarray, " n"]
    sample_rate: int

    def __post_init__(self):
        check_signal(self.samples, self.sample_rate)
        if self.samples.dtype != np.float32:
            raise TypeError(f"expected float32 samples, got {self.samples.dtype}; use astype")

    @property
    def duration(self) -> float:
        """Length in seconds."""
        return len(self.samples) / self.sample_rate


def check_signal(samples: Float[np.ndarray, " n"], sample_rate: int, shortest: int = 1) -> None:
    """Refuse what no later step can hear: the wrong type or shape, too little, not a number.

    Raises:
        TypeError: if the samples are not an array of floats.
        ValueError: if they are fewer than `shortest`, not one-dimensional or not finite, or the
            rate is below 1.
    """
    if not isinstance(samples, np.ndarray) or samples.dtype.kind != "f":
        kind = getattr(samples, "dtype", type(samples).__name__)
        raise TypeError(
            f"expected a numpy array of floats in [-1, 1], got {kind}; convert it first"
        )
    if samples.ndim != 1:
        raise ValueError(f"expected mono samples (n,), got shape {samples.shape}; average channels")
    if sample_rate < 1:
        raise ValueError(f"expected a sample rate of at least 1 Hz, got {sample_rate}")
    if len(samples) < shortest:
        raise ValueError(
            f"expected at least {shortest} samples at {sample_rate} Hz, got {len(samples)}; "
            "give a longer piece of sound"
        )
    if not np.isfinite(samples).all():
        raise ValueError("the samples hold NaN or Inf; repair the recording first")


def load(path: str | os.PathLike, sample_rate: int = 16000) -> Waveform:
    """Read a sound file as mono at the rate wanted.

    Args:
        path: wav, flac, ogg or mp3, of any rate, channel count and sample type.
        sample_rate: samples per second of the result.

    Returns:
        The mean of the channels, resampled. Clipped sound and more than 30 minutes give a warning.
        At 16 kHz a minute takes 4 MB, and as much again while it is read.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it cannot be decoded, is empty, shorter than 0.5 s, holds NaN or Inf, or its
            peak is below -60 dBFS.
    """
    samples = np.concatenate(list(stream(path, sample_rate)))
    if not len(samples):
        raise ValueError(f"{path} is empty: it holds no samples; record at least {SHORTEST} s")
    if len(samples) < SHORTEST * sample_rate:
        raise ValueError(f"{path} is shorter than {SHORTEST} s; give a longer piece of speech")
    if max(samples.max(), -samples.min()) < QUIETEST:
        raise ValueError(f"{path} is silent: its peak is below -60 dBFS; record it louder")
    return Waveform(samples, sample_rate)


def stream(
    path: str | os.PathLike, sample_rate: int = 16000
) -> Iterator[Float32[np.ndarray, " n"]]:
    """Yield a sound file block by block, mono and resampled; the blocks joined are its `load`.

    Only the refusals that a single block can show are made here: unreadable, NaN or Inf.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it cannot be decoded or holds NaN or Inf.
    """
    import soundfile

    if sample_rate < 1:
        raise ValueError(f"expected a sample rate of at least 1 Hz, got {sample_rate}")
    if not Path(path).exists():
        raise FileNotFoundError(f"there is no sound file at {path}; check the path")
    try:
        with soundfile.SoundFile(path) as file:
            yield from _resampled_blocks(file, sample_rate, path)
    except (soundfile.LibsndfileError, TypeError) as error:  # TypeError: headerless .raw
        raise ValueError(
            f"{path} cannot be read as sound; give a wav, flac, ogg or mp3 file"
        ) from error


def _resampled_blocks(file, sample_rate, path):
    import soxr

    if file.frames > LONGEST * file.samplerate:
        warnings.warn(f"{path} is longer than 30 minutes; this takes a while", stacklevel=4)
    clipped = False
    resampler = soxr.ResampleStream(file.samplerate, sample_rate, num_channels=1)
    for block in file.blocks(BLOCK * file.samplerate, dtype="float32", always_2d=True):
        if not np.isfinite(block).all():
            raise ValueError(f"{path} holds NaN or Inf samples; export the recording again")
        clipped = clipped or _is_clipped(block)
        yield resampler.resample_chunk(block.mean(axis=1))
    yield resampler.resample_chunk(np.zeros(0, np.float32), last=True)
    if clipped:
        warnings.warn(f"{path} is clipped: record it more quietly if you can", stacklevel=4)


def _is_clipped(block: Float32[np.ndarray, "n channels"]) -> bool:
    """Whether three samples in a row of one channel sit at full scale: a plateau, not a peak."""
    full = np.abs(block) >= FULL_SCALE
    return bool((full[:-2] & full[1:-1] & full[2:]).any())


def resample(
    samples: Float[np.ndarray, " n"], from_rate: int, to_rate: int
) -> Float[np.ndarray, " m"]:
    """Change the sample rate with soxr's high-quality band-limited filter; the dtype is kept."""
    import soxr

    check_signal(samples, from_rate)
    return samples if from_rate == to_rate else soxr.resample(samples, from_rate, to_rate)


def save(path: str | os.PathLike, waveform: Waveform) -> None:
    """Write 16-bit wav or flac; the file appears only when it is complete.

    Samples beyond [-1, 1] are clipped.

    Raises:
        FileNotFoundError: if the folder does not exist.
        ValueError: if the suffix is neither .wav nor .flac.
    """
    import soundfile

    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise ValueError(f"expected a path ending in .wav or .flac, got {path}")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"there is no folder {path.parent}; create it first")
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        kind = SUFFIXES[path.suffix.lower()]
        soundfile.write(unfinished, waveform.samples, waveform.sample_rate, "PCM_16", format=kind)
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)
