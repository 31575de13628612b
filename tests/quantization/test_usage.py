import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import entropy

from s2glib.quantization import code_counts, dead_codes, perplexity

some_codes = st.lists(st.integers(0, 9), min_size=1, max_size=40).map(torch.tensor)


@given(some_codes)
def test_perplexity_is_between_one_and_the_number_of_codes_in_use(codes):
    used = 10 - len(dead_codes(codes, 10))
    assert 1 - 1e-12 <= perplexity(codes, 10) <= used + 1e-12


@given(some_codes)
def test_perplexity_is_scipys_entropy_of_the_shares(codes):
    counts = code_counts(codes, 10)
    assert counts.tolist() == [int((codes == code).sum()) for code in range(10)]
    assert perplexity(codes, 10).item() == pytest.approx(math.exp(entropy(counts)))


@given(some_codes)
def test_a_code_is_dead_or_occurs(codes):
    assert sorted({*dead_codes(codes, 10).tolist(), *codes.tolist()}) == list(range(10))


@given(st.integers(1, 50))
def test_codes_in_equal_use_are_all_in_use(count):
    assert perplexity(torch.arange(count).repeat(2, 3), count).item() == pytest.approx(count)
    assert perplexity(torch.full((5,), count - 1), count) == 1


@pytest.mark.parametrize("ask", [code_counts, dead_codes, perplexity])
@pytest.mark.parametrize(
    ("bad", "error", "words"),
    [
        (torch.tensor([3, 10]), ValueError, r"0\.\.9, got 3\.\.10"),
        (torch.tensor([-1]), ValueError, r"0\.\.9"),
        (torch.zeros(0, dtype=torch.int64), ValueError, "at least one code"),
        (torch.zeros(3), TypeError, "got torch.float32"),
        ([1, 2], TypeError, "got list"),
    ],
)
def test_what_are_no_codes_is_refused(without_type_hook, ask, bad, error, words):
    with pytest.raises(error, match=words):
        ask(bad, 10)
