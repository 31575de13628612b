from collections import deque

import pytest
import torch
from diffusers import DDIMScheduler, DDPMScheduler
from hypothesis import given
from hypothesis import strategies as st

from s2glib.diffusion import NoiseSchedule, posterior, sample_ddim, sample_ddpm, timesteps

SCHEDULE = NoiseSchedule.cosine(1000)
SHORT = NoiseSchedule.linear(20, 0.01, 0.4)
SPACINGS = ("leading", "trailing", "linspace")


def seeded(seed=0):
    return torch.Generator().manual_seed(seed)


def normal(*shape, seed=0):
    return torch.randn(*shape, generator=seeded(seed), dtype=torch.float64)


def last(samples):
    return deque(samples, maxlen=1).pop()


def peer(scheduler_class, schedule, **options):
    scheduler = scheduler_class(schedule.levels, prediction_type="sample", **options)
    scheduler.alphas_cumprod = schedule.alpha_bars
    scheduler.one = scheduler.final_alpha_cumprod = torch.ones((), dtype=torch.float64)
    return scheduler


def curl(xt, t):
    """Some denoiser that depends on x and on the level."""
    return torch.sin(3 * xt + t / 100) * 1.5


@pytest.mark.parametrize("spacing", SPACINGS)
@pytest.mark.parametrize("steps", [2, 3, 10, 30, 50, 64, 999, 1000])
def test_timesteps_are_those_of_diffusers(spacing, steps):
    scheduler = DDIMScheduler(1000, timestep_spacing=spacing)
    scheduler.set_timesteps(steps)
    assert timesteps(1000, steps, spacing) == scheduler.timesteps.tolist()


def test_timesteps_of_the_papers_code():
    assert timesteps(1000, 50, offset=1)[:2] == [981, 961]  # AMUSE
    assert timesteps(1000, 50, "trailing")[-2:] == [39, 19]  # S2G-MDDiffusion
    assert timesteps(1000, 1, "linspace") == [999]


@given(st.integers(1, 300).flatmap(lambda n: st.tuples(st.just(n), st.integers(1, n))))
def test_timesteps_fall_within_the_schedule(levels_and_steps):
    levels, steps = levels_and_steps
    for spacing in SPACINGS:
        chosen = timesteps(levels, steps, spacing)
        assert len(chosen) == len(set(chosen)) == steps
        assert chosen == sorted(chosen, reverse=True)
        assert chosen[0] < levels
        assert chosen[-1] >= 0


@pytest.mark.parametrize(
    "options", [(10, 11), (10, 0), (10, 5, "trailing", 1), (10, 5, "leading", -1)]
)
def test_impossible_timesteps_are_refused(options):
    with pytest.raises(ValueError, match=r"steps must|offset"):
        timesteps(*options)


def test_ancestral_sampling_is_that_of_diffusers():
    scheduler, generator = peer(DDPMScheduler, SHORT, clip_sample=False), seeded(1)
    theirs = normal(1, 6, 2)
    for t in reversed(range(20)):
        theirs = scheduler.step(curl(theirs, t), t, theirs, generator=generator).prev_sample
    ours = last(sample_ddpm(curl, normal(1, 6, 2), SHORT, generator=seeded(1)))
    torch.testing.assert_close(ours, theirs, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("eta", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("clip", [None, 0.8])
@pytest.mark.parametrize("spacing", ["leading", "trailing"])
def test_ddim_is_that_of_diffusers(eta, clip, spacing):
    clipping = {"clip_sample": clip is not None, "clip_sample_range": clip or 0.0}
    scheduler = peer(DDIMScheduler, SCHEDULE, timestep_spacing=spacing, **clipping)
    scheduler.set_timesteps(25)
    theirs, generator = normal(1, 6, 2), seeded(1)
    for t in scheduler.timesteps.tolist():
        theirs = scheduler.step(
            curl(theirs, t), t, theirs, eta, use_clipped_model_output=True, generator=generator
        ).prev_sample
    options = {"timesteps": timesteps(1000, 25, spacing), "eta": eta, "clip": clip}
    ours = last(sample_ddim(curl, normal(1, 6, 2), SCHEDULE, **options, generator=seeded(1)))
    torch.testing.assert_close(ours, theirs, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("eta", [0.0, 1.0])
@pytest.mark.parametrize("spacing", SPACINGS)
def test_a_perfect_denoiser_of_one_point_returns_it_exactly(eta, spacing):
    point, noise = normal(3, 4), normal(3, 4, seed=1)
    visited = timesteps(1000, 7, spacing)
    walk = sample_ddim(lambda xt, t: point, noise, SCHEDULE, timesteps=visited, eta=eta)
    assert torch.equal(last(walk), point)
    assert torch.equal(last(sample_ddpm(lambda xt, t: point, noise, SHORT, generator=None)), point)


def perfect_denoiser(mean, std, schedule):
    """E[x0 | xt] when x0 is normal, in closed form."""

    def denoise(xt, t):
        alpha_bar = schedule.alpha_bars[t]
        gain = std**2 * alpha_bar.sqrt() / (alpha_bar * std**2 + 1 - alpha_bar)
        return mean + gain * (xt - alpha_bar.sqrt() * mean)

    return denoise


def test_a_perfect_denoiser_of_a_gaussian_gives_its_mean_and_spread():
    denoise, noise = perfect_denoiser(2.0, 0.3, SCHEDULE), normal(20_000)
    visited = timesteps(1000, 200, "linspace")
    samples = {
        "ddpm": sample_ddpm(denoise, noise, SCHEDULE, generator=seeded(1)),
        "eta 0": sample_ddim(denoise, noise, SCHEDULE, timesteps=visited),
        "eta 1": sample_ddim(
            denoise, noise, SCHEDULE, timesteps=visited, eta=1.0, generator=seeded(1)
        ),
    }
    for name, walk in samples.items():
        x = last(walk)
        assert x.mean().item() == pytest.approx(2.0, abs=0.01), name
        assert x.std().item() == pytest.approx(0.3, rel=0.05), name


def test_eta_one_through_all_levels_is_ancestral_sampling():
    every_level = timesteps(20, 20)
    ddim = sample_ddim(curl, normal(6), SHORT, timesteps=every_level, eta=1.0, generator=seeded(1))
    ddpm = sample_ddpm(curl, normal(6), SHORT, generator=seeded(1))
    for ours, ancestral in zip(ddim, ddpm, strict=True):
        torch.testing.assert_close(ours, ancestral)


def test_eta_one_adds_the_variance_of_the_posterior():
    flat, still = torch.zeros(40_000, dtype=torch.float64), lambda xt, t: torch.zeros_like(xt)
    step = next(sample_ddim(still, flat, SHORT, timesteps=[12, 11], eta=1.0, generator=seeded()))
    assert step.var().item() == pytest.approx(
        posterior(SHORT, flat, flat, 12).variance.item(), rel=0.03
    )


def test_the_sample_follows_from_the_generator_alone():
    def draw(seed):
        return last(sample_ddpm(curl, normal(6), SHORT, generator=seeded(seed)))

    assert torch.equal(draw(1), draw(1))
    assert not torch.equal(draw(1), draw(2))


def test_samplers_keep_dtype_and_shape_and_carry_no_gradient():
    xt = torch.zeros(2, 3, 4, requires_grad=True)
    for walk in (
        sample_ddpm(curl, xt, SHORT, generator=seeded()),
        sample_ddim(curl, xt, SHORT, timesteps=timesteps(20, 5), eta=1.0, generator=seeded()),
    ):
        x = last(walk)
        assert (x.dtype, x.shape, x.requires_grad) == (torch.float32, xt.shape, False)


@pytest.mark.parametrize("visited", [[], [3, 3], [3, 5], [20, 3], [3, -1]])
def test_ddim_refuses_levels_that_do_not_fall_within_the_schedule(visited):
    with pytest.raises(ValueError, match="fall strictly"):
        next(sample_ddim(curl, normal(6), SHORT, timesteps=visited))


@pytest.mark.parametrize(
    "option", [{"eta": -0.1}, {"eta": 1.1}, {"eta": float("nan")}, {"clip": 0.0}, {"clip": -1.0}]
)
def test_ddim_refuses_other_options(option):
    with pytest.raises(ValueError, match=next(iter(option))):
        next(sample_ddim(curl, normal(6), SHORT, timesteps=[3], **option))
