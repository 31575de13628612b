import matplotlib
import numpy as np
import pytest
import torch

from s2glib.teaching import PALETTE, setup


@pytest.fixture(autouse=True)
def restored():
    threads = torch.get_num_threads()
    with matplotlib.rc_context():
        yield
    torch.set_num_threads(threads)


def test_it_says_one_line_and_the_same_numbers_are_drawn_again(capsys):
    drawn = []
    for _ in range(2):
        setup("01")
        drawn.append((np.random.rand(), torch.rand(()).item()))  # noqa: NPY002
    assert drawn[0] == drawn[1]
    assert capsys.readouterr().out == "Notebook 01 is ready.\n" * 2
    assert torch.get_num_threads() == 1


def test_lines_differ_in_colour_and_in_stroke():
    setup("00")
    cycle = list(matplotlib.rcParams["axes.prop_cycle"])
    for kind in ("color", "linestyle"):
        assert len({each[kind] for each in cycle}) == len(cycle) == len(PALETTE)


@pytest.mark.parametrize("notebook", ["", "1", "001", "ab"])
def test_another_number_is_refused(notebook):
    with pytest.raises(ValueError, match="two digits"):
        setup(notebook)
