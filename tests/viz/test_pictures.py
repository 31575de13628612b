import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from s2glib.viz.pictures import (
    COLOURS,
    draw_boxes,
    draw_gram,
    draw_masks,
    draw_receptive_fields,
)

matplotlib.use("Agg")
SPOT = np.zeros((5, 9), dtype=bool)
SPOT[1:3, 4:8] = True


@pytest.fixture
def axes():
    return Figure().add_subplot()


def test_a_mask_is_coloured_and_the_rest_is_grey(axes):
    image = np.random.default_rng(0).random((3, 5, 9))
    assert draw_masks(axes, image, {"hand": SPOT, "face": ~SPOT & False}) is axes
    shown = np.asarray(axes.images[0].get_array())
    assert np.ptp(shown[~SPOT], axis=-1).max() < 1e-12
    tint = 0.4 * image.mean(0)[SPOT][:, None] + 0.6 * np.array(to_rgb(COLOURS[0]))
    np.testing.assert_allclose(shown[SPOT], tint)
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["hand", "face"]


def test_masks_leave_the_picture_itself_alone(axes):
    image = np.full((3, 5, 9), 0.5)
    draw_masks(axes, image, {"hand": SPOT})
    assert (image == 0.5).all()


def test_a_box_encloses_its_mask_and_nothing_has_none(axes):
    assert draw_boxes(axes, [SPOT, np.zeros((5, 9), dtype=bool)]) is axes
    (box,) = axes.patches
    (left, top), (right, bottom) = box.get_bbox().get_points()
    x, y = np.linspace(-1, 1, 9), np.linspace(-1, 1, 5)
    assert (left < x[4:8]).all()
    assert (x[4:8] < right).all()
    assert not ((left < x) & (x < right))[[3, 8]].any()
    assert (top < y[1:3]).all()
    assert (y[1:3] < bottom).all()
    assert not ((top < y) & (y < bottom))[[0, 3]].any()


def test_zero_is_in_the_middle_of_a_gram_matrix_s_colours(axes):
    matrix = np.array([[3.0, -1.0], [-1.0, 2.0]])
    assert draw_gram(axes, matrix, ["red", "edge"]) is axes
    assert (axes.images[0].norm.vmin, axes.images[0].norm.vmax) == (-3, 3)
    assert [label.get_text() for label in axes.get_xticklabels()] == ["red", "edge"]


def test_gram_matrices_can_share_a_scale(axes):
    draw_gram(axes, np.eye(2), ["red", "edge"], peak=5.0)
    assert axes.images[0].norm.vmax == 5


def test_a_gram_matrix_of_nothing_can_be_drawn(axes):
    draw_gram(axes, np.zeros((1, 1)), ["none"])
    assert axes.images[0].norm.vmax == 1


def test_a_receptive_field_is_so_many_pixels_wide_and_named(axes):
    sizes = {"level 1": 4, "level 8": 766}
    assert draw_receptive_fields(axes, np.zeros((3, 33, 33)), sizes) is axes
    assert [patch.get_width() * 16 for patch in axes.patches] == [4, 766]  # pixels a unit: 16
    assert [patch.get_label() for patch in axes.patches] == ["level 1: 4", "level 8: 766"]
    assert axes.get_xlim() == (-1.1, 1.1)
