"""The quantisers at the authors' sizes against vector-quantize-pytorch, in one run.

512 channels, 128 clips of 22 tokens; codes of the product quantiser also against numpy's search.

Run: python -m pytest benchmarks/bench_quantizers.py
"""

from time import process_time

import jaxtyping
import numpy as np
import pytest
import torch
from vector_quantize_pytorch import ResidualVQ, VectorQuantize

from s2glib.quantization import Codebook, MovingAverage, ProductQuantizer, ResidualQuantizer

GROUPS, CODES, DIM = 4, 128, 512
RULE = MovingAverage(bias_correction=False, revive_below=0)  # the peer's
OPTIONS = {"decay": RULE.decay, "eps": RULE.eps, "rotation_trick": False}


@pytest.fixture(autouse=True)
def without_type_hook():
    """Time what a reader runs: pytest's shape checks are off."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


def plain():
    return Codebook(CODES, DIM, ema=RULE), VectorQuantize(DIM, CODES, **OPTIONS)


def product():
    theirs = VectorQuantize(
        *(DIM, CODES, DIM // GROUPS, GROUPS), separate_codebook_per_head=True, **OPTIONS
    )
    return ProductQuantizer(GROUPS, CODES, DIM, ema=RULE), theirs


def residual():
    theirs = ResidualVQ(dim=DIM, num_quantizers=GROUPS, codebook_size=CODES, **OPTIONS)
    return ResidualQuantizer(GROUPS, CODES, DIM, ema=RULE), theirs


def with_codes_of(theirs, vectors):
    """Give the peer our codebooks, and the sums they begin with."""
    books = [layer._codebook for layer in getattr(theirs, "layers", [theirs])]
    for book, own in zip(books, vectors.split(len(vectors) // len(books)), strict=True):
        book.embed.data, book.embed_avg.data = own.clone(), own.clone()
        book.cluster_size.data.fill_(1)


def seconds(function):
    start = process_time()
    function()
    return process_time() - start


def error(z, decoded):
    """Squared distance to each of the vectors that were chosen."""
    return (z - decoded).detach().double().square().sum(-1)


@pytest.mark.parametrize("training", [False, True], ids=["coding", "training"])
@pytest.mark.parametrize("pair", [plain, product, residual], ids=lambda pair: pair.__name__)
def test_quantizing_is_never_slower_than_the_peer(benchmark, capsys, pair, training):
    torch.manual_seed(0)
    ours, theirs = pair()
    with_codes_of(theirs, ours.tables.vectors)
    ours.train(training), theirs.train(training)
    z = torch.randn(128, 22, DIM, requires_grad=training)

    def mine():
        return ours(z) if training else ours.decode(ours.encode(z))  # the peer has no losses there

    codes, (vectors, its, _) = ours.encode(z), theirs(z)
    assert (codes == its).float().mean() > 0.999  # the rest is a tie in float32:
    torch.testing.assert_close(error(z, ours.decode(codes)), error(z, vectors), rtol=1e-6, atol=0)
    pairs = [(seconds(mine), seconds(lambda: theirs(z))) for _ in range(25)]
    fastest_of_ours, fastest_of_theirs = map(min, zip(*pairs, strict=True))
    ratio = fastest_of_theirs / fastest_of_ours
    with capsys.disabled():
        print(f"\n{pair.__name__}: vector-quantize-pytorch / ours = {ratio:.2f}")
    benchmark.extra_info["vector-quantize-pytorch / ours"] = ratio
    benchmark.pedantic(mine, rounds=3)
    assert fastest_of_ours <= fastest_of_theirs


def by_numpy(z, codebooks):
    """Brute force: every distance, chunk by chunk."""
    chunks = np.split(z, len(codebooks), axis=-1)
    distances = [
        np.square(chunk[:, None] - book).sum(-1)
        for chunk, book in zip(chunks, codebooks, strict=True)
    ]
    return np.stack([distance.argmin(axis=-1) for distance in distances], axis=-1)


def test_codes_are_those_of_numpys_brute_force(benchmark):
    torch.manual_seed(0)
    quantizer, z = ProductQuantizer(GROUPS, CODES, DIM), torch.randn(22 * 16, DIM)
    codes = benchmark(quantizer.encode, z)
    assert np.array_equal(codes, by_numpy(z.numpy(), quantizer.codebooks.detach().numpy()))
