import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.audio import standardize
from s2glib.data import speech_window
from s2glib.papers.amuse import rhythm, speech_input, standardized, time_tracks
from s2glib.papers.amuse.front_end import frame_moments, sample_track

NOISE = np.random.default_rng(0).normal(0, 0.1, 32000).astype(np.float32)


def test_the_encoders_see_a_standardised_window(speech_config):
    seen = speech_input(NOISE, speech_config)
    window = speech_window(NOISE, n_mels=64, frames=352, pool=2)
    expected = (window - speech_config.mean) / (2 * speech_config.std)
    torch.testing.assert_close(seen, torch.from_numpy(expected))
    torch.testing.assert_close(seen, standardized(window, speech_config))
    torch.testing.assert_close(
        seen.numpy(), standardize(window, speech_config.mean, speech_config.std)
    )


@given(st.lists(st.floats(-3, 12), min_size=1, max_size=20), st.integers(1, 9))
def test_sampling_a_track_is_linear_interpolation(places, length):
    track = torch.randn(1, length, 2, generator=torch.Generator().manual_seed(0))
    found = sample_track(track, torch.tensor([places]))[0]
    for channel in range(2):
        expected = np.interp(places, np.arange(length), track[0, :, channel])
        assert found[:, channel].numpy() == pytest.approx(expected, abs=1e-5)


def test_frames_are_sampled_in_their_middle():
    assert frame_moments(3).tolist() == pytest.approx([1 / 60, 3 / 60, 5 / 60])


def test_rhythm_is_energy_and_rise():
    quiet = torch.zeros(1, 6, 4)
    quiet[0, 3:] = 1.0  # a step up in frame 3
    quiet[0, 5] = -1.0  # and down in frame 5, which is no onset
    energy, onset = rhythm(quiet)[0].T
    assert energy.tolist() == [0, 0, 0, 1, 1, -1]
    assert onset.tolist() == [0, 0, 0, 4, 0, 0]


def test_time_tracks_say_which_token_is_spoken_when(speech_config):
    seconds, tokens = 7.04, speech_config.content_tokens
    content = torch.arange(tokens).repeat_interleave(8).float()[None]  # token n holds n
    middles = (torch.arange(tokens) + 0.5) * seconds / tokens
    tracks = time_tracks(torch.zeros(1, 352, 2), content, middles[None], speech_config)
    assert tracks.shape == (1, tokens, 2 + 8)
    torch.testing.assert_close(
        tracks[0, :, 2:], torch.arange(tokens)[:, None].expand(-1, 8).float()
    )


def test_time_tracks_keep_the_rhythms_own_time(speech_config):
    beat = torch.zeros(1, 352, 2)
    beat[0, 100] = 1.0  # 2.00 to 2.02 s
    moments = torch.tensor([[1.97, 2.01, 2.05]])
    tracks = time_tracks(beat, torch.zeros(1, 64), moments, speech_config)
    torch.testing.assert_close(tracks[0, :, 0], torch.tensor([0.0, 1.0, 0.0]), atol=1e-4, rtol=0)
