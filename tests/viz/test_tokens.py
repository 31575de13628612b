import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.colors import to_rgba

from s2glib.viz import draw_tokens
from s2glib.viz.tokens import HIDDEN


@pytest.fixture
def drawn():
    """Three times, two groups: a certain code, a blind guess, the rest hidden."""
    log_p = np.full((3, 2), np.nan)
    log_p[0, 1], log_p[2, 0] = 0.0, -np.log(16)
    fig, axes = plt.subplots()
    assert draw_tokens(axes, log_p, ~np.isnan(log_p), codes=16, seconds=0.5) is axes
    yield axes
    plt.close(fig)


def test_colours_say_how_likely_a_code_was(drawn):
    (image,) = drawn.images
    shades = image.to_rgba(image.get_array())  # (groups, time, 4)
    bright, dark = colormaps["viridis"]([1.0, 0.0])
    np.testing.assert_allclose(shades[1, 0], bright)
    np.testing.assert_allclose(shades[0, 2], dark)
    np.testing.assert_allclose(shades[0, 0], to_rgba(HIDDEN))


def test_a_column_takes_a_tokens_time_and_a_row_is_a_group(drawn):
    assert drawn.images[0].get_extent() == [0, 1.5, 1.5, -0.5]
    assert drawn.get_yticks().tolist() == [0, 1]
    assert (drawn.get_xlabel(), drawn.get_ylabel()) == ("time (s)", "group")


def test_new_tokens_are_framed(drawn):
    assert [patch.get_xy() for patch in drawn.patches] == [(0.0, 0.5), (1.0, -0.5)]


def test_without_news_nothing_is_framed():
    fig, axes = plt.subplots()
    draw_tokens(axes, np.zeros((3, 2)), codes=16, seconds=0.5)
    assert len(axes.patches) == 0
    plt.close(fig)
