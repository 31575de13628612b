import pytest
import torch

from s2glib.papers.amuse.temporal_backbone import ContentEncoder, PooledEncoder, TemporalDecoder


@pytest.fixture
def clips():
    return torch.randn(2, 352, 64)


def test_a_pooled_latent_hardly_knows_when_something_was_said(speech_config, clips):
    encoder = PooledEncoder(speech_config, 6).eval()
    later = encoder(clips.roll(32, dims=1))
    other = encoder(torch.randn(2, 352, 64) * 2)
    latent = encoder(clips)
    assert (later - latent).norm() < 0.2 * (other - latent).norm()


def test_a_content_latent_knows(speech_config, clips):
    encoder = ContentEncoder(speech_config).eval()
    clips[:, 100:140] += 5
    latent, later = encoder(clips), encoder(clips.roll(120, dims=1))
    assert latent.shape == (2, speech_config.content_dim)
    assert (later - latent).norm() > 0.02 * latent.norm()


def test_a_decoder_starts_with_content_where_it_belongs(speech_config):
    """Changing the first content token changes the first frames more than the last."""
    decoder = TemporalDecoder(speech_config).eval()
    content, e, s = torch.randn(4, 64), torch.randn(4, 6), torch.randn(4, 7)
    other = content.clone()
    other[:, :8] += 3
    change = (decoder(other, e, s) - decoder(content, e, s)).abs().mean(dim=(0, 2))
    assert change[:40].mean() > 2 * change[-40:].mean()


def test_dropout_is_for_training_only(speech_config, clips):
    encoder = PooledEncoder(speech_config, 6)
    assert not torch.equal(encoder(clips), encoder(clips))
    encoder.eval()
    assert torch.equal(encoder(clips), encoder(clips))
