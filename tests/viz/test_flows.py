import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from s2glib.viz.flows import (
    GROUPS,
    MARKERS,
    draw_keypoint_groups,
    draw_moving_flow,
    draw_occlusion,
    draw_weight_maps,
    group_colours,
)
from s2glib.viz.warps import DRIVING
from s2glib.warping import coordinate_grid

matplotlib.use("Agg")
PICTURE = np.full((3, 8, 8), 0.5)


@pytest.fixture
def axes():
    return Figure().add_subplot()


def test_groups_have_colours_of_their_own_and_begin_again_when_there_are_no_more():
    colours = group_colours(len(GROUPS) + 1)
    assert len({tuple(colour) for colour in colours}) == len(GROUPS) == len(MARKERS)
    assert np.array_equal(colours[-1], to_rgb(GROUPS[0]))


def test_the_keypoints_of_each_group_are_marked_alike_on_a_pale_picture(axes):
    keypoints = np.random.default_rng(0).uniform(-1, 1, (3, 5, 2))
    assert draw_keypoint_groups(axes, PICTURE, keypoints) is axes
    assert np.array_equal([line.get_xydata() for line in axes.lines], keypoints)
    looks = [(tuple(line.get_color()), line.get_marker()) for line in axes.lines]
    assert looks == [(to_rgb(GROUPS[k]), MARKERS[k]) for k in range(3)]
    assert (axes.images[0].get_array() == 0.75).all()


def test_weights_mix_the_colours_and_the_background_is_white(axes):
    weights = np.zeros((3, 1, 3))
    weights[0, 0, 0] = weights[1, 0, 1] = 1  # background, first group, ...
    weights[1:, 0, 2] = 0.5  # ... and half of both groups
    assert draw_weight_maps(axes, weights) is axes
    first, second = group_colours(2)
    np.testing.assert_allclose(
        axes.images[0].get_array()[0], [(1, 1, 1), first, (first + second) / 2]
    )


def test_a_flow_lies_over_a_picture_of_another_size(axes):
    flow = coordinate_grid(5, 5).numpy() + np.float32(0.1)
    assert draw_moving_flow(axes, PICTURE, flow, every=2) is axes
    (arrows,) = axes.collections
    np.testing.assert_allclose([arrows.U, arrows.V], np.full((2, 9), 0.1), atol=1e-6)
    np.testing.assert_allclose(axes.images[0].get_array(), 0.85)


def test_what_is_hidden_is_covered_and_what_is_visible_shows(axes):
    visible = np.array([[1.0, 0.0], [0.25, 1.0]])
    assert draw_occlusion(axes, PICTURE, visible) is axes
    picture, cover = axes.images
    assert np.array_equal(cover.get_array()[..., 3], [[0, 1], [0.75, 0]])
    assert np.array_equal(cover.get_array()[0, 1, :3], to_rgb(DRIVING))
    assert cover.get_extent() == picture.get_extent()
