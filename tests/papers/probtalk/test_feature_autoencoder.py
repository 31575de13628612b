"""The networks behind FGD: what they see, what they rebuild, how large they are."""

from dataclasses import replace

import pytest
import torch

from s2glib.papers.probtalk.config import PAPER_FEATURES, TEACHING_FEATURES
from s2glib.papers.probtalk.feature_autoencoder import (
    SEEN,
    FeatureAutoencoder,
    FeatureNets,
    feature_losses,
    split_windows,
)


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


def parameters(model):
    return sum(p.numel() for p in model.parameters())


def test_the_authors_networks_have_their_sizes():
    with torch.device("meta"):
        nets = FeatureNets(PAPER_FEATURES)
        codes = nets(torch.zeros(2, 90, 376))
        rebuilt = nets.nets["all"](torch.zeros(2, 90, 376))
    sizes = {kind: parameters(net) for kind, net in nets.nets.items()}
    assert sizes == {"face": 1_096_986, "body and hands": 1_128_638, "all": 1_149_096}
    assert all(code.shape == (2, 128) for code in codes.values())
    assert rebuilt.shape == (2, 90, 376)
    assert nets.nets["all"].encoder[11].in_features == 1280  # 32 channels x 40 frames


def test_the_small_networks_fit_their_budget():
    assert parameters(FeatureNets(TEACHING_FEATURES)) <= 250_000


@pytest.mark.parametrize("frames", [90, 88, 45])
def test_a_window_of_any_length_is_rebuilt_at_its_length(frames):
    net = FeatureAutoencoder(18, replace(TEACHING_FEATURES, frames=frames))
    assert net(torch.randn(3, frames, 18)).shape == (3, frames, 18)


@pytest.mark.parametrize("kind", SEEN)
def test_a_network_is_blind_to_what_it_does_not_see(kind):
    nets = FeatureNets(TEACHING_FEATURES).eval()
    motion = torch.randn(2, 88, 288)
    seen = torch.zeros(288, dtype=torch.bool)
    seen[nets.see(kind, torch.arange(288.0).expand(1, 1, -1)).long().flatten()] = True
    moved = motion + ~seen
    assert torch.equal(nets(moved)[kind], nets(motion)[kind])
    if not seen.all():
        assert not torch.allclose(nets(motion + seen)[kind], nets(motion)[kind], atol=1e-4)


def test_face_and_the_rest_make_up_the_whole():
    nets = FeatureNets(TEACHING_FEATURES)
    columns = torch.arange(288.0).expand(1, 1, -1)
    halves = torch.cat([nets.see("face", columns), nets.see("body and hands", columns)], dim=-1)
    assert halves.flatten().sort().values.tolist() == list(range(288))
    assert nets.see("face", columns).shape[-1] == 18


def test_the_releases_slope_makes_the_linear_layers_one_map():
    net = FeatureAutoencoder(18, replace(TEACHING_FEATURES, slope=1.0)).eval()
    linear = net.encoder[11:]  # all after the convolutions
    a, b = torch.randn(2, 4, linear[0].in_features)
    torch.testing.assert_close(
        linear(a + b) + linear(torch.zeros_like(a)), linear(a) + linear(b), rtol=1e-4, atol=1e-5
    )


def test_velocity_is_the_change_over_time_not_over_channels():
    motion = torch.randn(2, 10, 6)
    over_channels = torch.arange(6.0).expand(2, 10, -1)
    over_time = torch.arange(10.0)[:, None].expand(2, -1, 6)
    assert feature_losses(motion, motion + over_channels).velocity < 1e-6
    torch.testing.assert_close(
        feature_losses(motion, motion + over_time).velocity, torch.tensor(1.0)
    )


def test_both_losses_count_the_same():
    losses = feature_losses(*torch.randn(2, 2, 10, 6))
    assert losses.total() == losses.reconstruction + losses.velocity


def test_a_loss_for_every_network_reaches_its_weights():
    nets = FeatureNets(TEACHING_FEATURES)
    losses = nets.losses(torch.randn(4, 88, 288))
    sum(terms.total() for terms in losses.values()).backward()
    assert all(p.grad is not None for p in nets.parameters())


def test_windows_are_cut_side_by_side():
    motion = torch.arange(2 * 10, dtype=torch.float32).reshape(2, 10, 1)
    windows = split_windows(motion, 4)
    assert windows[..., 0].tolist() == [
        [0, 1, 2, 3], [10, 11, 12, 13], [4, 5, 6, 7], [14, 15, 16, 17],
    ]  # fmt: skip
