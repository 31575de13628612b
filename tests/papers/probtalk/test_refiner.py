"""The Refiner: it copies what is known, learns the rest, and has the paper's size."""

from dataclasses import replace

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.papers.probtalk.config import PAPER_REFINER, TEACHING_REFINER
from s2glib.papers.probtalk.refiner import Refiner, fill, refiner_losses

SMALL = replace(
    TEACHING_REFINER, width=16, heads=2, layers=1, hidden=16, style=4, head=16, speech=5
)
FRAMES = 24


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


def parameters(model):
    return sum(p.numel() for p in model.parameters())


def batch(config, count=2, frames=FRAMES):
    motion, made = torch.randn(2, count, frames, 276 + config.expression)
    known = torch.rand(count, frames, config.context_parts) < 0.3
    return motion, made, torch.randn(count, frames, config.speech), known, torch.arange(count)


def moving(config):
    """A refiner that was not trained, but changes what it gets."""
    refiner = Refiner(config).eval()
    torch.nn.init.normal_(refiner.head[-1].bias)
    return refiner


def test_the_papers_refiner_has_the_papers_size():
    with torch.device("meta"):
        refiner = Refiner(PAPER_REFINER)
        motion, _, speech, known, speaker = batch(PAPER_REFINER)
        refined = refiner(motion, speech, known, speaker)
    assert parameters(refiner) == 36_180_344
    assert refined.shape == (2, FRAMES, 376)


def test_the_code_s_style_norm_adds_its_gates_and_layer_norms():
    with torch.device("meta"):
        gated = Refiner(replace(PAPER_REFINER, style_norm="adaln"))
    assert parameters(gated) - 36_180_344 == 6 * 3 * (512 * 512 + 512 + 2 * 512)


def test_the_small_refiner_fits_its_budget():
    assert parameters(Refiner(TEACHING_REFINER)) <= 1_250_000


@pytest.mark.parametrize("parts", [1, 4])  # columns that the network sees
def test_what_is_known_comes_out_bit_for_bit(parts):
    config = replace(SMALL, context_parts=parts)
    refiner = moving(config)
    given_motion, made, speech, mask, speaker = batch(config)
    refined = refiner.refine(given_motion, made, speech, mask, speaker)
    known = refiner.known(mask)
    assert torch.equal(refined[known], given_motion[known])
    assert not torch.isclose(refined[~known], made[~known]).any()


@given(st.integers(0, 2**31))
def test_eq_8_is_the_products_it_is_written_with(number):
    generator = torch.Generator().manual_seed(number)
    motion, made = torch.randn(2, 1, 4, 6, generator=generator)
    known = torch.rand(1, 4, 6, generator=generator) < 0.5
    I = known.float()  # noqa: E741
    assert torch.equal(fill(motion, made, known), I * motion + (1 - I) * made)


def test_a_refiner_may_begin_where_known_and_made_meet():
    motion, made, _, _, _ = batch(SMALL)
    known = torch.zeros(2, FRAMES, 288, dtype=torch.bool)
    known[:, :8] = True
    jumps = [
        Refiner(replace(SMALL, eased=whether)).meet(motion, made + 3, known).diff(dim=1)[:, 7]
        for whether in (False, True)
    ]
    assert jumps[0].mean() > 2.5
    assert jumps[1].mean().abs() < 0.5


def test_one_that_adds_changes_nothing_before_it_is_trained():
    motion, _, speech, mask, speaker = batch(SMALL)
    assert torch.equal(Refiner(SMALL).eval()(motion, speech, mask, speaker), motion)


@pytest.mark.parametrize("changed", ["speech", "mask", "speaker"])
def test_every_condition_counts(changed):
    refiner = moving(SMALL)
    torch.nn.init.normal_(refiner.head[-1].weight)
    motion, _, speech, mask, speaker = batch(SMALL)
    before = refiner(motion, speech, mask, speaker)
    if changed == "speech":
        speech = speech.flip(1)
    elif changed == "mask":
        mask = ~mask
    else:
        speaker = speaker + 1
    assert not torch.allclose(refiner(motion, speech, mask, speaker), before, atol=1e-4)


def losses_of(refined, motion, known, region):
    return refiner_losses(motion, refined, known, Refiner(SMALL).features, region=region)


@pytest.mark.parametrize("region", ["unknown", "known"])
def test_each_part_is_a_mean_over_the_compared_region(region):
    motion = torch.randn(2, FRAMES, 288)
    known = torch.rand(2, FRAMES, 288) < 0.3
    compared = known if region == "known" else ~known
    losses = losses_of(motion + 0.5 * compared + 9 * ~compared, motion, known, region)
    for part in (losses.jaw, losses.body, losses.hands, losses.expression):
        torch.testing.assert_close(part, torch.tensor(0.5))


def test_velocity_is_compared_everywhere_and_blind_to_an_offset():
    motion = torch.randn(2, FRAMES, 288)
    known = torch.rand(2, FRAMES, 288) < 0.3
    ramp = 0.25 * torch.arange(FRAMES)[None, :, None]
    assert losses_of(motion + 1, motion, known, "unknown").velocity < 1e-6
    torch.testing.assert_close(
        losses_of(motion + ramp, motion, known, "known").velocity, torch.tensor(0.25)
    )


def test_the_parts_together_weigh_as_much_as_the_velocity():
    motion, refined = torch.randn(2, 2, FRAMES, 288)
    losses = losses_of(refined, motion, torch.zeros(2, FRAMES, 288, dtype=torch.bool), "unknown")
    jaw, body, hands, expression, velocity = losses
    torch.testing.assert_close(losses.total(), (jaw + body + hands + expression) / 4 + velocity)


def test_the_texts_region_teaches_the_unknown_frames_no_pose():
    """Eq. 10 as printed: the gradient of the part-wise terms is zero wherever motion is unknown."""
    motion = torch.randn(1, FRAMES, 288)
    known = torch.rand(1, FRAMES, 288) < 0.3
    for region, taught in (("known", known), ("unknown", ~known)):
        refined = torch.randn(1, FRAMES, 288, requires_grad=True)
        losses_of(refined, motion, known, region).total(velocity=0.0).backward()
        assert torch.equal(refined.grad != 0, taught)


def test_a_part_that_is_known_throughout_costs_nothing():
    motion, refined = torch.randn(2, 1, FRAMES, 288)
    known = torch.ones(1, FRAMES, 288, dtype=torch.bool)
    assert losses_of(refined, motion, known, "unknown").total(velocity=0.0) == 0
