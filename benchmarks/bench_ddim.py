"""The DDIM loop against diffusers', both with a denoiser that returns its input.

Run: python -m pytest benchmarks/bench_ddim.py
"""

from collections import deque
from time import process_time

import pytest
import torch
from diffusers import DDIMScheduler

from s2glib.diffusion import NoiseSchedule, sample_ddim, timesteps

SCHEDULE = NoiseSchedule.scaled_linear(1000)
STEPS = 50
SHAPES = {"one latent": (1, 1, 128), "ten seconds": (1, 38, 96), "a batch": (128, 38, 96)}
TOLERANCE = {torch.float32: 1e-5, torch.float64: 1e-8}


def ours(xt):
    visited = timesteps(1000, STEPS)
    return deque(sample_ddim(lambda xt, t: xt, xt, SCHEDULE, timesteps=visited), maxlen=1).pop()


@torch.no_grad()
def theirs(xt, scheduler):
    scheduler.set_timesteps(STEPS)
    for t in scheduler.timesteps.tolist():
        xt = scheduler.step(xt, t, xt, return_dict=False)[0]
    return xt


@pytest.fixture(scope="module")
def scheduler():
    scheduler = DDIMScheduler(1000, prediction_type="sample", clip_sample=False)
    scheduler.alphas_cumprod = SCHEDULE.alpha_bars
    scheduler.final_alpha_cumprod = torch.ones((), dtype=torch.float64)
    return scheduler


def seconds(function, *args):
    start = process_time()
    function(*args)
    return process_time() - start


@pytest.mark.parametrize("dtype", TOLERANCE, ids=str)
@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_ddim_is_never_slower_than_diffusers(benchmark, scheduler, shape, dtype):
    xt = torch.randn(shape, generator=torch.Generator().manual_seed(1), dtype=dtype)
    error = (ours(xt) - theirs(xt, scheduler)).norm() / ours(xt).norm()
    assert error < TOLERANCE[dtype]
    pairs = [(seconds(ours, xt), seconds(theirs, xt, scheduler)) for _ in range(9)]
    fastest_of_ours, fastest_of_theirs = map(min, zip(*pairs, strict=True))
    benchmark.extra_info["diffusers / ours"] = fastest_of_theirs / fastest_of_ours
    benchmark.pedantic(ours, (xt,), rounds=3)
    assert fastest_of_ours <= fastest_of_theirs
