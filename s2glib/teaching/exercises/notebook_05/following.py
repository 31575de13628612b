"""Exercise 05-3: what chose each code, counted and summed, the past fading.

Paper:    PT A.1 (moving averages: authors' code)
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor

from s2glib.quantization import ClusterTotals, running_totals
from s2glib.teaching.exercises.exercise import Exercise, Mutant


def batch_inputs(
    rng: np.random.Generator,
) -> Iterator[tuple[ClusterTotals, Tensor, Tensor, float]]:
    """Three vectors of which two choose the same code, and any batch."""
    before = ClusterTotals(torch.tensor([4.0, 1.0]), torch.tensor([[4.0], [10.0]]))
    yield before, torch.tensor([[2.0], [4.0], [8.0]]), torch.tensor([0, 0, 1]), 0.5
    sizes, sums = torch.tensor(rng.uniform(1, 9, 4)), torch.tensor(rng.normal(size=(4, 3)))
    z, codes = torch.tensor(rng.normal(size=(10, 3))), torch.tensor(rng.integers(4, size=10))
    yield ClusterTotals(sizes, sums), z, codes, 0.9


def batch_oracle(totals: ClusterTotals, z: Tensor, codes: Tensor, decay: float) -> ClusterTotals:
    """One vector after the other."""
    sizes, sums = (decay * total.numpy() for total in totals)
    for vector, code in zip(z.numpy(), codes.tolist(), strict=True):
        sizes[code] += 1 - decay
        sums[code] += (1 - decay) * vector
    return ClusterTotals(torch.from_numpy(sizes), torch.from_numpy(sums))


def _of_batch(totals: ClusterTotals, z: Tensor, codes: Tensor) -> ClusterTotals:
    return running_totals(totals, z, codes, 0)


def last_only(totals: ClusterTotals, z: Tensor, codes: Tensor, decay: float) -> ClusterTotals:
    """Where several vectors choose a code, an index with += keeps the last one."""
    sizes, sums = torch.zeros_like(totals.sizes), torch.zeros_like(totals.sums)
    sizes[codes] += 1
    sums[codes] += z
    return ClusterTotals(
        decay * totals.sizes + (1 - decay) * sizes, decay * totals.sums + (1 - decay) * sums
    )


def nothing_fades(totals: ClusterTotals, z: Tensor, codes: Tensor, decay: float) -> ClusterTotals:
    """The batch is added to the whole past."""
    sizes, sums = _of_batch(totals, z, codes)
    return ClusterTotals(totals.sizes + sizes, totals.sums + sums)


def other_way_round(totals: ClusterTotals, z: Tensor, codes: Tensor, decay: float) -> ClusterTotals:
    """The batch is kept and the past fades quickly."""
    return running_totals(totals, z, codes, 1 - decay)


def undamped(totals: ClusterTotals, z: Tensor, codes: Tensor, decay: float) -> ClusterTotals:
    """The past fades, but the batch is added whole."""
    sizes, sums = _of_batch(totals, z, codes)
    return ClusterTotals(decay * totals.sizes + sizes, decay * totals.sums + sums)


def means(totals: ClusterTotals, z: Tensor, codes: Tensor, decay: float) -> ClusterTotals:
    """The batch's means stand where its sums should."""
    sizes, sums = _of_batch(totals, z, codes)
    mean = sums / sizes.clamp_min(1)[:, None]
    return ClusterTotals(
        decay * totals.sizes + (1 - decay) * sizes, decay * totals.sums + (1 - decay) * mean
    )


FOLLOW = Exercise(
    id="05-3",
    title="let the past fade",
    reference=running_totals,
    inputs=batch_inputs,
    oracle=batch_oracle,
    minutes=12,
    difficulty=3,
    equation="PT A.1",
    mutants=(
        Mutant(
            last_only,
            "Where several vectors choose one code you keep only the last: `sums[codes] += z` "
            "does not add them up.",
        ),
        Mutant(nothing_fades, "Your past does not fade: multiply it by decay."),
        Mutant(
            other_way_round,
            "You have swapped the shares: decay belongs to the past, 1 - decay to the batch.",
        ),
        Mutant(undamped, "Your past fades, but the batch must count 1 - decay."),
        Mutant(means, "Your sums take in the batch's means; take its sums, the division is later."),
    ),
    hints=(
        "`chosen = torch.nn.functional.one_hot(codes, len(totals.sizes))` says in its rows which "
        "code each vector chose. Make it `.to(z.dtype)`.",
        "Its columns summed, `chosen.sum(0)`, are the batch's sizes, and `chosen.mT @ z` its sums.",
        "Both totals are `decay * old + (1 - decay) * new`; put them into a "
        "`ClusterTotals(sizes, sums)`.",
    ),
)
