import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from s2glib.viz import draw_features, draw_waveform, draw_words

matplotlib.use("Agg")


@pytest.fixture
def axes():
    return Figure().add_subplot()


def test_a_waveform_lies_on_its_seconds(axes):
    samples = np.array([0.0, 0.5, -0.5, 0.0])
    assert draw_waveform(axes, samples, 2) is axes
    assert axes.lines[0].get_xydata().tolist() == [[0, 0], [0.5, 0.5], [1, -0.5], [1.5, 0]]


def test_features_rise_from_the_bottom_and_last_as_long_as_their_frames(axes):
    features = np.arange(12.0).reshape(4, 3)
    assert draw_features(axes, features, 2.0, "mel band") is axes
    (picture,) = axes.images
    assert picture.get_extent() == [0, 2, 0, 3]
    assert picture.origin == "lower"
    assert np.array_equal(picture.get_array(), features.T)
    assert axes.get_ylabel() == "mel band"


def test_words_stand_above_the_moment_they_start(axes):
    assert draw_words(axes, ["look", "there"], [0.4, 0.9]) is axes
    places = [(text.get_text(), text.xy) for text in axes.texts]
    assert places == [("look", (0.4, 1)), ("there", (0.9, 1))]


def test_neighbouring_words_stand_on_different_levels(axes):
    draw_words(axes, ["it", "fell", "on", "us"], [0.1, 0.2, 0.3, 0.4])
    first, second, third, fourth = (text.get_position()[1] for text in axes.texts)
    assert len({first, second, third}) == 3
    assert fourth == first
