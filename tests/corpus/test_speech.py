import librosa
import numpy as np
import pytest

from s2glib.corpus import speech
from s2glib.corpus.build import timing_of
from s2glib.corpus.clock import readings
from s2glib.corpus.intensity import intensity
from s2glib.corpus.script import EMOTIONS, PROSODY, VOICES, Cell
from s2glib.data import NOISE_FLOOR_DB

RATE = speech.SAMPLE_RATE
VOICE_PAIR = ("voice_01", "voice_05")


def render(speaker, emotion, take=2):
    cell = Cell(1, speaker, emotion, take)
    return speech.render_speech(cell, timing_of(cell), intensity(cell))


def pitch(samples):
    """Median F0 in hertz of the louder half, by an estimator that the generator does not use."""
    f0 = librosa.yin(samples, fmin=60, fmax=500, sr=RATE, frame_length=1024, hop_length=256)
    loud = librosa.feature.rms(y=samples, frame_length=1024, hop_length=256)[0]
    return np.median(f0[loud > np.median(loud)])


def energy(samples, hop=80):
    frames = samples[: len(samples) // hop * hop].reshape(-1, hop)
    return np.log(np.square(frames).mean(axis=1) + 1e-7)


def semitones(ratio):
    return 12 * np.log2(ratio)


def test_sound_is_finite_loud_enough_and_never_clipped(spoken):
    for clip in spoken.values():
        samples = clip.waveform.samples
        assert samples.dtype == np.float32
        assert np.isfinite(samples).all()
        assert np.abs(samples).max() < 1 / 1.2
        assert -40 < 20 * np.log10(np.sqrt(np.square(samples).mean())) < -15


def test_sound_is_as_long_as_its_clock(spoken):
    for clip in spoken.values():
        clock = timing_of(Cell(1, clip.speaker, clip.emotion, 2), "neutral")
        assert clip.waveform.duration == pytest.approx(clock.duration, abs=0.006)


def test_before_and_after_the_words_there_is_only_the_noise_floor(spoken):
    for clip in spoken.values():
        ends = clip.waveform.samples[:4000], clip.waveform.samples[-2400:]
        levels = [20 * np.log10(part.std()) for part in ends]
        assert levels == pytest.approx([NOISE_FLOOR_DB] * 2, abs=0.5)


@pytest.mark.parametrize("speaker", VOICE_PAIR)
def test_a_neutral_voice_has_the_pitch_of_its_table(spoken, speaker):
    measured = pitch(spoken[speaker, "neutral"].waveform.samples)
    assert abs(semitones(measured / VOICES[speaker].f0)) < 2.5


@pytest.mark.parametrize("speaker", VOICE_PAIR)
def test_surprise_is_higher_than_sadness(spoken, speaker):
    high, low = (pitch(spoken[speaker, e].waveform.samples) for e in ("surprise", "sadness"))
    assert semitones(high / low) > 3


@pytest.mark.parametrize("emotion", ["neutral", "surprise"])
def test_two_voices_speak_in_step(spoken, emotion):
    one, other = (energy(spoken[who, emotion].waveform.samples) for who in VOICE_PAIR)
    one, other = one - one.mean(), other - other.mean()
    lags = range(-20, 21)  # 5 ms each
    match = [np.sum(one[20:-20] * np.roll(other, lag)[20:-20]) for lag in lags]
    assert abs(lags[int(np.argmax(match))]) <= 2
    assert np.corrcoef(one, other)[0, 1] > 0.8


def test_the_same_cell_gives_the_same_bits_and_another_take_does_not():
    first = render("voice_01", "fear")
    speech.analyse.cache_clear()
    assert np.array_equal(render("voice_01", "fear"), first)
    other = render("voice_01", "fear", take=1)
    shared = min(len(first), len(other))
    assert not np.array_equal(first[:shared], other[:shared])


def test_emotion_is_louder_in_anger_than_in_sadness():
    loud, soft = (energy(render("voice_01", e)).max() for e in ("anger", "sadness"))
    assert loud > soft + 0.7  # nepers of power: 3 dB


@pytest.mark.parametrize("emotion", EMOTIONS)
def test_strength_mixes_everything_but_the_timing(emotion):
    prosody, neutral = PROSODY[emotion], PROSODY["neutral"]
    assert speech.scaled(prosody, 1.0) == pytest.approx(prosody)
    none = speech.scaled(prosody, 0.0)
    for name in prosody._fields:
        kept = prosody if name in ("rate", "accent", "pause") else neutral
        assert getattr(none, name) == getattr(kept, name)


def test_two_voices_agree_on_the_shipped_reading():
    reading, shipped = speech.canonical_reading(1, VOICE_PAIR), readings()[1]
    assert reading.phonemes == shipped.phonemes
    assert reading.word_places == shipped.word_places
    assert reading.durations.sum() == pytest.approx(shipped.durations.sum(), rel=0.1)


def test_voices_that_speak_other_phonemes_have_no_common_reading(monkeypatch):
    utterances = iter([("a",), ("a", "b")])

    def say(sentence, speaker):
        phonemes = tuple((name, 0.1 * n) for n, name in enumerate(next(utterances)))
        return speech.Utterance(np.zeros(22050), (("you", 0.0),), phonemes)

    monkeypatch.setattr(speech, "_utterance", say)
    with pytest.raises(ValueError, match="one phoneme sequence"):
        speech.canonical_reading(1, VOICE_PAIR)
