from dataclasses import replace

import pytest
import torch

from s2glib.papers.amuse import FilterbankDecoder, Fusion


@pytest.fixture
def config(speech_config):
    return replace(
        speech_config,
        content_dim=4,
        emotion_dim=8,
        style_dim=4,
        n_mels=6,
        frames=10,
        decoder_width=8,
    )


def latents(batch=2):
    return torch.randn(batch, 4), torch.randn(batch, 8), torch.randn(batch, 4)


def test_fusion_gives_one_embedding_in_which_each_latent_counts(config):
    fusion, triplet = Fusion(config).eval(), latents()
    fused = fusion(*triplet)
    assert fused.shape == (2, 8)
    for place in range(3):
        changed = [t + 1.0 * (n == place) for n, t in enumerate(triplet)]
        assert (fusion(*changed) - fused).abs().max() > 1e-3


def test_the_three_tokens_attend_to_each_other(config):
    """What content does to the fused embedding depends on the emotion."""
    fusion, (c, e, s) = Fusion(config).eval(), latents()
    effect = fusion(c + 1, e, s) - fusion(c, e, s)
    other = fusion(c + 1, e + 3, s) - fusion(c, e + 3, s)
    assert (effect - other).abs().max() > 1e-3


def test_a_filterbank_is_drawn_from_one_token(config):
    drawn = FilterbankDecoder(config).eval()(*latents(3))
    assert drawn.shape == (3, 10, 6)
    assert drawn.isfinite().all()
