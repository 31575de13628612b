"""Residual quantisation: each stage has a codebook for what the stages before it left over.

Paper:    PT A.1 (the alternative that the authors' code compares; one codebook a stage: ours)
Notebook: notebooks/05_product_codes.ipynb
"""

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.quantization.codebook import Quantized, straight_through
from s2glib.quantization.doors import require_codes, require_vectors
from s2glib.quantization.moving_average import MovingAverage
from s2glib.quantization.tables import CodeTables, look_up, nearest_codes


class ResidualQuantizer(nn.Module):
    """Name a vector by a sum of `stages` codes, coarse to fine.

    Args:
        stages: how many codes a vector becomes.
        codes: how many each stage can choose from.
        dim: channels of a vector, and of every code.
        ema: let the codes be running means of what chose them; None: they are parameters.
    """

    def __init__(self, stages: int, codes: int, dim: int, *, ema: MovingAverage | None = None):
        super().__init__()
        self.dim = dim
        self.tables = CodeTables(stages, codes, dim, ema)

    @property
    def codebooks(self) -> Float[Tensor, "stages codes dim"]:
        """The vector that each code of each stage stands for."""
        return self.tables.vectors

    def encode(self, z: Float[Tensor, "*b dim"]) -> Int[Tensor, "*b stages"]:
        """The codes that the stages choose, one after another.

        Raises:
            TypeError: if `z` is no floating-point tensor.
            ValueError: if it has not `dim` channels, is empty, or holds NaN or Inf.
        """
        return self._walk(z)[1]

    def decode(self, codes: Int[Tensor, "*b stages"]) -> Float[Tensor, "*b dim"]:
        """The sum of the vectors that codes stand for.

        Raises:
            TypeError: if `codes` is no tensor of integers.
            ValueError: if there is not one code for each stage, or a code is in no codebook.
        """
        return self.partial_sums(codes)[..., -1, :]

    def partial_sums(self, codes: Int[Tensor, "*b stages"]) -> Float[Tensor, "*b stages dim"]:
        """What is known after each stage; the last is what `decode` gives, which raises alike."""
        stages, num_codes, _ = self.codebooks.shape
        require_codes(codes, num_codes, groups=stages)
        return look_up(self.codebooks, codes).cumsum(-2)

    def forward(self, z: Float[Tensor, "*b dim"]) -> Quantized:
        """Quantise; the losses are means over the stages, each on what it was given."""
        received, codes = self._walk(z)
        chosen = look_up(self.codebooks, codes).to(z.dtype)  # (*b, stages, dim)
        self.tables.learn(received, codes)
        return Quantized(
            vectors=straight_through(z, chosen.sum(-2)),
            codes=codes,
            codebook_loss=F.mse_loss(chosen, received.detach()),
            commitment_loss=F.mse_loss(received, chosen.detach()),
        )

    def _walk(self, z: Tensor) -> tuple[Tensor, Tensor]:
        """What each stage receives (*b, stages, dim), and the code it chooses."""
        require_vectors(z, self.dim)
        rest, received, codes = z, [], []
        for vectors in self.codebooks.detach().split(1):
            received.append(rest)
            codes.append(nearest_codes(rest[..., None, :], vectors))  # (*b, 1)
            rest = rest - look_up(vectors, codes[-1])[..., 0, :].to(z.dtype)
        return torch.stack(received, dim=-2), torch.cat(codes, dim=-1)
