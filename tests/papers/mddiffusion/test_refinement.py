from dataclasses import replace
from itertools import pairwise

import pytest
import torch
from small_video import SMALL_REFINEMENT

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.layers import PyramidFeatures
from s2glib.losses import generator_loss
from s2glib.papers.mddiffusion import (
    PAPER_REFINEMENT,
    TEACHING_REFINEMENT,
    Masks,
    PatchDiscriminator,
    RefinementLosses,
    RefinementNet,
    merge,
    refinement_losses,
)


@pytest.fixture
def visible():
    return torch.rand(2, 1, 32, 32)


def convolution(inputs, outputs, kernel):
    return inputs * outputs * kernel**2 + outputs


def test_the_papers_network_has_eight_steps_down_and_up():
    with torch.device("meta"):
        net = RefinementNet(PAPER_REFINEMENT)
    down = [(4, 64), (64, 128), (128, 256), (256, 512), *[(512, 512)] * 4]
    up = [(512, 512), *[(1024, 512)] * 3, (1024, 256), (512, 128), (256, 64), (128, 64)]
    expected = sum(convolution(*pair, 4) for pair in down) + sum(2 * o for _, o in down[1:-1])
    expected += sum(convolution(*pair, 3) + 2 * pair[1] for pair in up)
    expected += (2 + 2) * 2 * (convolution(64, 64, 3) + 2 * 64) + convolution(64, 3, 7)
    assert sum(p.numel() for p in net.parameters()) == expected


def test_the_papers_picture_shrinks_to_one_place_and_back():
    seen = []
    with torch.device("meta"):
        net = RefinementNet(PAPER_REFINEMENT)
        net.down[-1].register_forward_hook(lambda _, inputs, out: seen.append(out.shape))
        net.small.register_forward_hook(lambda _, inputs, out: seen.append(out.shape))
        net.large.register_forward_hook(lambda _, inputs, out: seen.append(out.shape))
        out = net(torch.zeros(2, 3, 256, 256), torch.zeros(2, 1, 256, 256))
    assert seen == [(2, 512, 1, 1), (2, 64, 128, 128), (2, 64, 256, 256)]
    assert out.shape == (2, 3, 256, 256)


def test_the_papers_discriminator_scores_27_by_27_patches():
    with torch.device("meta"):
        net = PatchDiscriminator(PAPER_REFINEMENT)
        scores = net(torch.zeros(2, 3, 256, 256))
    assert scores.shape == (2, 1, 27, 27)
    widths = (3, 64, 128, 256, 512, 1)
    expected = sum(25 * a * b for a, b in pairwise(widths))
    assert sum(p.numel() for p in net.parameters()) == expected == 4_318_400


def test_a_score_sees_a_patch_and_not_the_picture():
    image = torch.rand(1, 3, 64, 64, requires_grad=True)
    PatchDiscriminator(SMALL_REFINEMENT)(image)[0, 0, 5, 5].backward()
    seen = image.grad[0].abs().sum(0) > 0
    rows = seen.any(dim=1).nonzero()
    assert 20 < int(rows.max() - rows.min()) < 50


def test_the_teaching_checkpoint_stays_below_two_megabytes():
    with torch.device("meta"):
        count = sum(p.numel() for p in RefinementNet(TEACHING_REFINEMENT).parameters())
    assert 2 * count < 2e6


def test_the_text_predicts_a_picture_and_ours_adds_to_one(images, visible):
    torch.manual_seed(0)
    whole = RefinementNet(replace(SMALL_REFINEMENT, adds=False)).eval()
    adding = RefinementNet(SMALL_REFINEMENT).eval()
    adding.load_state_dict(whole.state_dict())
    made, added = whole(images[0], visible), adding(images[0], visible)
    assert made.abs().max() <= 1
    torch.testing.assert_close(added, images[0] + made)


def test_what_is_added_is_nothing_at_first(images, visible):
    assert torch.equal(RefinementNet(SMALL_REFINEMENT)(images[0], visible), images[0])


def test_the_network_is_told_what_was_hidden(images, visible):
    net = RefinementNet(replace(SMALL_REFINEMENT, adds=False)).eval()
    assert not torch.allclose(net(images[0], visible), net(images[0], 1 - visible))


def test_one_step_reaches_every_parameter_of_both(images, visible):
    net, critic = RefinementNet(SMALL_REFINEMENT), PatchDiscriminator(SMALL_REFINEMENT)
    refined = net(images[0], visible)
    masks = Masks(visible, (visible > 0.9).float(), (visible < 0.1).float())
    losses = refinement_losses(refined, images[1], masks, PyramidFeatures(2), critic(refined))
    losses.total().backward()
    for model in (net, critic):
        assert all(p.grad is not None and p.grad.isfinite().all() for p in model.parameters())


def test_terms_look_where_their_names_say(images):
    """One wrong patch in each place; every term sees its own."""
    hidden, hand, face = (torch.zeros(2, 1, 32, 32) for _ in range(3))
    hidden[..., :8, :8] = hand[..., 8:16, 8:16] = face[..., 16:24, 16:24] = 1
    true, scores = images[1], torch.rand(2, 1, 3, 3)
    refined = true + 0.1 * hidden + 0.2 * hand + 0.4 * face
    masks = Masks(1 - hidden, hand, face)
    losses = refinement_losses(refined, true, masks, PyramidFeatures(1), scores)
    seen = [float(loss) for loss in (losses.occluded, losses.hand, losses.face, losses.valid)]
    assert seen == pytest.approx([0.1, 0.2, 0.4, (0.2 + 0.4) * 64 / (32 * 32 - 64)], rel=1e-4)
    assert losses.adversarial == generator_loss(scores)


def test_a_perfect_repair_costs_only_variation_and_the_critic(images, visible):
    masks = Masks(visible, visible, visible)
    losses = refinement_losses(
        images[1], images[1], masks, PyramidFeatures(1), torch.ones(2, 1, 3, 3)
    )
    assert losses.total() == 0.1 * losses.total_variation
    assert losses.total_variation > 0


def test_the_weights_are_the_papers():
    """[MDD B.5]: 1, 3, 5, 5; .05, 120, .1, .1"""
    names = RefinementLosses._fields
    zeros = dict.fromkeys(names, torch.tensor(0.0))
    one = torch.tensor(1.0)
    weights = [float(RefinementLosses(**zeros | {name: one}).total()) for name in names]
    assert weights == pytest.approx([1, 3, 5, 5, 0.05, 120, 0.1, 0.1])


def test_merging_keeps_what_was_visible(images):
    visible = torch.zeros(2, 1, 32, 32)
    visible[..., :16] = 1
    merged = merge(images[0], images[1], visible)
    assert torch.equal(merged[..., :16], images[0][..., :16])
    assert torch.equal(merged[..., 16:], images[1][..., 16:])


@pytest.mark.parametrize("model_class", [RefinementNet, PatchDiscriminator])
def test_a_checkpoint_brings_back_the_model(model_class, images, visible, tmp_path):
    model = model_class(SMALL_REFINEMENT).eval()
    save_checkpoint(tmp_path / "model.safetensors", model, SMALL_REFINEMENT)
    loaded = load_checkpoint(tmp_path / "model.safetensors", model_class)
    inputs = (images[0], visible) if model_class is RefinementNet else (images[0],)
    assert torch.equal(loaded(*inputs), model(*inputs))
