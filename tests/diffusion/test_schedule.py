import pytest
import torch
from diffusers import DDPMScheduler
from hypothesis import given
from hypothesis import strategies as st

from s2glib.diffusion import NoiseSchedule

MAKERS = {
    "linear": NoiseSchedule.linear,
    "scaled_linear": NoiseSchedule.scaled_linear,
    "squaredcos_cap_v2": NoiseSchedule.cosine,
}
every_kind = pytest.mark.parametrize("kind", MAKERS)


@every_kind
def test_the_schedules_are_those_of_diffusers(kind):
    ours = MAKERS[kind](1000)
    peer = DDPMScheduler(1000, beta_start=ours.betas[0].item(), beta_end=ours.betas[-1].item())
    if kind != "linear":
        peer = DDPMScheduler(1000, 0.00085, 0.012, beta_schedule=kind)
    torch.testing.assert_close(ours.betas.float(), peer.betas, rtol=2e-6, atol=1e-7)
    torch.testing.assert_close(ours.alpha_bars.float(), peer.alphas_cumprod, rtol=1e-4, atol=1e-8)


@every_kind
@given(levels=st.integers(1, 400))
def test_signal_only_ever_fades(kind, levels):
    schedule = MAKERS[kind](levels)
    assert schedule.levels == levels
    assert schedule.alpha_bars.dtype == torch.float64
    assert (schedule.alpha_bars < schedule.alpha_bars_before).all()
    assert (schedule.alpha_bars > 0).all()
    assert schedule.alpha_bars_before[0] == 1


def test_level_zero_is_already_noisy():
    schedule = NoiseSchedule.linear(1000)
    assert schedule.alpha_bars[0] == schedule.alphas[0] == 1 - 1e-4


def test_each_schedule_gets_its_ends_right():
    linear, scaled = NoiseSchedule.linear(7, 0.1, 0.3), NoiseSchedule.scaled_linear(7, 0.1, 0.3)
    for schedule in (linear, scaled):
        torch.testing.assert_close(schedule.betas[[0, -1]], torch.tensor([0.1, 0.3]).double())
    assert scaled.betas[3] < linear.betas[3]
    assert NoiseSchedule.cosine(50).betas.max() == 0.999


def test_fifty_levels_of_the_linear_schedule_never_reach_noise():
    assert NoiseSchedule.linear(1000).alpha_bars[-1] < 1e-4
    assert NoiseSchedule.linear(50).alpha_bars[-1] == pytest.approx(0.60, abs=0.01)


@pytest.mark.parametrize("levels", [0, -1])
@every_kind
def test_a_schedule_without_levels_is_refused(kind, levels):
    with pytest.raises(ValueError, match=r"level|betas"):
        MAKERS[kind](levels)


@pytest.mark.parametrize("ends", [(0.0, 0.1), (0.1, 1.0), (-0.1, 0.1), (float("nan"), 0.1)])
def test_betas_outside_zero_to_one_are_refused(ends):
    with pytest.raises(ValueError, match="strictly between 0 and 1"):
        NoiseSchedule.linear(10, *ends)


@pytest.mark.parametrize("betas", [torch.tensor([0.1]), torch.empty(0, dtype=torch.float64)])
def test_betas_must_be_some_float64(betas):
    with pytest.raises(ValueError, match="float64"):
        NoiseSchedule(betas)


def test_a_schedule_built_under_the_meta_device_holds_numbers():
    with torch.device("meta"):
        schedule = NoiseSchedule.cosine(10)
    assert schedule.alpha_bars.device.type == "cpu"
