from dataclasses import replace

import pytest
import torch

from s2glib.papers.probtalk import PQVAE, TEACHING_PQVAE
from s2glib.papers.probtalk.straight_path import (
    StraightDecoder,
    StraightEncoder,
    start_from_components,
)

CONFIG = replace(TEACHING_PQVAE, widths=(8, 8, 8, 8), straight=10, latent=24, codes=5)


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.fixture
def motion():
    """Motion of ten degrees of freedom, some stronger than others, around a mean that is not 0."""
    strengths = torch.logspace(0, -1, 10)
    return (torch.randn(60, 32, 10) * strengths) @ torch.randn(10, 288) + torch.randn(288)


@pytest.fixture
def paths(motion):
    encoder, decoder = StraightEncoder(CONFIG), StraightDecoder(CONFIG)
    start_from_components(encoder, decoder, motion, groups=4)
    return encoder, decoder


def there_and_back(paths, motion):
    encoder, decoder = paths
    with torch.no_grad():
        return decoder(encoder(motion.mT)).mT


def test_paths_begin_as_the_best_linear_projection_of_windows(paths, motion):
    """Oracle: Eckart-Young on whole windows, whose frames have ten degrees of freedom."""
    back = there_and_back(paths, motion)
    windows = (motion - motion.mean((0, 1))).unflatten(1, (-1, 8)).flatten(0, 1).flatten(1)
    strengths = torch.linalg.svdvals(windows)
    least = strengths[10:].square().sum()
    torch.testing.assert_close((motion - back).square().sum(), least, rtol=1e-3, atol=1e-2)


def test_what_went_through_once_goes_through_unchanged(paths, motion):
    once = there_and_back(paths, motion)
    torch.testing.assert_close(there_and_back(paths, once), once, atol=1e-3, rtol=1e-3)


def test_components_are_dealt_to_the_groups_to_and_fro(paths, motion):
    latents = paths[0](motion.mT).mT.detach()
    spread = latents.flatten(0, 1).std(0).unflatten(0, (4, 6))
    assert (spread > 0).sum(1).tolist() == [3, 3, 2, 2]
    order = spread.flatten().argsort(descending=True)[:10] // 6
    assert order.tolist() == [0, 1, 2, 3, 3, 2, 1, 0, 0, 1]
    used = spread[spread > 0]
    assert float(used.square().mean()) == pytest.approx(1, rel=0.01)


def test_a_pqvae_begins_as_its_straight_paths(motion):
    model = PQVAE(CONFIG).eval()
    model.start_straight(motion)
    latents = model.straight_encoder(motion.mT)
    torch.testing.assert_close(model.latents(motion), latents.mT)
    torch.testing.assert_close(
        model.from_latents(latents.mT),
        there_and_back((model.straight_encoder, model.straight_decoder), motion),
    )


def test_networks_learn_from_the_first_step_on(motion):
    model = PQVAE(CONFIG)
    model.start_straight(motion)
    model(motion).motion.sub(motion).square().mean().backward()
    for network in (model.encoder, model.decoder):
        assert network[-1].weight.grad.abs().sum() > 0


def test_the_paper_has_no_straight_path(motion):
    model = PQVAE(replace(CONFIG, straight=0))
    before = {name: value.clone() for name, value in model.state_dict().items()}
    model.start_straight(motion)
    assert not any("straight" in name for name in before)
    assert all(torch.equal(value, before[name]) for name, value in model.state_dict().items())
