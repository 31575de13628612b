from typing import NamedTuple

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Tensor

from s2glib.layers import in_batches


class Pair(NamedTuple):
    x: Tensor
    y: Tensor


class Nested(NamedTuple):
    pair: Pair
    z: Tensor


@given(st.integers(1, 20), st.integers(1, 25))
def test_batches_do_not_change_the_answer(rows, size):
    values = torch.arange(3.0 * rows).reshape(rows, 3)
    assert torch.equal(in_batches(torch.square, values, size=size), values**2)


def test_named_tuples_are_taken_apart_and_put_together_at_any_depth():
    rows = Nested(Pair(torch.randn(7, 2), torch.randn(7, 3)), torch.randn(7))
    sizes = []

    def swap(nested, factor):
        sizes.append(len(factor))
        return Nested(Pair(nested.pair.y, nested.pair.x), factor * nested.z)

    found = in_batches(swap, rows, torch.full((7,), 2.0), size=3)
    assert sizes == [3, 3, 1]
    assert torch.equal(found.pair.x, rows.pair.y)
    assert torch.equal(found.pair.y, rows.pair.x)
    assert torch.equal(found.z, 2 * rows.z)


def test_inputs_of_different_lengths_are_refused():
    with pytest.raises(ValueError, match="zip"):
        in_batches(torch.add, torch.ones(4), torch.ones(2), size=2)


def test_no_gradient_is_kept():
    assert not in_batches(torch.square, torch.ones(4, requires_grad=True)).requires_grad
