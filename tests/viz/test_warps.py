import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from s2glib.viz.warps import (
    DRIVING,
    SOURCE,
    draw_carried_grid,
    draw_control_points,
    draw_flow,
    draw_heatmap,
    draw_picture,
    draw_warped_grid,
)
from s2glib.warping import coordinate_grid

matplotlib.use("Agg")
GRID = coordinate_grid(9, 13).numpy()


@pytest.fixture
def axes():
    return Figure().add_subplot()


def test_a_picture_has_its_corner_pixels_on_one_and_y_goes_down(axes):
    assert draw_picture(axes, np.zeros((3, 5, 9))) is axes
    left, right, bottom, top = axes.images[0].get_extent()
    assert (left, right) == (-1 - 1 / 8, 1 + 1 / 8)  # half a pixel beyond
    assert (bottom, top) == (1 + 1 / 4, -1 - 1 / 4)
    assert axes.get_ylim()[0] > axes.get_ylim()[1]


def test_a_grid_is_drawn_as_its_rows_and_columns(axes):
    assert draw_warped_grid(axes, 0.5 * GRID, every=5) is axes
    lines = axes.collections[0].get_segments()
    assert [len(line) for line in lines] == [13] * 3 + [9] * 4  # rows 0 5 8, columns 0 5 10 12
    assert np.array_equal(lines[1], 0.5 * GRID[5])
    assert np.array_equal(lines[-1], 0.5 * GRID[:, 12])


def test_the_lines_of_the_source_are_where_the_grid_looks_at_them(axes):
    """Everything half as large: a warp that looks twice as far."""
    assert draw_carried_grid(axes, 2 * GRID, step=0.5) is axes
    upright, level = axes.collections
    columns = sorted(
        {round(float(x), 6) for path in upright.get_paths() for x in path.vertices[:, 0]}
    )
    rows = sorted({round(float(y), 6) for path in level.get_paths() for y in path.vertices[:, 1]})
    assert columns == rows == [-0.5, -0.25, 0, 0.25, 0.5]


def test_control_points_are_marked_and_an_arrow_leads_to_where_they_are_driven(axes):
    driving, source = np.array([[0.1, 0.2], [0.3, -0.4]]), np.array([[0.0, 0.2], [0.5, -0.4]])
    assert draw_control_points(axes, driving, source) is axes
    hollow, full = axes.lines
    assert np.array_equal(hollow.get_xydata(), source)
    assert np.array_equal(full.get_xydata(), driving)
    assert (hollow.get_markerfacecolor(), full.get_color()) == ("white", DRIVING)
    assert np.array_equal([arrow.xyann for arrow in axes.texts], source)
    assert np.array_equal([arrow.xy for arrow in axes.texts], driving)


def test_a_flow_is_drawn_with_arrows_from_pixels_to_the_points_they_show(axes):
    assert draw_flow(axes, GRID + np.array([0.1, -0.2], np.float32), every=6) is axes
    (arrows,) = axes.collections
    assert len(arrows.X) == 3 * 3  # rows 0 6 8, columns 0 6 12
    assert arrows.X[:3].tolist() == [-1, 0, 1]
    assert arrows.Y[::3].tolist() == [-1, 0.5, 1]
    np.testing.assert_allclose([arrows.U, arrows.V], [[0.1] * 9, [-0.2] * 9], atol=1e-6)
    assert (arrows.scale, arrows.angles) == (1, "xy")  # true to scale, down where y grows
    assert to_hex(arrows.get_facecolor()[0]) == SOURCE.lower()


def test_heat_hides_the_picture_only_where_it_is(axes):
    heat = np.array([[0.0, 1.0], [-0.5, 0.0]])
    assert draw_heatmap(axes, np.full((3, 8, 8), 0.5), heat) is axes
    picture, over = axes.images
    assert picture.get_array().shape == (8, 8, 3)
    assert np.array_equal(over.get_alpha(), [[0, 0.85], [0.425, 0]])
    assert (over.norm.vmin, over.norm.vmax) == (-1, 1)


def test_no_heat_at_all_leaves_the_picture(axes):
    draw_heatmap(axes, np.zeros((3, 4, 4)), np.zeros((2, 2)))
    assert not axes.images[1].get_alpha().any()


@pytest.mark.parametrize("draw", [draw_warped_grid, draw_flow])
def test_lines_closer_than_pixels_are_refused(axes, draw):
    with pytest.raises(ValueError, match="every=0"):
        draw(axes, GRID, every=0)
