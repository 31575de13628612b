import librosa
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.audio import HANDCRAFTED_NAMES, handcrafted_features


def column(features, name):
    return features[:, HANDCRAFTED_NAMES.index(name)]


def test_columns_are_librosas_at_12800_hertz(vowel):
    sound = librosa.resample(vowel, orig_sr=16000, target_sr=12800)
    features = handcrafted_features(vowel, 16000)
    assert features.shape == (80, len(HANDCRAFTED_NAMES)) == (80, 35)
    expected = [
        librosa.onset.onset_strength(y=sound, sr=12800)[None],
        librosa.feature.mfcc(y=sound, sr=12800),
        librosa.feature.chroma_cens(y=sound, sr=12800),
    ]
    np.testing.assert_allclose(features[:, :33], np.vstack(expected).T[:80], rtol=1e-4, atol=1e-4)


def test_onset_marks_sit_at_the_clicks(clicks, click_seconds):
    marked = np.flatnonzero(column(handcrafted_features(clicks, 16000), "onset")) / 25
    assert np.abs(marked[:, None] - click_seconds).min(axis=0).max() < 0.06
    assert np.abs(marked[:, None] - click_seconds).min(axis=1).max() < 0.09


def test_beat_marks_are_as_far_apart_as_the_clicks(clicks):
    beats = np.flatnonzero(column(handcrafted_features(clicks, 16000), "beat")) / 25
    assert np.median(np.diff(beats)) == pytest.approx(0.37, abs=0.04)


@settings(max_examples=6, deadline=None)
@given(st.integers(6000, 30000), st.sampled_from([18, 25, 30]), st.sampled_from([16000, 22050]))
def test_there_is_one_row_per_whole_motion_frame(n, fps, sample_rate):
    noise = np.random.default_rng(n).normal(scale=0.1, size=n).astype(np.float32)
    features = handcrafted_features(noise, sample_rate, fps)
    assert features.shape == (n * fps // sample_rate, 35)
    assert np.isfinite(features).all()


def test_silence_is_described_by_its_loudness_only():
    silence = handcrafted_features(np.zeros(16000, np.float32), 16000)
    assert silence[:, HANDCRAFTED_NAMES.index("mfcc 0")].any()
    assert not np.delete(silence, HANDCRAFTED_NAMES.index("mfcc 0"), axis=1).round(2).any()


@pytest.mark.parametrize("bad", [np.zeros(0), np.zeros(2000), np.full(16000, np.nan)])
def test_too_little_and_not_a_number_are_refused(bad):
    with pytest.raises(ValueError, match="samples"):
        handcrafted_features(bad, 16000)


def test_a_frame_rate_too_low_for_the_chromagram_is_refused(vowel):
    with pytest.raises(ValueError, match="9000 Hz"):
        handcrafted_features(vowel, 16000, fps=15)
