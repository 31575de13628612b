import numpy as np
import pytest

from s2glib.metrics.doors import require, require_pair


def test_integers_and_halves_come_back_as_float64_copies(unhooked):
    for dtype in (np.int32, np.float16):
        values = np.ones((2, 3), dtype)
        found = require("motion", values, "frames 3")
        assert found.dtype == np.float64
        assert not np.shares_memory(found, values)


def test_batch_axes_may_be_many_or_none(unhooked):
    for shape in ((4, 2, 3), (5, 4, 2, 3), (6, 5, 4, 2, 3)):
        assert require("motion", np.zeros(shape), "*batch frames joints 3").shape == shape
    with pytest.raises(ValueError, match="motion must have axes"):
        require("motion", np.zeros((2, 3)), "*batch frames joints 3")


@pytest.mark.parametrize("values", [np.ones(3, bool), np.ones(3, complex), np.array(["a"]), 1.0])
def test_what_is_no_array_of_numbers_is_named(unhooked, values):
    with pytest.raises(TypeError, match="beats must be a numpy array of numbers"):
        require("beats", values, "beats")


def test_a_pair_of_different_shapes_is_shown_both_shapes(unhooked):
    with pytest.raises(ValueError, match=r"\(4, 2\) and target \(5, 2\)"):
        require_pair(np.zeros((4, 2)), np.zeros((5, 2)), "frames channels")
