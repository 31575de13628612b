import librosa
import numpy as np
import pytest

from s2glib.audio import beat_times, onset_strength, onset_times, resample

FRAME = 512 / 22050


@pytest.mark.parametrize("sample_rate", [12800, 16000, 44100])
def test_each_click_is_one_onset_at_any_sample_rate(clicks, click_seconds, sample_rate):
    onsets = onset_times(resample(clicks, 16000, sample_rate), sample_rate)
    assert len(onsets) == len(click_seconds)
    np.testing.assert_allclose(onsets, click_seconds, atol=2 * FRAME)


def test_librosas_onsets_at_16_khz_fire_twice_for_one_click(clicks, click_seconds):
    onsets = librosa.onset.onset_detect(y=clicks, sr=16000, units="time")
    assert len(onsets) > len(click_seconds)
    assert np.diff(onsets).min() == pytest.approx(512 / 16000)  # neighbouring frames


def test_the_strength_rises_into_every_onset(clicks):
    strength = onset_strength(clicks, 16000)
    assert len(strength) == 1 + int(4.2 * 22050) // 512
    onsets = np.round(onset_times(clicks, 16000) / FRAME).astype(int)
    assert (strength[onsets] > strength[onsets - 1]).all()
    assert (strength[onsets] > strength.mean()).all()


def test_beats_follow_the_clicks(clicks):
    assert np.median(np.diff(beat_times(clicks, 16000))) == pytest.approx(0.37, abs=FRAME)


def test_silence_has_neither_onsets_nor_beats():
    silence = np.zeros(16000, np.float32)
    assert len(onset_times(silence, 16000)) == len(beat_times(silence, 16000)) == 0


@pytest.mark.parametrize("door", [onset_strength, onset_times, beat_times])
@pytest.mark.parametrize("bad", [np.zeros(0), np.zeros(1400), np.full(4096, np.nan)])
def test_rhythm_refuses_too_little_and_not_a_number(door, bad):
    with pytest.raises(ValueError, match="samples"):
        door(bad, 16000)
