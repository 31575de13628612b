"""The filterbank of 10 s of speech, ours against transformers' AST extractor in one run."""

import warnings

import numpy as np
import pytest
from transformers import ASTFeatureExtractor

from s2glib.audio import filterbank

SECONDS, RATE = 10, 16000


@pytest.fixture(scope="module")
def samples():
    rng = np.random.default_rng(0)
    return (0.1 * rng.standard_normal(SECONDS * RATE)).astype(np.float32)


@pytest.fixture(scope="module")
def peer():
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "At least one mel filter")
        extractor = ASTFeatureExtractor(do_normalize=False)
    return lambda samples: extractor(samples, RATE, return_tensors="np")["input_values"][0]


@pytest.mark.benchmark(group="filterbank")
def test_ours(benchmark, samples, peer):
    ours = benchmark(filterbank, samples)
    np.testing.assert_allclose(ours, peer(samples), rtol=1e-5, atol=1e-5)


@pytest.mark.benchmark(group="filterbank")
def test_peer(benchmark, samples, peer):
    assert benchmark(peer, samples).shape == (1024, 128)
