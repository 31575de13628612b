import matplotlib
import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from s2glib.viz import draw_kept
from s2glib.viz.kept import KEPT

matplotlib.use("Agg")
NAMES = ("face", "left_hand")


@pytest.fixture
def axes():
    return Figure().add_subplot()


def spans(bars):
    """From when to when, and in which row."""
    corners = [path.vertices for path in bars.get_paths()]
    return [(*np.round(place[:, 0][[0, 2]], 6), place[:, 1].mean().round()) for place in corners]


def test_bars_stand_where_something_is_kept_in_seconds_and_rows(axes):
    kept = np.zeros((60, 2), bool)
    kept[:15, 0] = kept[45:, 0] = kept[30:33, 1] = True
    assert draw_kept(axes, kept, 30, NAMES) is axes
    bars = [each for each in axes.collections if isinstance(each, PolyCollection)]
    assert {to_hex(each.get_facecolor()[0]) for each in bars} == {KEPT.lower()}
    assert [span for each in bars for span in spans(each)] == [
        (0.0, 0.5, 0),
        (1.5, 2.0, 0),
        (1.0, 1.1, 1),
    ]


def test_rows_are_named_and_the_first_one_is_above(axes):
    draw_kept(axes, np.ones((30, 2), bool), 30, NAMES)
    assert [label.get_text() for label in axes.get_yticklabels()] == ["face", "left hand"]
    bottom, top = axes.get_ylim()
    assert bottom > top
    assert axes.get_xlim() == (0, 1)
    assert axes.get_xlabel() == "time (s)"


def test_what_is_kept_nowhere_has_no_bar(axes):
    draw_kept(axes, np.zeros((30, 2), bool), 30, NAMES)
    assert not any(each.get_paths() for each in axes.collections)
    assert all(patch.get_hatch() for patch in axes.patches)
    assert len(axes.patches) == 2
