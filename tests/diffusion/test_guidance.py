import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.diffusion import (
    NoiseSchedule,
    from_noise_prediction,
    guided,
    sample_ddim,
    timesteps,
    x0_from_noise,
)

scales = st.floats(-3, 9)
XT = torch.linspace(-1, 1, 5, dtype=torch.float64)


def denoise(xt, t, condition):
    """A denoiser that listens to three conditions, each in a way of its own."""
    content, emotion, style = condition
    return xt * content + t * emotion + (xt + emotion).sin() * style


def test_scale_one_is_the_condition_and_scale_zero_its_absence():
    condition, null = (1.0, 2.0, 3.0), (1.0, 0.0, 3.0)
    assert torch.equal(guided(denoise, condition, null, 1.0)(XT, 7), denoise(XT, 7, condition))
    assert torch.equal(guided(denoise, condition, null, 0.0)(XT, 7), denoise(XT, 7, null))


@given(scale=scales)
def test_guidance_walks_on_along_the_line_from_null_to_condition(scale):
    condition, null = (1.0, 2.0, 3.0), (0.0, 0.0, 0.0)
    base, full = denoise(XT, 7, null), denoise(XT, 7, condition)
    ours = guided(denoise, condition, null, scale)(XT, 7)
    torch.testing.assert_close(ours, base + scale * (full - base))


@given(scale=scales)
def test_the_parts_that_null_shares_are_not_exaggerated(scale):
    """AMUSE guides on emotion alone: a denoiser deaf to emotion is left as it is."""

    def deaf(xt, t, condition):
        return denoise(xt, t, (condition[0], 0.0, condition[2]))

    ours = guided(deaf, (1.0, 2.0, 3.0), (1.0, -1.0, 3.0), scale)(XT, 7)
    torch.testing.assert_close(ours, denoise(XT, 7, (1.0, 0.0, 3.0)))


@given(scale=scales)
def test_guiding_the_noise_is_guiding_the_clean_data(scale):
    schedule, condition, null = NoiseSchedule.cosine(20), (1.0, 2.0, 3.0), (1.0, 0.0, 3.0)
    on_x0 = guided(from_noise_prediction(denoise, schedule), condition, null, scale)(XT, 7)
    on_noise = guided(denoise, condition, null, scale)(XT, 7)
    torch.testing.assert_close(on_x0, x0_from_noise(schedule, XT, on_noise, 7))


def test_a_guided_denoiser_goes_into_a_sampler():
    def constant(xt, t, level):
        return torch.full_like(xt, level)

    walk = sample_ddim(
        guided(constant, 1.0, 0.0, 2.5), XT, NoiseSchedule.cosine(20), timesteps=timesteps(20, 4)
    )
    assert torch.equal([*walk][-1], torch.full_like(XT, 2.5))
