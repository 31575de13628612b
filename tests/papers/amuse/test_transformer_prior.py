from dataclasses import replace

import pytest
import torch

from s2glib.papers.amuse import PAPER_PRIOR, MotionPrior


def linear(n, m):
    return n * m + m


def attention(width):
    return 4 * linear(width, width)


@pytest.fixture
def small(prior_config):
    config = replace(
        prior_config, backbone="transformer", token_dim=8, heads=2, layers=3, hidden=16
    )
    return MotionPrior(config).eval()


def test_the_paper_prior_has_the_size_of_its_layers():
    with torch.device("meta"):
        prior = MotionPrior(PAPER_PRIOR)
    width, hidden, layers = 128, 512, 9
    network = linear(width, hidden) + linear(hidden, width)
    joins = 4 * linear(2 * width, width)
    encoder = layers * (attention(width) + network + 4 * width) + joins + 2 * width
    encoder += linear(333, width) + 2 * width + 500 * width
    decoder = layers * (2 * attention(width) + network + 6 * width) + joins + 2 * width
    decoder += linear(width, 333) + 500 * width
    assert sum(p.numel() for p in prior.encoder.parameters()) == encoder
    assert sum(p.numel() for p in prior.decoder.parameters()) == decoder


def test_a_clip_is_read_in_order(small):
    motion = torch.randn(1, 40, 90)
    backwards = motion.flip(1)
    assert (small.encode(motion).mean - small.encode(backwards).mean).abs().max() > 1e-3


def test_one_token_steers_all_frames(small):
    token = torch.randn(1, 5, 8)
    change = (small.decode(token + 1) - small.decode(token)).abs().amax(dim=(0, 2))
    assert (change > 1e-4).all()
