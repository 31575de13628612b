"""Tables of codes side by side: each part of a vector is looked up in a table of its own.

A codebook has one table, a product quantiser one for each group of channels, a residual quantiser
one for each stage. The search over all of them is one product of matrices.

Paper:    PT A.1
Notebook: notebooks/05_product_codes.ipynb
"""

import torch
from einops import rearrange
from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.quantization.moving_average import MovingAverage, RunningMeans


def nearest_codes(
    z: Float[Tensor, "*b groups dim"], vectors: Float[Tensor, "groups codes dim"]
) -> Int[Tensor, "*b groups"]:
    """The code of the nearest vector in each part's own table, by squared distance.

    Raises:
        ValueError: if `z` holds NaN or Inf.
    """
    parts = rearrange(z.detach().to(vectors.dtype), "... groups dim -> groups (...) dim")
    lengths = vectors.detach().square().sum(-1)[:, None]  # (groups, 1, codes)
    # |z - e|^2 = |z|^2 - 2 z e + |e|^2, and |z|^2 is the same for every code
    distances, codes = torch.baddbmm(lengths, parts, vectors.detach().mT, alpha=-2).min(-1)
    if distances.device.type != "meta" and not distances.isfinite().all():
        raise ValueError(
            "the vectors to quantise hold NaN or infinite values; look at the encoder's "
            "learning rate, or drop such inputs"
        )
    return codes.transpose(0, 1).reshape(z.shape[:-1])


def look_up(
    vectors: Float[Tensor, "groups codes dim"], codes: Int[Tensor, "*b groups"]
) -> Float[Tensor, "*b groups dim"]:
    """The vector that each code stands for in its own table."""
    groups, count, _ = vectors.shape
    begins = count * torch.arange(groups, device=codes.device)  # of each table, all in one list
    return F.embedding(codes + begins, vectors.flatten(0, 1))


class CodeTables(nn.Module):
    """`groups` tables of `codes` vectors of `dim` numbers: a parameter, or running means.

    Raises:
        ValueError: if one of the sizes is not positive.
    """

    vectors: Tensor

    def __init__(self, groups: int, codes: int, dim: int, ema: MovingAverage | None):
        super().__init__()
        if min(groups, codes, dim) < 1:
            raise ValueError(
                f"tables need at least one group, code and channel, got {groups}, {codes} and {dim}"
            )
        bound = (6 / (codes + dim)) ** 0.5  # Xavier, as the authors' code
        start = torch.empty(groups, codes, dim).uniform_(-bound, bound)
        if ema is None:
            self.vectors = nn.Parameter(start)
            self.means = None
        else:
            self.register_buffer("vectors", start)
            self.means = RunningMeans(start, ema)

    def learn(self, z: Float[Tensor, "*b groups dim"], codes: Int[Tensor, "*b groups"]) -> None:
        """In training, let running means take in what has chosen them."""
        if self.training and self.means is not None:
            parts = rearrange(z.detach(), "... groups dim -> groups (...) dim")
            chosen = rearrange(codes, "... groups -> groups (...)")
            self.means.update(self.vectors, parts.to(self.vectors.dtype), chosen)
