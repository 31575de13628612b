"""Codes that follow the encoder without a gradient: each is a running mean of what chose it.

Paper:    PT A.1 (the rule and its numbers: authors' code, after VQ-VAE)
Notebook: notebooks/05_product_codes.ipynb
"""

from dataclasses import dataclass
from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn


@dataclass(frozen=True)
class MovingAverage:
    """How codes follow the encoder; the defaults are the authors'.

    Attributes:
        decay: share of the past that a batch leaves.
        eps: added to every cluster's size, so that an empty one divides nothing by zero (Laplace).
        bias_correction: start from nothing and divide by 1 - decay^step, as Adam does; else start
            as if one vector had chosen each code already.
        revive_below: codes whose smoothed size falls below this many vectors are dead and begin
            again at a vector of the batch; 0: never.

    Raises:
        ValueError: if `decay` is not in [0, 1), `eps` not positive or `revive_below` negative.
    """

    decay: float | int = 0.99
    eps: float | int = 1e-5
    bias_correction: bool = True
    revive_below: float | int = 1.0

    def __post_init__(self) -> None:
        if not (0 <= self.decay < 1 and self.eps > 0 and self.revive_below >= 0):
            raise ValueError(
                f"expected decay in [0, 1), eps > 0 and revive_below >= 0, got {self}; "
                "the authors' are 0.99, 1e-5 and 1"
            )


class ClusterTotals(NamedTuple):
    """How many vectors chose each code, and the sum of them."""

    sizes: Float[Tensor, "*groups codes"]
    sums: Float[Tensor, "*groups codes dim"]


def running_totals(
    totals: ClusterTotals,
    z: Float[Tensor, "*groups n dim"],
    codes: Int[Tensor, "*groups n"],
    decay: float | int,
) -> ClusterTotals:
    """Totals after one more batch: `decay` times the past, 1 - `decay` times the batch's own.

    Where training runs on several processes, the batch is all of theirs.

    Args:
        totals: of the past.
        z: the vectors of the batch.
        codes: the code that each of them chose.
        decay: share of the past that is left.
    """
    chosen = z.new_zeros(*codes.shape, totals.sizes.shape[-1])  # (*groups, n, codes)
    chosen.scatter_(-1, codes[..., None], 1)  # one-hot
    sizes, sums = _over_processes(chosen.sum(-2)), _over_processes(chosen.mT @ z)
    return ClusterTotals(
        decay * totals.sizes + (1 - decay) * sizes, decay * totals.sums + (1 - decay) * sums
    )


class RunningMeans(nn.Module):
    """How many vectors chose each code, and their sum: both decayed, both in the state dict."""

    sizes: Tensor
    sums: Tensor
    step: Tensor

    def __init__(self, vectors: Float[Tensor, "groups codes dim"], rule: MovingAverage):
        super().__init__()
        self.rule = rule
        start = 0.0 if rule.bias_correction else 1.0
        self.register_buffer("sizes", torch.full_like(vectors[..., 0], start))
        self.register_buffer("sums", start * vectors)
        self.register_buffer("step", torch.zeros((), dtype=torch.int64))

    @torch.no_grad()
    def update(
        self,
        vectors: Float[Tensor, "groups codes dim"],
        z: Float[Tensor, "groups n dim"],
        codes: Int[Tensor, "groups n"],
    ) -> None:
        """Take in a batch and the codes it chose, and move `vectors`, in place."""
        totals = ClusterTotals(self.sizes, self.sums)
        sizes, sums = running_totals(totals, z, codes, self.rule.decay)
        self.step += 1
        self.sizes.copy_(sizes)
        self.sums.copy_(sums)
        smoothed = self.smoothed_sizes()
        vectors.copy_(sums / self._weight() / smoothed[..., None])
        self._revive(vectors, z, smoothed < self.rule.revive_below)

    def smoothed_sizes(self) -> Float[Tensor, "groups codes"]:
        """Vectors per batch that chose each code, none of them 0; the total is kept."""
        sizes, eps = self.sizes / self._weight(), self.rule.eps
        total = sizes.sum(-1, keepdim=True)
        return (sizes + eps) / (total + eps * sizes.shape[-1]) * total

    def _weight(self) -> Tensor | float:
        """How much of a whole average the decayed sums hold by now."""
        return 1 - self.rule.decay ** self.step.double() if self.rule.bias_correction else 1.0

    def _revive(self, vectors: Tensor, z: Tensor, dead: Tensor) -> None:
        """Let dead codes begin again at vectors spread evenly over the batch.

        The authors take the first rows, which are neighbours in time. Where the batch has fewer
        rows than there are codes, some begin as twins; the one that is never chosen dies again.
        """
        rows = torch.arange(vectors.shape[1], device=z.device) * z.shape[1] // vectors.shape[1]
        fresh = _from_the_first_process(z[:, rows].contiguous())
        vectors.copy_(torch.where(dead[..., None], fresh, vectors))
        self.sums.copy_(torch.where(dead[..., None], fresh, self.sums))
        self.sizes.masked_fill_(dead, 1)


def _over_processes(total: Tensor) -> Tensor:
    """The sum over all processes, where training runs on several."""
    if torch.distributed.is_available() and torch.distributed.is_initialized():
        torch.distributed.all_reduce(total)
    return total


def _from_the_first_process(values: Tensor) -> Tensor:
    if torch.distributed.is_available() and torch.distributed.is_initialized():
        torch.distributed.broadcast(values, src=0)
    return values
