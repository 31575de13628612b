import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.audio import Waveform, load_speech_model, wav2vec2_features
from s2glib.data import clips, load_clip
from s2glib.data.windows import noise_floor, speech_window
from s2glib.papers.probtalk import at_motion_rate, log_mels, wav2vec2
from s2glib.papers.probtalk.speech_features import LOG_MEL_MEAN, LOG_MEL_STD, motion_frames


def buzz(seconds, seed=0):
    return np.random.default_rng(seed).normal(0, 0.1, round(16000 * seconds)).astype(np.float32)


@pytest.mark.parametrize("name", [*clips()[::9], "s01-voice_01-neutral-t2"])
def test_a_shipped_clip_has_as_many_frames_as_go_with_its_sound(name):
    clip = load_clip(name)
    assert motion_frames(clip.waveform) == clip.motion.frames


@given(st.integers(1, 100_000), st.sampled_from([16000, 22050, 44100, 48000]))
def test_frames_of_motion_fit_into_the_sound_and_another_one_would_not(samples, rate):
    frames = motion_frames(Waveform(np.zeros(samples, np.float32), rate))
    assert frames * rate <= 30 * samples or frames == 1
    assert (frames + 1) * rate > 30 * samples


@pytest.mark.parametrize(("seconds", "frames"), [(2.0, 60), (10.0, 300), (0.001, 1), (0.999, 29)])
def test_frames_of_motion_are_rounded_down_and_never_none(seconds, frames):
    assert motion_frames(Waveform(buzz(seconds), 16000)) == frames


def test_what_is_no_speech_has_no_frames(without_type_hook):
    with pytest.raises(TypeError, match="as a Waveform, got ndarray"):
        motion_frames(buzz(1.0))


@given(st.integers(8000, 60_000), st.integers(1, 300))
def test_as_many_frames_as_were_asked_for(samples, frames):
    heard = log_mels(buzz(samples / 16000), frames)
    assert heard.shape == (frames, 64)
    assert heard.isfinite().all()


def test_after_the_end_of_the_sound_there_is_the_noise_floor():
    silence = (torch.from_numpy(noise_floor(64)) - LOG_MEL_MEAN) / LOG_MEL_STD
    heard = log_mels(buzz(1.0), 60)
    torch.testing.assert_close(heard[32:], silence.expand(28, -1))
    assert (heard[:29] - silence).mean() > 0.5


def test_training_and_use_hear_the_same():
    """Windows of the cache are cut by `speech_window`, 352 frames of 20 ms."""
    sound = buzz(5.0)
    window = torch.from_numpy(speech_window(sound, n_mels=64, frames=352, pool=2))
    torch.testing.assert_close(at_motion_rate(window)[:176], log_mels(sound, 176))


def test_a_ramp_stays_a_ramp():
    ramp = torch.arange(50.0)[:, None].expand(-1, 64)  # 20 ms a frame, each named by its number
    frames = at_motion_rate(ramp) * LOG_MEL_STD + LOG_MEL_MEAN
    moments = (torch.arange(30) + 0.5) / 30
    torch.testing.assert_close(frames[:, 0], (moments * 50 - 0.5).clamp(0, 49))


def test_a_click_is_heard_when_it_sounds():
    sound = np.zeros(48000, np.float32)
    sound[24000:24160] = 0.5  # at 1.5 s
    loud = log_mels(sound, 90).mean(1)
    assert abs(int(loud.argmax()) - 45) <= 1


def test_leading_axes_are_kept():
    assert at_motion_rate(torch.zeros(2, 3, 352, 64)).shape == (2, 3, 211, 64)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A tiny wav2vec2 in the layout of the public one."""
    transformers = pytest.importorskip("transformers")
    config = transformers.Wav2Vec2Config(
        hidden_size=16,
        num_hidden_layers=1,
        num_attention_heads=2,
        intermediate_size=16,
        conv_dim=(8,) * 7,
        num_conv_pos_embeddings=8,
        num_conv_pos_embedding_groups=2,
    )
    path = tmp_path_factory.mktemp("wav2vec2")
    torch.manual_seed(0)
    transformers.Wav2Vec2Model(config).save_pretrained(path)
    return path


def test_wav2vec2_is_the_adapters_last_layer_at_the_motions_rate(folder):
    sound = buzz(2.0)
    expected = wav2vec2_features(load_speech_model(folder), sound, fps=30)
    heard = wav2vec2(folder)(sound, 60)
    torch.testing.assert_close(heard, torch.from_numpy(expected))


@pytest.mark.parametrize("frames", [20, 61, 90])
def test_wav2vec2_cuts_or_pads_to_the_frames(folder, frames):
    assert wav2vec2(folder)(buzz(2.0), frames).shape == (frames, 16)
