from dataclasses import replace

import torch

from s2glib.papers.mddiffusion import PAPER_DECOUPLING, KeypointPredictor


def test_the_papers_predictor_is_resnet_18_with_200_outputs():
    with torch.device("meta"):
        predictor = KeypointPredictor(PAPER_DECOUPLING)
        keypoints = predictor(torch.zeros(2, 3, 256, 256))
    resnet_18, its_head, our_head = 11_689_512, 513 * 1000, 513 * 20 * 5 * 2
    count = sum(p.numel() for p in predictor.parameters())
    assert count == resnet_18 - its_head + our_head
    assert keypoints.shape == (2, 20, 5, 2)


def test_keypoints_stay_within_reach(config):
    predictor = KeypointPredictor(config)
    predictor.encoder.fc.weight.data *= 1e4
    keypoints = predictor(torch.rand(4, 3, 32, 32))
    assert keypoints.shape == (4, 3, 5, 2)
    assert keypoints.abs().max() <= config.keypoint_reach
    assert keypoints.abs().max() > 0.99 * config.keypoint_reach


def test_numbers_are_ordered_by_group_then_point_then_x_and_y(config):
    """The order of the 200-number motion feature; authors' code."""
    predictor = KeypointPredictor(replace(config, keypoint_gain=1.0, keypoint_reach=1.0)).eval()
    torch.nn.init.zeros_(predictor.encoder.fc.weight)
    predictor.encoder.fc.bias.data = torch.linspace(-2, 2, 30)
    keypoints = predictor(torch.rand(1, 3, 32, 32))[0]
    assert (keypoints.flatten().diff() > 0).all()
    torch.testing.assert_close(keypoints[1, 2, 1], torch.tanh(torch.linspace(-2, 2, 30)[15] / 2))


def test_it_can_start_near_given_places(config, keypoints):
    predictor = KeypointPredictor(config)
    predictor.start_at(keypoints[0])
    found = predictor(torch.rand(8, 3, 32, 32))
    assert (found - keypoints[0]).abs().max() < 0.3
    assert (found - keypoints[0]).abs().mean() < 0.05
    assert found.std(dim=0).min() > 0


def test_a_place_on_the_very_edge_is_no_infinite_start(config):
    predictor = KeypointPredictor(config)
    predictor.start_at(torch.ones(3, 5, 2))
    assert predictor.encoder.fc.bias.isfinite().all()
