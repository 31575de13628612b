from dataclasses import replace

import pytest
import torch
from torch import nn

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.layers import PyramidFeatures
from s2glib.papers.mddiffusion import (
    PAPER_DECOUPLING,
    TEACHING_DECOUPLING,
    DecouplingLosses,
    MotionDecoupler,
    decoupling_losses,
    label_error,
)
from s2glib.warping import ThinPlateSpline, coordinate_grid, random_tps

FEATURES = PyramidFeatures(2)


class Centroid(nn.Module):
    """A keypoint predictor that can be trusted: all points at the picture's centre of light."""

    def forward(self, image):
        light = image.mean(dim=1)
        grid = coordinate_grid(*light.shape[-2:])
        centre = torch.einsum("bhw,hwc->bc", light, grid) / light.sum(dim=(1, 2))[:, None]
        return centre[:, None, None].expand(-1, 3, 5, 2)


def shift_by(x, y):
    affine = torch.tensor([[x, y], [1.0, 0.0], [0.0, 1.0]]).expand(2, 3, 2)
    return ThinPlateSpline(torch.zeros(2, 1, 2), torch.zeros(2, 1, 2), affine)


def spot():
    grid = coordinate_grid(32, 32)
    return torch.exp(-(grid.square().sum(-1)) / 0.02).expand(2, 3, 32, 32)


def losses_of(model, images, **options):
    return decoupling_losses(model, *images, FEATURES, random_tps(2), **options)


def test_the_papers_system_from_picture_to_picture():
    with torch.device("meta"):
        model = MotionDecoupler(PAPER_DECOUPLING)
        images = torch.zeros(2, 3, 256, 256)
        made = model(images, images)
    assert made.source_keypoints.shape == made.driving_keypoints.shape == (2, 20, 5, 2)
    assert made.synthesis.image.shape == (2, 3, 256, 256)
    assert sum(p.numel() for p in model.parameters()) == 11_279_112 + 38_364_647 + 24_737_283


def test_the_teaching_checkpoint_stays_below_two_megabytes():
    with torch.device("meta"):
        model = MotionDecoupler(TEACHING_DECOUPLING)
        made = model(torch.zeros(2, 3, 64, 64), torch.zeros(2, 3, 64, 64))
    assert 2 * sum(p.numel() for p in model.parameters()) < 1.95e6
    assert made.synthesis.image.shape == (2, 3, 64, 64)


def test_a_picture_driven_by_itself_does_not_move(config, images):
    model = MotionDecoupler(replace(config, ridge=0.0)).eval()
    made = model(images[0], images[0])
    still = coordinate_grid(16, 16).expand(2, 16, 16, 2)
    torch.testing.assert_close(made.flow.sampling_grid, still, atol=1e-3, rtol=0)
    torch.testing.assert_close(made.synthesis.warped, images[0], atol=2e-2, rtol=0)


def test_only_keypoints_come_from_the_driving_picture(decoupler, images):
    """Motion decoupled from looks: the same keypoints give the same picture."""
    made = decoupler.eval()(*images)
    again, flow = decoupler.animate(images[0], made.source_keypoints, made.driving_keypoints)
    assert torch.equal(again.image, made.synthesis.image)
    assert torch.equal(flow.sampling_grid, made.flow.sampling_grid)


@pytest.mark.parametrize(
    "change", [{}, {"warp": "affine"}, {"background": "affine"}], ids=["tps", "mraa", "background"]
)
def test_one_step_reaches_every_parameter(config, images, change):
    model = MotionDecoupler(replace(config, **change))
    losses = losses_of(model, images, match_warped=True)
    losses.total(background=1.0, warped=1.0).backward()
    still = [
        n for n, p in model.named_parameters() if p.grad is None or not p.grad.isfinite().all()
    ]
    assert still == []
    if change.get("background"):
        assert losses.background < 1e-6  # it starts as the identity, forth and back


def test_the_loss_falls_on_one_pair(decoupler, images):
    optimizer = torch.optim.Adam(decoupler.parameters(), 3e-3)
    bend, history = random_tps(2), []
    for _ in range(8):
        loss = decoupling_losses(decoupler, *images, FEATURES, bend).total()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        history.append(float(loss.detach()))
    assert history[-1] < 0.95 * history[0]


def test_terms_are_named_after_what_they_compare(decoupler, images):
    decoupler.eval()
    losses = losses_of(decoupler, images, match_warped=True)
    made = decoupler(*images)
    pairs = {"perceptual": made.synthesis.image, "warped": made.synthesis.warped}
    for name, picture in pairs.items():
        maps = zip(FEATURES(images[1]), FEATURES(picture), strict=True)
        expected = sum((a - b).abs().mean() for a, b in maps)
        torch.testing.assert_close(getattr(losses, name), expected)
    assert losses_of(decoupler, images).warped == 0
    assert losses.background == 0


def test_matching_features_trains_the_flow_only(decoupler, images):
    """Encoder, painter and masks are held [MDD Eq. B8; authors' code]."""
    losses_of(decoupler, images).warp.backward()
    trained = {name for name, p in decoupler.named_parameters() if p.grad is not None}
    assert {name.split(".")[0] for name in trained} == {"keypoints", "flow"}
    assert not {name for name in trained if name.startswith(("flow.masks", "flow.enlarge"))}
    assert decoupler.keypoints.encoder.fc.weight.grad.abs().sum() > 0


def test_places_can_count_more(decoupler, images):
    decoupler.eval()
    plain, double = (
        losses_of(decoupler, images, weight=weight)
        for weight in (None, torch.full((2, 1, 32, 32), 2.0))
    )
    torch.testing.assert_close(double.perceptual, 2 * plain.perceptual)


def test_the_total_is_the_plain_sum_of_three():
    """[MDD Eq. B9]"""
    losses = DecouplingLosses(*(torch.tensor(float(2**k)) for k in range(6)))
    assert losses.total() == 1 + 2 + 4
    weights = {"perceptual": 10, "equivariance": 10, "warp": 10, "background": 10, "warped": 1}
    weights = {name: float(weight) for name, weight in weights.items()} | {"labelled": 2.0}
    assert losses.total(**weights) == 10 * (1 + 2 + 4 + 8) + 16 + 2 * 32


def test_only_places_that_somebody_knows_are_labels(decoupler, images):
    made = decoupler.eval()(*images).driving_keypoints.detach()
    labels = made + 0.25
    labels[0, 1:] = torch.nan
    assert label_error(made, labels) == pytest.approx(0.25)
    losses = losses_of(decoupler, images, labels=labels)
    assert float(losses.labelled.detach()) == pytest.approx(0.25)
    assert label_error(made, None) == label_error(made, torch.full_like(made, torch.nan)) == 0


def test_a_predictor_that_follows_every_bend_loses_nothing(decoupler):
    """The direction of Eq. B7: the same bend turned round would cost 0.3."""
    decoupler.keypoints = Centroid()
    images = spot(), spot()
    cost = decoupling_losses(decoupler, *images, FEATURES, shift_by(0.2, -0.1)).equivariance
    assert cost < 0.01


def test_a_predictor_that_ignores_a_shift_pays_for_it(decoupler, images):
    decoupler.keypoints.start_at(torch.zeros(3, 5, 2))
    nn.init.zeros_(decoupler.keypoints.encoder.fc.weight)
    cost = decoupling_losses(decoupler, *images, FEATURES, shift_by(0.2, -0.1)).equivariance
    assert float(cost.detach()) == pytest.approx(0.15, abs=1e-5)


def test_a_checkpoint_brings_back_the_model(decoupler, images, tmp_path):
    decoupler(*images)  # moves the batch norms' statistics
    save_checkpoint(tmp_path / "model.safetensors", decoupler.eval(), decoupler.config)
    loaded = load_checkpoint(tmp_path / "model.safetensors", MotionDecoupler)
    with torch.no_grad():
        assert torch.equal(loaded(*images).synthesis.image, decoupler(*images).synthesis.image)
