import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from vector_quantize_pytorch import VectorQuantize

from s2glib.quantization import Codebook, ProductQuantizer


def normal(*shape, seed=0):
    return torch.randn(shape, generator=torch.Generator().manual_seed(seed))


sizes = st.tuples(st.integers(1, 4), st.integers(1, 9), st.integers(1, 3))


def alone(quantizer, group):
    """The codebook of one group, as a quantiser of its own."""
    _, codes, chunk = quantizer.codebooks.shape
    codebook = Codebook(codes, chunk)
    codebook.tables.vectors.data = quantizer.codebooks.data[group : group + 1]
    return codebook


@given(sizes, st.integers(0, 99))
def test_the_chunks_are_quantized_apart_and_stand_side_by_side(size, seed):
    groups, codes, chunk = size
    torch.manual_seed(seed)
    quantizer, z = ProductQuantizer(groups, codes, groups * chunk), normal(3, 4, groups * chunk)
    quantized = quantizer(z)
    parts = [alone(quantizer, g)(part) for g, part in enumerate(z.split(chunk, dim=-1))]
    assert torch.equal(quantized.codes, torch.stack([part.codes for part in parts], -1))
    assert torch.equal(quantized.vectors, torch.cat([part.vectors for part in parts], -1))
    mean = torch.stack([part.commitment_loss for part in parts]).mean()
    torch.testing.assert_close(quantized.commitment_loss, mean)


def test_no_combination_of_codes_is_nearer():
    """Oracle: all 5^3 vectors that the codes can name."""
    torch.manual_seed(0)
    quantizer, z = ProductQuantizer(3, 5, 6).double(), normal(50, 6).double()
    every = torch.cartesian_prod(*[torch.arange(5)] * 3)
    distances = torch.cdist(z, quantizer.decode(every))
    assert torch.equal(quantizer.encode(z), every[distances.argmin(dim=1)])


def test_one_group_is_a_codebook():
    torch.manual_seed(0)
    quantizer, z = ProductQuantizer(1, 7, 4), normal(30, 4)
    assert torch.equal(quantizer.encode(z)[:, 0], alone(quantizer, 0).encode(z))


def test_it_agrees_with_vector_quantize_pytorch():
    torch.manual_seed(0)
    ours, z = ProductQuantizer(4, 16, 32), normal(6, 10, 32).requires_grad_()
    theirs = VectorQuantize(
        *(32, 16, 8, 4),
        separate_codebook_per_head=True,
        learnable_codebook=True,
        ema_update=False,
        rotation_trick=False,
    )
    theirs._codebook.embed.data = ours.codebooks.data
    vectors, codes, loss = theirs(z)
    mine = ours(z)
    assert torch.equal(mine.codes, codes)
    torch.testing.assert_close(mine.vectors, vectors)
    torch.testing.assert_close(mine.commitment_loss, loss)


def test_the_authors_sizes():
    """512 channels, G = 4 groups of 128 codes  [PT A.1; authors' code]."""
    with torch.device("meta"):
        quantizer = ProductQuantizer(4, 128, 512)
        assert quantizer.codebooks.shape == (4, 128, 128)
        assert quantizer.encode(torch.empty(2, 22, 512)).shape == (2, 22, 4)


@pytest.mark.parametrize(("groups", "dim"), [(4, 6), (0, 6), (-2, 6)])
def test_channels_that_do_not_divide_are_refused(groups, dim):
    with pytest.raises(ValueError, match=f"6 channels do not divide into {groups}"):
        ProductQuantizer(groups, 8, dim)


@pytest.mark.parametrize("shape", [(2, 4), (2, 2), ()])
def test_a_code_for_each_group_is_demanded(without_type_hook, shape):
    with pytest.raises(ValueError, match="3 codes on the last axis"):
        ProductQuantizer(3, 8, 6).decode(torch.zeros(shape, dtype=torch.int64))
