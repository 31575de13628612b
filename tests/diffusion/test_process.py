import numpy as np
import pytest
import torch
from diffusers import DDPMScheduler
from hypothesis import given
from hypothesis import strategies as st

from s2glib.diffusion import (
    NoiseSchedule,
    add_noise,
    from_noise_prediction,
    noise_from_x0,
    posterior,
    x0_from_noise,
)

SCHEDULE = NoiseSchedule.scaled_linear(1000)
every_level = st.integers(0, 999)


def normal(*shape, seed=0, dtype=torch.float64):
    return torch.randn(*shape, generator=torch.Generator().manual_seed(seed), dtype=dtype)


def peer(schedule):
    """DDPMScheduler computing in float64, which it does not offer itself."""
    scheduler = DDPMScheduler(schedule.levels, prediction_type="sample", clip_sample=False)
    scheduler.alphas_cumprod = schedule.alpha_bars
    scheduler.one = torch.ones((), dtype=torch.float64)
    return scheduler


def test_noising_is_that_of_diffusers():
    x0, noise, t = normal(4, 6, 3), normal(4, 6, 3, seed=1), torch.tensor([0, 1, 500, 999])
    ours = add_noise(SCHEDULE, x0, noise, t)
    torch.testing.assert_close(ours, peer(SCHEDULE).add_noise(x0, noise, t), rtol=1e-12, atol=0)


def test_jumping_to_a_level_has_the_moments_of_walking_there():
    """Repeat x -> sqrt(alpha) x + sqrt(1 - alpha) noise  [MDD Eq. B10] on mean and variance."""
    mean, variance = 1.0, 0.0
    for alpha in SCHEDULE.alphas[:300].tolist():
        mean, variance = alpha**0.5 * mean, alpha * variance + 1 - alpha
    one, zero = torch.ones(()).double(), torch.zeros(()).double()
    assert add_noise(SCHEDULE, one, zero, 299).item() == pytest.approx(mean)
    assert add_noise(SCHEDULE, zero, one, 299).item() ** 2 == pytest.approx(variance)


@given(t=every_level)
def test_noise_and_clean_data_are_two_views_of_one_thing(t):
    x0, noise = normal(5), normal(5, seed=1)
    xt = add_noise(SCHEDULE, x0, noise, t)
    torch.testing.assert_close(x0_from_noise(SCHEDULE, xt, noise, t), x0, rtol=1e-9, atol=1e-9)
    torch.testing.assert_close(noise_from_x0(SCHEDULE, xt, x0, t), noise, rtol=1e-9, atol=1e-9)


def moments_by_bayes(x0, xt, t):
    """Integrate q(x_{t-1} | x_0) q(x_t | x_{t-1}) over a grid of x_{t-1}."""
    before, alpha = SCHEDULE.alpha_bars_before[t].item(), SCHEDULE.alphas[t].item()
    x = np.linspace(-8, 8, 400_001)
    log_density = -((x - before**0.5 * x0) ** 2) / (2 * (1 - before))
    log_density -= (xt - alpha**0.5 * x) ** 2 / (2 * (1 - alpha))
    weight = np.exp(log_density - log_density.max())
    mean = np.average(x, weights=weight)
    return mean, np.average((x - mean) ** 2, weights=weight)


@pytest.mark.parametrize("t", [1, 20, 400, 999])
def test_the_posterior_is_bayes_rule(t):
    ours = posterior(SCHEDULE, torch.tensor([0.7]).double(), torch.tensor([-0.4]).double(), t)
    assert (ours.mean.item(), ours.variance.item()) == pytest.approx(
        moments_by_bayes(0.7, -0.4, t), rel=1e-6
    )


def test_the_printed_denominator_is_not_bayes_rule():
    x0, xt = torch.tensor([0.7]).double(), torch.tensor([-0.4]).double()
    printed = posterior(SCHEDULE, x0, xt, 400, denominator="alpha").mean.item()
    assert abs(printed - moments_by_bayes(0.7, -0.4, 400)[0]) > 0.05


def test_the_posterior_is_the_step_of_diffusers():
    x0, xt, scheduler = normal(1, 6, 3), normal(1, 6, 3, seed=1), peer(SCHEDULE)
    for t in (0, 1, 500, 999):
        mean, variance = posterior(SCHEDULE, x0, xt, t)
        step = scheduler.step(x0, t, xt, generator=torch.Generator().manual_seed(2)).prev_sample
        ours = mean + variance.sqrt() * normal(1, 6, 3, seed=2)
        torch.testing.assert_close(ours, step, rtol=1e-10, atol=1e-10)


def test_the_posterior_ends_exactly_on_the_clean_data():
    x0, xt = normal(5), normal(5, seed=1)
    mean, variance = posterior(SCHEDULE, x0, xt, 0)
    assert torch.equal(mean, x0)
    assert variance == 0


@pytest.mark.parametrize("t", [1, 998])
def test_small_variances_survive_float32(t):
    """1 - alpha-bar of a float32 table is off by 5e-4 at the first levels."""
    x0, xt = normal(5), normal(5, seed=1)
    single = posterior(SCHEDULE, x0.float(), xt.float(), t)
    double = posterior(SCHEDULE, x0, xt, t)
    torch.testing.assert_close(single.mean, double.mean.float(), rtol=1e-6, atol=1e-6)
    torch.testing.assert_close(single.variance, double.variance.float(), rtol=1e-6, atol=0)


@pytest.mark.parametrize("dtype", [torch.float16, torch.float32, torch.float64])
@pytest.mark.parametrize("operation", [add_noise, x0_from_noise, noise_from_x0])
def test_the_dtype_is_kept_and_a_level_belongs_to_its_row(operation, dtype):
    x, y, t = normal(2, 3, 4, dtype=dtype), normal(2, 3, 4, seed=1, dtype=dtype), [[7] * 3, [9] * 3]
    together = operation(SCHEDULE, x, y, torch.tensor(t))
    assert together.dtype == dtype
    assert torch.equal(together[0], operation(SCHEDULE, x[0], y[0], 7))
    assert torch.equal(together[1], operation(SCHEDULE, x[1], y[1], torch.tensor(9)))


def test_a_noise_predictor_becomes_a_denoiser_with_conditions():
    x0, noise, t = normal(2, 3), normal(2, 3, seed=1), torch.tensor([3, 800])
    xt = add_noise(SCHEDULE, x0, noise, t)
    denoise = from_noise_prediction(lambda xt, t, gain: gain * noise, SCHEDULE)
    torch.testing.assert_close(denoise(xt, t, 1.0), x0)
    torch.testing.assert_close(denoise(xt, t, 0.0), x0_from_noise(SCHEDULE, xt, 0 * noise, t))


@pytest.mark.parametrize("t", [-1, 1000, torch.tensor([0, 1000]), torch.tensor([-1, 5])])
def test_a_level_outside_the_schedule_is_refused(t):
    for operation in (add_noise, x0_from_noise, noise_from_x0, posterior):
        with pytest.raises(ValueError, match=r"0\.\.999"):
            operation(SCHEDULE, normal(2, 3), normal(2, 3), t)


def test_levels_that_do_not_fit_the_data_are_refused():
    with pytest.raises(ValueError, match="leading axes"):
        add_noise(SCHEDULE, normal(2, 3), normal(2, 3), torch.tensor([1, 2, 3]))


def test_gradients_reach_data_and_noise():
    x, y = normal(2, 3).requires_grad_(), normal(2, 3, seed=1).requires_grad_()
    for operation in (add_noise, x0_from_noise, noise_from_x0, posterior):
        assert torch.autograd.gradcheck(lambda a, b, f=operation: f(SCHEDULE, a, b, 300)[0], (x, y))
