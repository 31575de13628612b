"""K = 20 splines through N = 5 keypoints, fitted and laid out on a grid, against loops over them.

Run: python -m pytest benchmarks/bench_tps.py
"""

from time import process_time

import jaxtyping
import pytest
import torch
from scipy.interpolate import RBFInterpolator

from s2glib.warping import coordinate_grid, fit_tps, tps_grid

K, N = 20, 5
SIZES = {"64 px": 64, "256 px": 256}


@pytest.fixture(autouse=True)
def without_type_hook():
    """Time what a reader runs: pytest's shape checks are off."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.fixture
def keypoints():
    generator = torch.Generator().manual_seed(0)
    driving, source = 2 * torch.rand(2, K, N, 2, generator=generator, dtype=torch.float64) - 1
    return driving.requires_grad_(), source.requires_grad_()


def ours(driving, source, size):
    return tps_grid(fit_tps(driving, source), size, size)


def plain_loop(driving, source, size):
    """[MDD A5, A2] written down for one pair of frames after the other."""
    points = coordinate_grid(size, size, dtype=torch.float64).flatten(0, 1)

    def basis(a, b):
        squared = (a[:, None] - b[None]).square().sum(-1)
        return squared * torch.where(squared > 0, squared, 1.0).log()

    grids = []
    for p, q in zip(driving, source, strict=True):
        P = torch.cat([torch.ones(N, 1), p], dim=1)
        zeros = torch.zeros(3, 3, dtype=torch.float64)
        L = torch.cat([torch.cat([basis(p, p), P], 1), torch.cat([P.T, zeros], 1)])
        weights, A = torch.linalg.solve(L, torch.cat([q, zeros[:, :2]])).split([N, 3])
        grids.append(basis(points, p) @ weights + A[0] + points @ A[1:])
    return torch.stack(grids).view(K, size, size, 2)


def with_scipy(driving, source, size):
    points = coordinate_grid(size, size, dtype=torch.float64).flatten(0, 1).numpy()
    pairs = zip(driving.detach().numpy(), source.detach().numpy(), strict=True)
    splines = (RBFInterpolator(p, q, kernel="thin_plate_spline", degree=1) for p, q in pairs)
    return torch.stack([torch.from_numpy(spline(points)) for spline in splines]).view(
        K, size, size, 2
    )


def forward(function):
    """The function without a record for gradients."""
    return torch.no_grad()(function)


def backward(function):
    """The function followed by its gradient with respect to all keypoints."""

    def forward_and_backward(driving, source, size):
        return torch.cat(
            torch.autograd.grad(function(driving, source, size).square().mean(), (driving, source))
        )

    return forward_and_backward


def seconds(function, *args):
    start = process_time()
    function(*args)
    return process_time() - start


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES)
@pytest.mark.parametrize(
    ("mine", "peer"),
    [
        (forward(ours), forward(plain_loop)),
        (forward(ours), with_scipy),
        (backward(ours), backward(plain_loop)),
    ],
    ids=["torch loop, forward", "scipy, forward", "torch loop, forward and backward"],
)
def test_the_grid_of_many_splines_is_never_slower(benchmark, keypoints, mine, peer, size, capsys):
    arguments = (*keypoints, size)
    found, wanted = mine(*arguments), peer(*arguments)
    assert (found - wanted).norm() / wanted.norm() < 1e-8
    pairs = [(seconds(mine, *arguments), seconds(peer, *arguments)) for _ in range(9)]
    fastest_of_ours, fastest_of_theirs = map(min, zip(*pairs, strict=True))
    ratio = fastest_of_theirs / fastest_of_ours
    with capsys.disabled():
        print(f"\n{size} px: ours {1e3 * fastest_of_ours:.1f} ms, peer / ours = {ratio:.2f}")
    benchmark.extra_info["peer / ours"] = ratio
    benchmark.pedantic(mine, arguments, rounds=3)
    assert fastest_of_ours <= fastest_of_theirs
