"""Product quantisation: channels in groups, each with a small codebook of its own.

G groups of K codes name K^G vectors with the memory and the search cost of K of them.

Paper:    PT A.1 (G = 4 groups of 128 codes: authors' code)
Notebook: notebooks/05_product_codes.ipynb
"""

from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.quantization.codebook import Quantized, straight_through
from s2glib.quantization.doors import require_codes, require_vectors
from s2glib.quantization.moving_average import MovingAverage
from s2glib.quantization.tables import CodeTables, look_up, nearest_codes


class ProductQuantizer(nn.Module):
    """Cut a vector into contiguous chunks and quantise each with its own codebook.

    Args:
        groups: how many chunks.
        codes: how many codes each codebook has.
        dim: channels of a whole vector.
        ema: let the codes be running means of what chose them; None: they are parameters.

    Raises:
        ValueError: if the channels do not divide into the groups.
    """

    def __init__(self, groups: int, codes: int, dim: int, *, ema: MovingAverage | None = None):
        super().__init__()
        if groups < 1 or dim % groups:
            raise ValueError(
                f"{dim} channels do not divide into {groups} equal groups; choose a divisor"
            )
        self.groups, self.dim = groups, dim
        self.tables = CodeTables(groups, codes, dim // groups, ema)

    @property
    def codebooks(self) -> Float[Tensor, "groups codes chunk"]:
        """The vector that each code of each group stands for."""
        return self.tables.vectors

    def encode(self, z: Float[Tensor, "*b dim"]) -> Int[Tensor, "*b groups"]:
        """The codes of the nearest chunks.

        Raises:
            TypeError: if `z` is no floating-point tensor.
            ValueError: if it has not `dim` channels, is empty, or holds NaN or Inf.
        """
        require_vectors(z, self.dim)
        return nearest_codes(self._chunks(z), self.codebooks)

    def decode(self, codes: Int[Tensor, "*b groups"]) -> Float[Tensor, "*b dim"]:
        """The vectors that codes stand for, chunk after chunk.

        Raises:
            TypeError: if `codes` is no tensor of integers.
            ValueError: if there is not one code for each group, or a code is in no codebook.
        """
        require_codes(codes, self.codebooks.shape[1], groups=self.groups)
        return look_up(self.codebooks, codes).flatten(-2)

    def forward(self, z: Float[Tensor, "*b dim"]) -> Quantized:
        """Quantise; in training, running means take in the batch afterwards."""
        codes = self.encode(z)
        nearest = self.decode(codes).to(z.dtype)
        self.tables.learn(self._chunks(z), codes)
        return Quantized(
            vectors=straight_through(z, nearest),
            codes=codes,
            codebook_loss=F.mse_loss(nearest, z.detach()),
            commitment_loss=F.mse_loss(z, nearest.detach()),
        )

    def _chunks(self, z: Tensor) -> Tensor:
        return z.unflatten(-1, (self.groups, -1))  # (*b, groups, chunk)
