"""The codebook: a vector becomes the number of its nearest neighbour, and gradients pass through.

Paper:    PT A.1 (vector quantisation, after VQ-VAE)
Notebook: notebooks/05_product_codes.ipynb
"""

from typing import NamedTuple

from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.quantization.doors import require_codes, require_vectors
from s2glib.quantization.moving_average import MovingAverage
from s2glib.quantization.tables import CodeTables, look_up, nearest_codes


class Quantized(NamedTuple):
    """Vectors after quantisation, the codes they became, and the two losses.

    With moving averages the codes follow the encoder by themselves, and `codebook_loss` has no
    gradient: it only says how far they are.
    """

    vectors: Float[Tensor, "*b dim"]
    codes: Int[Tensor, "*codes"]
    codebook_loss: Float[Tensor, ""]
    commitment_loss: Float[Tensor, ""]


def straight_through(
    z: Float[Tensor, "*b dim"], nearest: Float[Tensor, "*b dim"]
) -> Float[Tensor, "*b dim"]:
    """Forward the nearest vectors, backward the identity: rounding has no gradient of its own."""
    return z + (nearest - z).detach()


class Codebook(nn.Module):
    """One table of `codes` vectors.

    Args:
        codes: how many there are.
        dim: channels of a vector.
        ema: let the codes be running means of what chose them; None: they are parameters, trained
            by `codebook_loss`.
    """

    def __init__(self, codes: int, dim: int, *, ema: MovingAverage | None = None):
        super().__init__()
        self.dim = dim
        self.tables = CodeTables(1, codes, dim, ema)

    @property
    def vectors(self) -> Float[Tensor, "codes dim"]:
        """The vector that each code stands for."""
        return self.tables.vectors[0]

    def encode(self, z: Float[Tensor, "*b dim"]) -> Int[Tensor, "*b"]:
        """The codes of the nearest vectors.

        Raises:
            TypeError: if `z` is no floating-point tensor.
            ValueError: if it has not `dim` channels, is empty, or holds NaN or Inf.
        """
        require_vectors(z, self.dim)
        return nearest_codes(z[..., None, :], self.tables.vectors)[..., 0]

    def decode(self, codes: Int[Tensor, "*b"]) -> Float[Tensor, "*b dim"]:
        """The vectors that codes stand for.

        Raises:
            TypeError: if `codes` is no tensor of integers.
            ValueError: if a code is not in the book.
        """
        require_codes(codes, len(self.vectors))
        return look_up(self.tables.vectors, codes[..., None])[..., 0, :]

    def forward(self, z: Float[Tensor, "*b dim"]) -> Quantized:
        """Quantise; in training, running means take in the batch afterwards."""
        codes = self.encode(z)
        nearest = self.decode(codes).to(z.dtype)
        self.tables.learn(z[..., None, :], codes[..., None])
        return Quantized(
            vectors=straight_through(z, nearest),
            codes=codes,
            codebook_loss=F.mse_loss(nearest, z.detach()),  # moves codes towards encoder outputs
            commitment_loss=F.mse_loss(z, nearest.detach()),  # moves encoder outputs towards codes
        )
