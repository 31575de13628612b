from dataclasses import replace

import pytest
import torch

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.papers.amuse import PAPER_SPEECH, TEACHING_SPEECH, SpeechDisentangler, SpeechLatents


def linear(n, m):
    return n * m + m


def transformer_layer(width, hidden):
    """Attention, two-layer network and two norms."""
    return 4 * linear(width, width) + linear(width, hidden) + linear(hidden, width) + 4 * width


def deit_parameters(latent, patches=1212, width=768, layers=12):
    """DeiT-B over 16 x 16 patches of one channel, and a projection to the latent."""
    patching = 16 * 16 * width + width
    tokens = (2 + patches + 2) * width
    projection = 2 * width + linear(width, latent)
    return patching + tokens + layers * transformer_layer(width, 4 * width) + 2 * width + projection


def decoder_parameters(decoder_width=512, frames=1024, mels=128):
    fusion = 3 * linear(256, 768) + 2 * transformer_layer(768, 2048)
    fusion += 2 * 768 + linear(768, decoder_width)
    layers = 4 * transformer_layer(decoder_width, 2048)
    return (
        fusion
        + layers
        + 2 * decoder_width
        + linear(decoder_width, 1024)
        + linear(1024, frames * mels)
    )


def count(module):
    return sum(parameter.numel() for parameter in module.parameters())


@pytest.fixture(scope="module")
def paper_model():
    with torch.device("meta"):
        return SpeechDisentangler(PAPER_SPEECH)


@pytest.mark.parametrize("part", ["content_encoder", "emotion_encoder", "style_encoder"])
def test_each_encoder_of_the_paper_is_a_deit_b(paper_model, part):
    parameters = count(getattr(paper_model, part))
    assert parameters == deit_parameters(256)
    assert 85e6 < parameters < 88e6


def test_the_decoder_of_the_paper_has_its_size(paper_model):
    assert count(paper_model.decoder) == decoder_parameters()
    heads = linear(256, 8) + linear(256, 30)
    assert count(paper_model) == 3 * deit_parameters(256) + decoder_parameters() + heads


def test_the_paper_model_takes_ten_seconds_apart_and_together(paper_model):
    latents = paper_model.encode(torch.zeros(2, 1024, 128, device="meta"))
    assert [latent.shape for latent in latents] == [(2, 256)] * 3
    assert paper_model.decode(latents).shape == (2, 1024, 128)
    assert paper_model.emotion_head(latents.emotion).shape == (2, 8)
    assert paper_model.style_head(latents.style).shape == (2, 30)


def test_the_teaching_model_is_small_and_keeps_the_content_width():
    with torch.device("meta"):
        model = SpeechDisentangler(TEACHING_SPEECH)
    latents = model.encode(torch.zeros(2, 352, 64, device="meta"))
    assert [latent.shape for latent in latents] == [(2, 256), (2, 32), (2, 32)]
    assert model.decode(latents).shape == (2, 352, 64)
    assert count(model) < 2.5e6  # 5 MB in half precision


def test_latents_come_in_the_papers_order():
    assert SpeechLatents._fields == ("content", "emotion", "style")


def test_forward_is_self_reconstruction(speech):
    clips = torch.randn(2, 352, 64)
    torch.testing.assert_close(speech(clips), speech.decode(speech.encode(clips)))


def test_every_latent_matters_to_the_drawing(speech):
    latents = speech.encode(torch.randn(2, 352, 64))
    drawn = speech.decode(latents)
    for name, latent in latents._asdict().items():
        other = latents._replace(**{name: latent + 1})
        assert (speech.decode(other) - drawn).abs().max() > 1e-4


def test_clips_of_a_batch_do_not_mix(speech):
    clips = torch.randn(3, 352, 64)
    torch.testing.assert_close(speech(clips)[1:2], speech(clips[1:2]), rtol=1e-4, atol=1e-4)


def test_remembered_emotions_are_class_means(speech):
    latents, labels = torch.randn(40, 6), torch.arange(40) % 8
    speech.remember_emotions(latents, labels)
    for label in range(8):
        torch.testing.assert_close(speech.emotion_centres[label], latents[label::8].mean(0))


def test_a_checkpoint_brings_back_the_model_and_its_emotions(speech, tmp_path):
    speech.remember_emotions(torch.randn(8, 6), torch.arange(8))
    path = tmp_path / "speech.safetensors"
    save_checkpoint(path, speech, speech.config)
    loaded = load_checkpoint(path, SpeechDisentangler)
    clips = torch.randn(1, 352, 64)
    assert loaded.config == speech.config
    assert torch.equal(loaded(clips), speech(clips))
    assert torch.equal(loaded.emotion_centres, speech.emotion_centres)


def test_a_small_patch_model_trains_all_its_parts(speech_config):
    config = replace(speech_config, backbone="patches", n_mels=16, frames=26, content_dim=6)
    config = replace(config, style_dim=6, emotion_dim=8, heads=2, decoder_width=8)  # 20 = 4 heads
    model = SpeechDisentangler(config)
    clips = torch.randn(2, 26, 16)
    latents = model.encode(clips)
    heads = model.emotion_head(latents.emotion).sum() + model.style_head(latents.style).sum()
    (model.decode(latents).square().mean() + heads).backward()
    assert all(p.grad is not None and p.grad.isfinite().all() for p in model.parameters())
