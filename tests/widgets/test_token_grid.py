import re
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.colors import to_hex

from s2glib.viz.tokens import HIDDEN
from s2glib.widgets.token_grid import token_grid

TOKENS = np.array([[5, 9], [9, 7], [9, 9]])  # 9: hidden
LOG_P = np.where(TOKENS == 9, np.nan, np.log([[1.0, 1.0], [1.0, 1 / 9], [1.0, 1.0]]))
NEW = TOKENS == 7


def grid(*, drawn=True, log_p=LOG_P):
    """The table as elements."""
    svg = token_grid(TOKENS, log_p, NEW, codes=9, seconds=0.25, drawn=drawn)
    return ElementTree.fromstring(svg)


def cells(svg):
    """Rectangles of the table, without the legend's."""
    return [each for each in svg.iter("rect") if each.get("stroke")]


def words(svg):
    return [each.text for each in svg.iter("text")]


def test_known_tokens_show_their_codes_and_hidden_ones_a_cross():
    assert words(grid())[:6] == ["5", "×", "×", "7", "×", "×"]


def test_before_the_first_step_hidden_tokens_are_blank():
    assert words(grid(drawn=False))[:6] == ["5", None, None, "7", None, None]


def test_colours_say_how_likely_a_code_was():
    fills = [cell.get("fill") for cell in cells(grid())]
    bright, dark = (to_hex(colormaps["viridis"](share)) for share in (1.0, 0.0))
    assert fills == [bright, HIDDEN, HIDDEN, dark, HIDDEN, HIDDEN]


def test_a_code_less_likely_than_a_blind_guess_is_as_dark():
    (fill,) = {cell.get("fill") for cell in cells(grid(log_p=np.full((3, 2), -99.0)))}
    assert fill == to_hex(colormaps["viridis"](0.0))


def test_numbers_can_be_read_on_their_colour():
    inks = {each.text: each.get("fill") for each in grid().iter("text")}
    assert (inks["5"], inks["7"]) == ("#000", "#fff")


def test_new_tokens_have_a_thick_frame():
    thick = [float(cell.get("stroke-width")) > 2 for cell in cells(grid())]
    assert thick == [False, False, False, True, False, False]


def test_the_axes_say_seconds_and_groups():
    said = words(grid())
    assert said[6:] == ["0.0", "0.8", "group 0", "group 1", "time (s)", *said[11:]]
    assert "probability 1/9" in said


@pytest.mark.parametrize("shape", [(1, 1), (22, 4)])
def test_everything_lies_inside_the_picture(shape):
    svg = ElementTree.fromstring(
        token_grid(
            np.zeros(shape, int),
            np.zeros(shape),
            np.ones(shape, bool),
            codes=9,
            seconds=0.27,
            drawn=True,
        )
    )
    _, _, width, height = map(float, svg.get("viewBox").split())
    for cell in cells(svg):
        x, y, wide, high = (float(cell.get(name)) for name in ("x", "y", "width", "height"))
        assert 0 <= x < x + wide <= width
        assert 0 <= y < y + high <= height


def test_nothing_is_loaded_from_outside():
    svg = token_grid(TOKENS, LOG_P, NEW, codes=9, seconds=0.25, drawn=True)
    assert not re.search(r"https?:|href|script", svg)
