import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from torch.nn import functional as F
from vector_quantize_pytorch import VectorQuantize

from s2glib.quantization import Codebook, MovingAverage


def normal(*shape, seed=0, dtype=torch.float64):
    return torch.randn(shape, generator=torch.Generator().manual_seed(seed), dtype=dtype)


def book(codes, dim, seed=0):
    torch.manual_seed(seed)
    return Codebook(codes, dim).double()


sizes = st.tuples(st.integers(1, 20), st.integers(1, 6), st.integers(0, 99))


@given(sizes, st.lists(st.integers(1, 4), max_size=2))
def test_decoded_codes_are_the_nearest_entries(size, batch):
    """Oracle: a tree search, which computes distances one by one."""
    codes, dim, seed = size
    codebook, z = book(codes, dim, seed), normal(*batch, dim, seed=seed)
    decoded = codebook.decode(codebook.encode(z))
    distances, _ = cKDTree(codebook.vectors.detach()).query(z)
    torch.testing.assert_close((decoded - z).norm(dim=-1), torch.as_tensor(distances).double())


@given(sizes)
def test_an_entry_is_its_own_nearest(size):
    codebook = book(*size)
    assert torch.equal(codebook.encode(codebook.vectors), torch.arange(size[0]))
    assert torch.equal(codebook(codebook.vectors).codes, torch.arange(size[0]))


def test_gradients_through_every_quantizer_are_exactly_the_identity(make, z):
    z.requires_grad_()
    upstream = torch.randn(z.shape)
    (make()(z).vectors * upstream).sum().backward()
    assert torch.equal(z.grad, upstream)


def test_the_vectors_are_the_decoded_codes(make, z):
    quantizer = make()
    quantized = quantizer(z)
    assert torch.equal(quantized.codes, quantizer.encode(z))
    torch.testing.assert_close(quantized.vectors, quantizer.decode(quantized.codes))


def test_one_loss_moves_the_codes_and_the_other_what_is_encoded(make, z):
    quantizer = make()
    codes = quantizer.tables.vectors
    quantized = quantizer(z.requires_grad_())
    assert torch.equal(quantized.codebook_loss, quantized.commitment_loss)
    by_codebook = torch.autograd.grad(
        quantized.codebook_loss, (codes, z), retain_graph=True, allow_unused=True
    )
    by_commitment = torch.autograd.grad(quantized.commitment_loss, (codes, z), allow_unused=True)
    assert [gradient is None for gradient in by_codebook] == [False, True]
    assert [gradient is None for gradient in by_commitment] == [True, False]


def test_the_losses_are_mean_squared_distances():
    codebook, z = book(5, 3), normal(7, 3).requires_grad_()
    nearest = codebook.decode(codebook.encode(z))
    quantized = codebook(z)
    assert quantized.codebook_loss.item() == pytest.approx(F.mse_loss(nearest, z).item())
    (gradient,) = torch.autograd.grad(quantized.commitment_loss, z)
    torch.testing.assert_close(gradient, 2 * (z - nearest) / z.numel())


def test_it_agrees_with_vector_quantize_pytorch():
    torch.manual_seed(0)
    ours, z = Codebook(32, 8), normal(6, 10, 8, dtype=torch.float32).requires_grad_()
    theirs = VectorQuantize(8, 32, learnable_codebook=True, ema_update=False, rotation_trick=False)
    theirs._codebook.embed.data = ours.tables.vectors.data
    vectors, codes, loss = theirs(z)
    mine = ours(z)
    assert torch.equal(mine.codes, codes)
    torch.testing.assert_close(mine.vectors, vectors)
    torch.testing.assert_close(mine.commitment_loss, loss)


@pytest.mark.parametrize("dtype", [torch.float16, torch.bfloat16, torch.float32, torch.float64])
def test_the_dtype_is_kept(make, z, dtype):
    quantized = make(ema=MovingAverage())(z.to(dtype))
    assert quantized.vectors.dtype == dtype
    assert quantized.codes.dtype == torch.int64


def test_it_is_built_and_shaped_without_memory(make):
    with torch.device("meta"):
        quantized = make(ema=MovingAverage())(torch.empty(2, 7, 6))
    assert quantized.vectors.shape == (2, 7, 6)
    assert quantized.codes.shape[:2] == (2, 7)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -float("inf")])
def test_values_that_are_no_numbers_are_refused(make, z, bad):
    z[2, 3, 4] = bad
    for ask in (make(), make().encode):
        with pytest.raises(ValueError, match="NaN or infinite"):
            ask(z)


@pytest.mark.parametrize(
    ("bad", "error", "words"),
    [
        (torch.zeros(4, 5), ValueError, r"6 channels, got shape \(4, 5\)"),
        (torch.zeros(0, 6), ValueError, "at least one vector"),
        (torch.zeros(()), ValueError, "last axis"),
        (torch.zeros(4, 6, dtype=torch.int64), TypeError, "got torch.int64"),
        ([[0.0] * 6], TypeError, "got list"),
    ],
)
def test_what_are_no_vectors_is_refused(make, without_type_hook, bad, error, words):
    for ask in (make(), make().encode):
        with pytest.raises(error, match=words):
            ask(bad)


@pytest.mark.parametrize(
    ("bad", "error", "words"),
    [
        (torch.full((2, 3), 8), ValueError, r"0\.\.7, got 8\.\.8"),
        (torch.full((2, 3), -1), ValueError, r"0\.\.7, got -1\.\.-1"),
        (torch.zeros(2, 3), TypeError, "got torch.float32"),
        ([0, 1, 2], TypeError, "got list"),
    ],
)
def test_what_are_no_codes_is_refused(make, without_type_hook, bad, error, words):
    with pytest.raises(error, match=words):
        make().decode(bad)


@pytest.mark.parametrize("size", [(0, 4), (4, 0), (-1, 4)])
def test_an_empty_book_is_refused(size):
    with pytest.raises(ValueError, match="at least one group, code and channel"):
        Codebook(*size)
