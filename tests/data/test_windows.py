import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.audio import filterbank
from s2glib.data import NOISE_FLOOR_DB, noise_floor, speech_window, spoken_frames

RATE = 16000
LOUD = np.random.default_rng(0).normal(0, 0.1, 2 * RATE).astype(np.float32)


@settings(max_examples=20, deadline=None)
@given(
    st.integers(0, 40000), st.sampled_from([16, 64]), st.integers(1, 200), st.sampled_from([1, 2])
)
def test_a_window_has_its_shape_and_never_sinks_below_the_floor(count, n_mels, frames, pool):
    samples = np.resize(LOUD, count)
    window = speech_window(samples, n_mels=n_mels, frames=frames, pool=pool)
    assert window.shape == (frames, n_mels)
    assert window.dtype == np.float32
    assert (window >= noise_floor(n_mels) - 1e-4).all()


def test_frames_after_the_end_are_one_constant_spectrum():
    window = speech_window(LOUD, n_mels=64, frames=352, pool=2)
    spoken = spoken_frames(2.0, frames=352, pool=2)
    floor = np.broadcast_to(noise_floor(64), window[spoken:].shape)
    assert window[spoken:] == pytest.approx(floor, abs=1e-5)
    assert (window[: spoken - 2].mean(axis=1) > floor[0].mean() + 3).all()


def test_pooling_is_the_mean_of_neighbouring_frames():
    fine = speech_window(LOUD, n_mels=64, frames=400, pool=1)
    coarse = speech_window(LOUD, n_mels=64, frames=200, pool=2)
    assert coarse == pytest.approx((fine[::2] + fine[1::2]) / 2, abs=1e-5)


def test_a_window_is_the_filterbank_above_the_floor():
    window = speech_window(LOUD, n_mels=128, frames=100, pool=1)
    sound = filterbank(LOUD, n_mels=128, frames=None)[:100]
    assert window == pytest.approx(np.maximum(sound, noise_floor(128)), abs=1e-5)
    assert (window == sound).mean() > 0.99


def test_what_is_longer_than_the_window_is_cut():
    short = speech_window(LOUD[:RATE], n_mels=32, frames=50, pool=1)
    assert np.array_equal(short, speech_window(LOUD, n_mels=32, frames=50, pool=1))


def test_silence_sounds_like_the_noise_floor():
    noise = np.random.default_rng(1).normal(0, 10 ** (NOISE_FLOOR_DB / 20), 4 * RATE)
    assert noise_floor(64) == pytest.approx(
        filterbank(noise.astype(np.float32), n_mels=64, frames=None).mean(axis=0), abs=0.3
    )
    silent = speech_window(np.zeros(RATE, np.float32), n_mels=64, frames=100, pool=1)
    assert silent == pytest.approx(np.broadcast_to(noise_floor(64), (100, 64)))


@given(st.floats(0, 20), st.integers(1, 500), st.integers(1, 4))
def test_spoken_frames_cover_the_sound_and_no_more(seconds, frames, pool):
    count = spoken_frames(seconds, frames=frames, pool=pool)
    assert 0 <= count <= frames
    assert count * pool >= min(100 * seconds, frames * pool) - 1e-6
    assert (count - 1) * pool < 100 * seconds + 1e-6 or count == 0
