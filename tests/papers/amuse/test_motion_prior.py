from dataclasses import replace

import pytest
import torch

from s2glib.body import axis_angle_to_matrix, matrix_to_sixd
from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.papers.amuse import (
    PAPER_PRIOR,
    TEACHING_PRIOR,
    MotionPosterior,
    MotionPrior,
    prior_losses,
)


def rotations(batch=2, frames=40):
    """Features of true rotations, as they are while nothing was fitted."""
    turns = axis_angle_to_matrix(0.5 * torch.randn(batch, frames, 13, 3))
    return torch.cat([matrix_to_sixd(turns).flatten(-2), torch.randn(batch, frames, 12)], dim=-1)


def test_a_sample_has_the_posteriors_mean_and_spread(generator):
    mean, log_var = torch.tensor([[[2.0, -1.0]]]), torch.tensor([[[-2.0, 1.0]]])
    wide = MotionPosterior(mean.expand(20000, 1, 2), log_var.expand(20000, 1, 2))
    drawn = wide.sample(generator)
    torch.testing.assert_close(drawn.mean(0), mean[0], atol=0.05, rtol=0)
    torch.testing.assert_close(drawn.std(0), (log_var / 2).exp()[0], rtol=0.03, atol=0)


def test_gradients_reach_mean_and_spread_through_a_sample(generator):
    mean, log_var = (
        torch.zeros(1, 2, 3, requires_grad=True),
        torch.zeros(1, 2, 3, requires_grad=True),
    )
    MotionPosterior(mean, log_var).sample(generator).sum().backward()
    assert torch.equal(mean.grad, torch.ones(1, 2, 3))
    assert (log_var.grad != 0).all()


@pytest.mark.parametrize("config", [PAPER_PRIOR, TEACHING_PRIOR], ids=["paper", "teaching"])
def test_a_clip_becomes_tokens_and_a_clip_again(config):
    with torch.device("meta"):
        prior = MotionPrior(config)
    posterior = prior.encode(torch.zeros(2, config.frames, config.features, device="meta"))
    assert posterior.mean.shape == posterior.log_var.shape == (2, config.tokens, config.token_dim)
    assert prior.decode(posterior.mean).shape == (2, config.frames, config.features)


def test_the_papers_latent_is_one_token():
    assert (PAPER_PRIOR.tokens, PAPER_PRIOR.token_dim, PAPER_PRIOR.frames) == (1, 128, 300)


def test_the_teaching_prior_is_small():
    with torch.device("meta"):
        prior = MotionPrior(TEACHING_PRIOR)
    assert sum(p.numel() for p in prior.parameters()) < 1e6


def test_forward_reconstructs_from_the_mean(prior):
    motion = rotations()
    assert torch.equal(prior(motion), prior.decode(prior.encode(motion).mean))


def test_the_losses_are_what_their_names_say(prior, generator):
    motion = rotations()
    losses = prior_losses(prior, motion, generator=generator)
    posterior = prior.encode(motion)
    drawn = prior.decode(posterior.sample(torch.Generator().manual_seed(0)))
    places, made = prior.features.positions(motion), prior.features.positions(drawn)
    normal = torch.distributions.Normal(posterior.mean, (posterior.log_var / 2).exp())
    kl = torch.distributions.kl_divergence(normal, torch.distributions.Normal(0.0, 1.0))
    torch.testing.assert_close(losses.reconstruction, (drawn - motion).abs().mean())
    speed = (drawn[:, 1:] - drawn[:, :-1]) - (motion[:, 1:] - motion[:, :-1])
    torch.testing.assert_close(losses.velocity, speed.abs().mean())
    distance = torch.linalg.vector_norm(made - places, dim=-1).mean()
    torch.testing.assert_close(losses.position, distance, rtol=1e-3, atol=1e-3)
    torch.testing.assert_close(losses.kl, kl.sum(dim=(-2, -1)).mean(), rtol=1e-4, atol=1e-3)


def test_the_total_weighs_position_and_kl(prior, generator):
    losses = prior_losses(prior, rotations(), generator=generator)
    parts = losses.reconstruction + losses.velocity
    assert losses.total(kl=0.0, position=0.0) == parts
    torch.testing.assert_close(
        losses.total(kl=2.0, position=3.0), parts + 3 * losses.position + 2 * losses.kl
    )


@pytest.mark.parametrize("backbone", ["temporal", "transformer"])
def test_training_reaches_every_weight(prior_config, backbone, generator, awake):
    config = replace(prior_config, backbone=backbone, token_dim=8, heads=2, layers=3, hidden=16)
    prior = awake(MotionPrior(config))
    prior_losses(prior, rotations(), generator=generator).total(kl=1.0).backward()
    assert all(p.grad is not None and p.grad.isfinite().all() for p in prior.parameters())


def test_a_checkpoint_brings_back_the_prior_with_its_statistics(prior, tmp_path):
    poses = 0.3 * torch.randn(50, 55, 3)
    prior.features.fit(poses)
    path = tmp_path / "prior.safetensors"
    save_checkpoint(path, prior, prior.config)
    loaded = load_checkpoint(path, MotionPrior)
    motion = prior.features.from_poses(poses[:40])[None]
    assert torch.equal(loaded.features.from_poses(poses[:40])[None], motion)
    assert torch.equal(loaded(motion), prior(motion))
