"""Linear blend skinning of a body of SMPL-X's size, ours against smplx's in one run.

Run: python -m pytest benchmarks/bench_skinning.py
"""

from time import process_time

import jaxtyping
import numpy as np
import pytest
import torch
from smplx.lbs import lbs

from s2glib.body import PARENTS, axis_angle_to_matrix, linear_blend_skinning, load_smplx

VERTICES = 10475
FRAMES = {"one pose": 1, "a second at 30 fps": 30}
TOLERANCE = {torch.float32: 1e-5, torch.float64: 1e-8}


@pytest.fixture(autouse=True)
def without_type_hook():
    """Time what a reader runs: pytest's shape checks are off."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.fixture(scope="module")
def arrays():
    """Random numbers in the layout of the smaller SMPL-X release."""
    rng = np.random.default_rng(0)
    regressor = rng.random((55, VERTICES), np.float32)
    weights = rng.random((VERTICES, 55), np.float32) ** 8
    return {
        "v_template": rng.standard_normal((VERTICES, 3), np.float32),
        "f": rng.integers(0, VERTICES, (20908, 3)),
        "weights": weights / weights.sum(axis=1, keepdims=True),
        "J_regressor": regressor / regressor.sum(axis=1, keepdims=True),
        "shapedirs": rng.standard_normal((VERTICES, 3, 20), np.float32) / 50,
        "posedirs": rng.standard_normal((VERTICES, 3, 486), np.float32) / 50,
        "kintree_table": np.array([PARENTS, range(55)]),
    }


@pytest.fixture(scope="module")
def body(arrays, tmp_path_factory):
    path = tmp_path_factory.mktemp("smplx") / "SMPLX_NEUTRAL.npz"
    np.savez(path, **arrays)
    return load_smplx(path)


def seconds(function):
    start = process_time()
    function()
    return process_time() - start


@pytest.mark.parametrize("dtype", TOLERANCE, ids=str)
@pytest.mark.parametrize("frames", FRAMES.values(), ids=FRAMES)
def test_skinning_is_never_slower_than_smplx(benchmark, arrays, body, frames, dtype, capsys):
    generator = torch.Generator().manual_seed(1)
    rotations = axis_angle_to_matrix(
        torch.randn(frames, 55, 3, generator=generator, dtype=torch.float64)
    ).to(dtype)
    betas = torch.randn(10, generator=generator, dtype=dtype)  # one person
    expression = torch.randn(frames, 10, generator=generator, dtype=dtype)
    coefficients = torch.cat([betas.expand(frames, 10), expression], dim=-1)
    still, ours_body = torch.zeros(frames, 3, dtype=dtype), body.to(dtype)
    peer = {key: torch.tensor(arrays[key], dtype=dtype) for key in arrays if key != "f"}
    pose_directions = peer["posedirs"].flatten(0, 1).T.contiguous()
    parents = torch.tensor(PARENTS)

    def ours():
        return linear_blend_skinning(
            ours_body, rotations, still, betas=betas, expression=expression
        )

    def theirs():
        return lbs(
            *(coefficients, rotations, peer["v_template"], peer["shapedirs"], pose_directions),
            *(peer["J_regressor"], parents, peer["weights"]),
            pose2rot=False,
        )

    for mine, its in zip(ours(), theirs(), strict=True):
        assert (mine - its).norm() / its.norm() < TOLERANCE[dtype]
    pairs = [(seconds(ours), seconds(theirs)) for _ in range(25)]
    fastest_of_ours, fastest_of_theirs = map(min, zip(*pairs, strict=True))
    ratio = fastest_of_theirs / fastest_of_ours
    with capsys.disabled():
        print(f"\n{frames} frames, {dtype}: smplx / ours = {ratio:.2f}")
    benchmark.extra_info["smplx / ours"] = ratio
    benchmark.pedantic(ours, rounds=3)
    assert fastest_of_ours <= fastest_of_theirs
