import warnings

import librosa
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from transformers import ASTFeatureExtractor

from s2glib.audio import chroma, chroma_cens, filterbank, mel_filters, mfcc, standardize, tempogram


def ast_filterbank(samples, n_mels=128, frames=1024, **normalization):
    """The independent oracle: transformers' own implementation."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "At least one mel filter")
        extractor = ASTFeatureExtractor(num_mel_bins=n_mels, max_length=frames, **normalization)
    return extractor(samples, 16000, return_tensors="np")["input_values"][0]


@settings(max_examples=15, deadline=None)
@given(st.integers(400, 40000), st.sampled_from([40, 64, 128]), st.integers(1, 300), st.data())
def test_filterbank_is_that_of_the_audio_spectrogram_transformer(n, n_mels, frames, data):
    rng = np.random.default_rng(data.draw(st.integers(0, 99)))
    loudness = 10.0 ** data.draw(st.floats(-5, 0))
    samples = (loudness * rng.uniform(-1, 1, n)).astype(np.float32)
    ours, theirs = (
        filterbank(samples, 16000, n_mels, frames),
        ast_filterbank(samples, n_mels, frames, do_normalize=False),
    )
    np.testing.assert_allclose(ours, theirs, rtol=1e-5, atol=1e-5)


def test_standardized_filterbank_is_asts_input(vowel):
    mean, std = -4.2677393, 4.5689974
    ours = standardize(filterbank(vowel), mean, std)
    np.testing.assert_allclose(ours, ast_filterbank(vowel, mean=mean, std=std), atol=1e-5)


def test_ten_seconds_have_998_frames_padded_to_1024_with_zeros():
    noise = np.random.default_rng(0).standard_normal(160000).astype(np.float32)
    everything, padded = filterbank(noise, frames=None), filterbank(noise)
    assert everything.shape == (998, 128)
    np.testing.assert_array_equal(padded[:998], everything)
    assert padded.shape == (1024, 128)
    assert not padded[998:].any()


def test_an_offset_of_the_waveform_is_not_heard(vowel):
    np.testing.assert_allclose(filterbank(vowel + 0.1), filterbank(vowel), atol=0.02)


def test_doubling_the_pressure_adds_log_four(clicks):
    quiet, loud = filterbank(clicks, frames=None), filterbank(2 * clicks, frames=None)
    audible = quiet > -10
    np.testing.assert_allclose((loud - quiet)[audible], np.log(4), atol=1e-4)


def test_silence_is_the_floor():
    silence = np.zeros(16000, np.float32)
    np.testing.assert_allclose(filterbank(silence, frames=None), -15.942385, atol=1e-5)


@pytest.mark.parametrize("sample_rate", [8000, 22050, 48000])
def test_a_tone_lights_the_filter_at_its_pitch_at_any_rate(sample_rate):
    tone = np.sin(2 * np.pi * 1000 * np.arange(sample_rate) / sample_rate)
    brightest = filterbank(tone, sample_rate, n_mels=40, frames=None).mean(axis=0).argmax()
    filters = mel_filters(4097, sample_rate, 40)
    assert filters[round(1000 / (sample_rate / 2) * 4096), brightest] > 0.4


def test_neighbouring_mel_filters_share_every_frequency_between_them():
    inside = mel_filters(257, 16000, 40)[20:200]
    np.testing.assert_allclose(inside.sum(axis=1), 1, atol=1e-5)


@pytest.mark.parametrize("bad", [np.zeros(0), np.zeros(399), np.full(800, np.nan)])
def test_filterbank_refuses_too_little_and_not_a_number(bad):
    with pytest.raises(ValueError, match="samples"):
        filterbank(bad)


def test_mfcc_is_the_cosine_transform_of_htk_log_mels(vowel):
    from scipy.fft import dct

    mel = librosa.feature.melspectrogram(y=vowel, sr=16000, hop_length=128, n_mels=128, htk=True)
    expected = dct(librosa.power_to_db(mel), axis=0, norm="ortho")[:13].T
    np.testing.assert_allclose(mfcc(vowel, 16000), expected, atol=1e-3)


def test_probtalks_mfcc_run_at_nearly_thirty_frames_a_second(vowel):
    features = mfcc(vowel, 16000, coefficients=64, n_mels=256, hop_length=535)
    assert features.shape == (1 + len(vowel) // 535, 64)


@pytest.mark.parametrize("pitch_classes", [chroma, chroma_cens])
def test_an_a_lights_the_tenth_pitch_class(vowel, pitch_classes):
    middle = pitch_classes(vowel, 16000)[40:60]
    assert middle.shape == (20, 12)
    assert (middle.argmax(axis=1) == 9).all()


@pytest.mark.parametrize("pitch_classes", [chroma, chroma_cens])
def test_pitch_classes_of_silence_and_of_a_short_clip_are_finite(vowel, pitch_classes):
    assert not pitch_classes(np.zeros(8000, np.float32), 16000).any()
    assert np.isfinite(pitch_classes(vowel[20000:22100], 16000)).all()


def test_tempogram_peaks_at_the_period_of_the_clicks(clicks):
    lag = tempogram(clicks, 16000, lags=40)[40:-40, 6:20].mean(axis=0).argmax() + 6
    assert lag * 512 / 16000 == pytest.approx(0.37, abs=0.02)


@pytest.mark.parametrize("door", [mfcc, chroma, chroma_cens, tempogram])
@pytest.mark.parametrize("bad", [np.zeros(0), np.zeros(2047), np.full(4096, np.inf)])
def test_doors_over_librosa_refuse_too_little_and_infinity(door, bad):
    with pytest.raises(ValueError, match="samples"):
        door(bad, 16000)


def test_long_speech_is_transformed_block_by_block(vowel, monkeypatch):
    whole = filterbank(vowel)
    monkeypatch.setattr("s2glib.audio.spectral.BLOCK", 7)
    np.testing.assert_allclose(filterbank(vowel), whole, atol=1e-5)
