"""Speech with known factors: espeak-ng voices, taken apart and put together again by WORLD.

Every voice reads a sentence once, neutrally. WORLD splits that reading into F0, spectral
envelope and aperiodicity; we move them onto the shared phoneme clock, bend them as the emotion
asks, and synthesise.

Paper:    AM F (parallel speech of every subject in every emotion)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from s2glib.corpus.clock import LEAD_IN, SEED, Reading, Timing, word_places
from s2glib.corpus.espeak import NATIVE_RATE, Utterance, synthesize
from s2glib.corpus.script import PROSODY, SENTENCES, VOICES, Cell, Prosody
from s2glib.data.windows import NOISE_FLOOR_DB

SAMPLE_RATE = 16000
FRAME_MS = 5.0
_LEVEL_DB = -28.0  # loudness of a neutral reading
_CONTOUR_SPREAD = 2.2  # semitones: spread of F0 in a neutral reading of any voice
_SPEECH_STREAM = 1


class Analysis(NamedTuple):
    """A neutral reading in WORLD's terms, 5 ms frames, with its phoneme boundaries."""

    semitones: Float[np.ndarray, " t"]  # F0 against the voice's median; nan where unvoiced
    envelope: Float[np.ndarray, "t bins"]  # power
    aperiodicity: Float[np.ndarray, "t bins"]
    boundaries: Float[np.ndarray, " bounds"]  # seconds


def _utterance(sentence: int, speaker: str) -> Utterance:
    return synthesize(SENTENCES[sentence].text, VOICES[speaker].variant)


def _boundaries(utterance: Utterance) -> Float[np.ndarray, " bounds"]:
    starts = np.array([start for _, start in utterance.phonemes])
    return np.concatenate([[0.0], starts[1:], [utterance.duration]])


def canonical_reading(sentence: int, speakers: tuple[str, ...]) -> Reading:
    """The mean reading of a sentence over speakers.

    Raises:
        ValueError: if two voices do not speak the same phonemes.
    """
    utterances = [_utterance(sentence, speaker) for speaker in speakers]
    phonemes = {tuple(name for name, _ in utterance.phonemes) for utterance in utterances}
    if len(phonemes) > 1:
        raise ValueError(
            f"the voices {', '.join(speakers)} do not share one phoneme sequence in sentence "
            f"{sentence}; choose variants of one language"
        )
    bounds = np.mean([_boundaries(utterance) for utterance in utterances], axis=0)
    first = utterances[0]
    starts = _boundaries(first)[:-1]
    places = word_places(SENTENCES[sentence].words, first.words, starts)
    return Reading(phonemes.pop(), np.diff(bounds), places)


@lru_cache(maxsize=4)
def analyse(sentence: int, speaker: str) -> Analysis:
    """Read a sentence neutrally and take it apart.

    Raises:
        ImportError: without the extra `corpus`.
    """
    import pyworld
    from scipy.signal import resample_poly

    utterance = _utterance(sentence, speaker)
    samples = resample_poly(utterance.samples.astype(np.float64), 320, 441)
    assert NATIVE_RATE * 320 == SAMPLE_RATE * 441
    f0, times = pyworld.dio(samples, SAMPLE_RATE, f0_floor=55, f0_ceil=480, frame_period=FRAME_MS)
    f0 = pyworld.stonemask(samples, f0, times, SAMPLE_RATE)
    envelope = pyworld.cheaptrick(samples, f0, times, SAMPLE_RATE)
    aperiodicity = pyworld.d4c(samples, f0, times, SAMPLE_RATE)
    loudness = np.sqrt(np.mean(samples**2))
    envelope *= (10 ** (_LEVEL_DB / 20) / loudness) ** 2
    with np.errstate(divide="ignore"):
        octaves = np.where(f0 > 0, np.log2(f0), np.nan)
    semitones = 12 * (octaves - np.nanmedian(octaves))
    semitones *= _CONTOUR_SPREAD / np.nanstd(semitones)
    return Analysis(np.clip(semitones, -9, 9), envelope, aperiodicity, _boundaries(utterance))


def voice_strength(intensity: float) -> float:
    """Share of an emotion's prosody that a clip of that intensity carries.

    A voice shows its emotion more reliably than a body does, so the scale starts at .7.
    """
    return 0.7 + 0.4 * intensity


def scaled(prosody: Prosody, strength: float) -> Prosody:
    """The prosody at part of its strength; timing belongs to the clock and is left alone."""
    neutral = PROSODY["neutral"]
    mixed = Prosody(*(n + strength * (p - n) for p, n in zip(prosody, neutral, strict=True)))
    return mixed._replace(rate=prosody.rate, accent=prosody.accent, pause=prosody.pause)


def render_speech(cell: Cell, timing: Timing, intensity: float) -> Float[np.ndarray, " n"]:
    """Samples (float32, 16 kHz) of one clip on its clock.

    Args:
        cell: whose voice, which emotion, and the seed of everything that varies by chance.
        timing: the clock of the clip.
        intensity: how strongly the emotion shows, about 0 to 1.
    """
    import pyworld

    rng = np.random.default_rng([SEED, _SPEECH_STREAM, *_seed_of(cell)])
    analysis = analyse(cell.sentence, cell.speaker)
    voice = VOICES[cell.speaker]
    prosody = scaled(PROSODY[cell.emotion], voice_strength(intensity))
    times = np.arange(int(timing.duration * 1000 / FRAME_MS) + 1) * FRAME_MS / 1000
    semitones, envelope, aperiodicity = _onto_clock(analysis, timing, times)
    f0 = _intonate(semitones, times / timing.duration, times, prosody, voice, rng)
    envelope = _colour(envelope, prosody, voice, rng) * _loudness(timing, times, prosody, rng)
    breath = np.clip(prosody.breath + rng.normal(0, 0.03), 0, 0.9)
    aperiodicity = np.clip(1 - (1 - aperiodicity) * (1 - breath), 1e-4, 1 - 1e-6)
    samples = pyworld.synthesize(
        f0, np.ascontiguousarray(envelope), aperiodicity, SAMPLE_RATE, FRAME_MS
    )
    samples = samples[: round(timing.duration * SAMPLE_RATE)]
    samples = samples + rng.normal(0, 10 ** (NOISE_FLOOR_DB / 20), len(samples))
    return (np.tanh(1.2 * samples) / 1.2).astype(np.float32)


def _seed_of(cell: Cell) -> list[int]:
    return [
        cell.sentence,
        list(VOICES).index(cell.speaker),
        list(PROSODY).index(cell.emotion),
        cell.take,
    ]


def _onto_clock(analysis: Analysis, timing: Timing, times):
    """Read the analysis at the source moment of every target moment."""
    seconds = np.interp(times, timing.boundaries, analysis.boundaries)
    last = len(analysis.semitones) - 1
    at = np.clip(seconds * 1000 / FRAME_MS, 0, last)
    low = np.minimum(at.astype(int), last - 1)
    share = (at - low)[:, None]
    log_envelope = np.log(analysis.envelope)
    envelope = np.exp((1 - share) * log_envelope[low] + share * log_envelope[low + 1])
    aperiodicity = (1 - share) * analysis.aperiodicity[low]
    aperiodicity += share * analysis.aperiodicity[low + 1]
    semitones = analysis.semitones[np.round(at).astype(int)]
    outside = (times < LEAD_IN) | (times > timing.boundaries[-1])
    envelope[outside] = 1e-12
    semitones = np.where(outside, np.nan, semitones)
    return semitones, envelope, aperiodicity


def _intonate(semitones, position, times, prosody, voice, rng):
    """F0 in hertz: the contour stretched and shifted, with a final rise and a tremor."""
    contour = semitones * prosody.range * np.exp(rng.normal(0, 0.1))
    contour = contour + prosody.f0 + rng.normal(0, 0.6)
    contour = contour + prosody.final * np.clip((position - 0.75) / 0.25, 0, 1) ** 1.5
    phase = rng.uniform(0, 2 * np.pi)
    contour = contour + prosody.tremor * np.sin(2 * np.pi * 6.2 * times + phase)
    window = np.hanning(41)
    drift = np.convolve(rng.normal(0, 1, len(times) + 40), window / window.sum(), "valid")
    f0 = voice.f0 * 2 ** ((contour + 0.6 * drift) / 12)
    return np.where(np.isnan(f0), 0.0, np.clip(f0, 55, 520))


def _colour(envelope, prosody, voice, rng):
    """Move the formants and tilt the spectrum."""
    bins = envelope.shape[1]
    frequency = np.linspace(0, SAMPLE_RATE / 2, bins)
    factor = np.sqrt(voice.vocal_tract) * prosody.formant
    at = np.clip(frequency / factor / (SAMPLE_RATE / 2) * (bins - 1), 0, bins - 1)
    low = np.minimum(at.astype(int), bins - 2)
    share = at - low
    envelope = envelope[:, low] * (1 - share) + envelope[:, low + 1] * share
    tilt = prosody.tilt + voice.tilt + rng.normal(0, 0.4)
    decibels = np.clip(tilt * np.log2(np.maximum(frequency, 60) / 500), -18, 12)
    return envelope * 10 ** (decibels / 10)


def _loudness(timing, times, prosody, rng):
    """Power factor per frame: the emotion's gain, and an accent on stressed phonemes."""
    middles = (timing.boundaries[:-1] + timing.boundaries[1:]) / 2
    accent = np.where(timing.stressed, 2.5 * (prosody.accent - 0.8), 0)
    decibels = prosody.gain + rng.normal(0, 1.2) + np.interp(times, middles, accent)
    return 10 ** (decibels[:, None] / 10)
