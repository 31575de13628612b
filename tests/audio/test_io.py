import warnings

import numpy as np
import pytest
import soundfile
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.audio import Waveform, load, resample, save, stream
from s2glib.audio.io import check_signal


@pytest.fixture
def write(tmp_path):
    def write(samples, sample_rate=16000, name="speech.wav", subtype=None):
        soundfile.write(tmp_path / name, samples, sample_rate, subtype=subtype)
        return tmp_path / name

    return write


@pytest.mark.parametrize(
    ("name", "subtype"),
    [
        *(("a.wav", kind) for kind in ("PCM_U8", "PCM_16", "PCM_24", "PCM_32", "FLOAT", "DOUBLE")),
        ("a.flac", "PCM_24"),
        ("a.ogg", "VORBIS"),
        ("a.mp3", "MPEG_LAYER_III"),
    ],
)
def test_every_format_gives_the_same_sound(write, vowel, name, subtype):
    heard = load(write(vowel, name=name, subtype=subtype)).samples
    assert heard.shape == vowel.shape
    assert np.abs(heard - vowel).max() < (0.05 if subtype in ("VORBIS", "MPEG_LAYER_III") else 0.01)


@settings(max_examples=15, deadline=None)
@given(st.integers(4000, 96000), st.integers(1, 3), st.floats(0.6, 1.5), st.integers(8000, 48000))
def test_any_rate_and_channel_count_keeps_duration_and_level(
    tmp_path_factory, rate, channels, duration, wanted
):
    path = tmp_path_factory.mktemp("rates") / "tone.wav"
    tone = 0.5 * np.sin(2 * np.pi * 440 * np.arange(int(duration * rate)) / rate)
    soundfile.write(path, np.tile(tone[:, None], channels), rate)
    heard = load(path, wanted)
    assert heard.sample_rate == wanted
    assert heard.duration == pytest.approx(len(tone) / rate, abs=1.01 / wanted)
    assert np.sqrt(2 * np.mean(heard.samples**2)) == pytest.approx(0.5, rel=0.02)


def test_channels_are_averaged(write, vowel):
    path = write(np.stack([vowel, 0 * vowel], axis=1), subtype="FLOAT")
    np.testing.assert_array_equal(load(path).samples, vowel / 2)


def test_reading_in_blocks_equals_librosas_resampling_in_one_piece(write):
    import librosa

    noise = np.random.default_rng(0).normal(scale=0.1, size=21 * 22050).astype(np.float32)
    path = write(noise, 22050, subtype="FLOAT")
    whole = librosa.resample(noise, orig_sr=22050, target_sr=16000)
    assert len(list(stream(path))) > 2
    np.testing.assert_allclose(load(path).samples, whole, atol=1e-6)


def test_resample_keeps_the_signal_at_its_own_rate_and_the_dtype(vowel):
    assert resample(vowel, 16000, 16000) is vowel
    assert resample(vowel.astype(np.float64), 16000, 8000).dtype == np.float64


@pytest.mark.parametrize(
    ("samples", "message"),
    [
        (np.zeros(0), "is empty"),
        (np.full(7999, 0.1), r"shorter than 0\.5 s"),
        (np.full(16000, 0.0009), "is silent"),
        (np.where(np.arange(16000) == 9000, np.nan, 0.1), "NaN or Inf"),
        (np.where(np.arange(16000) == 9000, -np.inf, 0.1), "NaN or Inf"),
        (np.stack([np.full(16000, 0.5), np.full(16000, -0.5)], 1), "is silent"),
    ],
)
def test_sound_without_speech_is_refused(write, samples, message):
    with pytest.raises(ValueError, match=message):
        load(write(samples, subtype="DOUBLE"))


def test_the_shortest_and_quietest_speech_is_accepted(write):
    assert load(write(np.full(8000, 0.0011), subtype="DOUBLE")).duration == 0.5


@pytest.mark.parametrize("name", ["text.wav", "empty.wav", "text.mp3", "text.raw", "cut.flac", ""])
def test_a_file_that_is_no_sound_is_refused_in_one_sentence(tmp_path, write, vowel, name):
    if name == "cut.flac":
        path = write(vowel, name=name)
        path.write_bytes(path.read_bytes()[:9000])
    elif name:
        (tmp_path / name).write_bytes(b"" if name == "empty.wav" else b"hello, world " * 99)
    with pytest.raises(ValueError, match="cannot be read as sound"):
        load(tmp_path / name)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nowhere\.wav"):
        load(tmp_path / "nowhere.wav")


def test_clipped_speech_is_accepted_with_a_warning(write, vowel):
    path = write((20 * vowel).clip(-1, 1))
    with pytest.warns(UserWarning, match="is clipped"):
        assert load(path).duration == 3.2


def test_a_tone_that_just_reaches_full_scale_is_not_called_clipped(write):
    tone = np.sin(2 * np.pi * 200 * np.arange(16000) / 16000)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.abs(load(write(tone)).samples).max() > 0.999


def test_more_than_half_an_hour_is_accepted_with_a_warning(write):
    path = write(np.tile([0.1, -0.1], 905 * 100), sample_rate=100, subtype="PCM_U8")
    with pytest.warns(UserWarning, match="longer than 30 minutes"):
        assert load(path, 100).duration == 1810


@pytest.mark.parametrize("name", ["out.wav", "out.flac", "OUT.WAV"])
def test_saved_speech_comes_back(tmp_path, vowel, name):
    save(tmp_path / name, Waveform(vowel, 16000))
    heard = load(tmp_path / name)
    np.testing.assert_allclose(heard.samples, vowel, atol=1e-4)
    assert [file.name for file in tmp_path.iterdir()] == [name]


def test_a_failed_save_leaves_the_old_file_and_nothing_else(tmp_path, vowel, monkeypatch):
    path = tmp_path / "speech.wav"
    path.write_text("old")

    def fail(path, *_, **__):
        path.write_text("half")
        raise OSError("disk full")

    monkeypatch.setattr(soundfile, "write", fail)
    with pytest.raises(OSError, match="disk full"):
        save(path, Waveform(vowel, 16000))
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("speech.wav", "old")]


def test_save_refuses_other_formats_and_missing_folders(tmp_path, vowel):
    with pytest.raises(ValueError, match="ending in"):
        save(tmp_path / "speech.mp3", Waveform(vowel, 16000))
    with pytest.raises(FileNotFoundError, match="no folder"):
        save(tmp_path / "none" / "speech.wav", Waveform(vowel, 16000))


@pytest.mark.parametrize(
    ("samples", "sample_rate"),
    [
        (np.zeros(0, np.float32), 16000),
        (np.zeros((2, 9), np.float32), 16000),
        (np.full(9, np.nan, np.float32), 16000),
        (np.zeros(9, np.float32), 0),
        (np.zeros(9, np.float64), 16000),
        (np.zeros(9, np.int16), 16000),
        ([0.0, 0.1], 16000),
    ],
)
def test_a_waveform_is_finite_mono_float32(samples, sample_rate):
    with pytest.raises((TypeError, ValueError)):
        Waveform(samples, sample_rate)


def test_the_check_explains_itself_without_the_type_hook():
    check = getattr(check_signal, "__wrapped__", check_signal)
    with pytest.raises(TypeError, match="int16; convert"):
        check(np.zeros(9, np.int16), 16000)
    with pytest.raises(ValueError, match="average channels"):
        check(np.zeros((9, 2)), 16000)
    with pytest.raises(ValueError, match="at least 400 samples"):
        check(np.zeros(9), 16000, shortest=400)
