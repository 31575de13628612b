import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from vector_quantize_pytorch import ResidualVQ

from s2glib.quantization import Codebook, ResidualQuantizer


def normal(*shape, seed=0):
    return torch.randn(shape, generator=torch.Generator().manual_seed(seed))


def errors(quantizer, z):
    """Distance that is left after each stage, (stages, n)."""
    sums = quantizer.partial_sums(quantizer.encode(z))
    return (z[..., None, :] - sums).norm(dim=-1).T


@given(st.integers(1, 4), st.integers(1, 8), st.integers(0, 99))
def test_no_stage_makes_it_worse_when_each_book_holds_the_zero_vector(stages, codes, seed):
    torch.manual_seed(seed)
    quantizer, z = ResidualQuantizer(stages, codes, 3), normal(20, 3, seed=seed)
    with torch.no_grad():
        quantizer.codebooks[:, 0] = 0
    left = torch.cat([z.norm(dim=-1)[None], errors(quantizer, z)])
    assert (left.diff(dim=0) <= 1e-6).all()


def test_without_the_zero_vector_a_stage_can_make_it_worse():
    torch.manual_seed(0)
    left = errors(ResidualQuantizer(2, 1, 3), normal(20, 3))
    assert (left[1] > left[0]).any()


def test_each_stage_is_a_codebook_for_what_is_left():
    torch.manual_seed(0)
    quantizer, rest = ResidualQuantizer(3, 8, 4), normal(20, 4)
    codes = quantizer.encode(rest)
    for stage in range(3):
        codebook = Codebook(8, 4)
        codebook.tables.vectors.data = quantizer.codebooks.data[stage : stage + 1]
        assert torch.equal(codes[:, stage], codebook.encode(rest))
        rest = rest - codebook.decode(codes[:, stage])


def test_it_agrees_with_vector_quantize_pytorch():
    torch.manual_seed(0)
    ours, z = ResidualQuantizer(3, 16, 8), normal(6, 10, 8).requires_grad_()
    theirs = ResidualVQ(
        dim=8,
        num_quantizers=3,
        codebook_size=16,
        learnable_codebook=True,
        ema_update=False,
        rotation_trick=False,
    )
    for layer, vectors in zip(theirs.layers, ours.codebooks.data, strict=True):
        layer._codebook.embed.data = vectors[None]
    vectors, codes, losses = theirs(z)
    mine = ours(z)
    assert torch.equal(mine.codes, codes)
    torch.testing.assert_close(mine.vectors, vectors)
    torch.testing.assert_close(mine.commitment_loss, losses.mean())


def test_a_code_for_each_stage_is_demanded():
    with pytest.raises(ValueError, match="3 codes on the last axis"):
        ResidualQuantizer(3, 8, 6).decode(torch.zeros(2, 2, dtype=torch.int64))
