import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from s2glib.corpus.puppet.drawing import (
    Camera,
    Canvas,
    Chart,
    Part,
    arc,
    closed_curve,
    finish,
    ink,
    mix,
    open_curve,
)

CAMERA = Camera(center=np.array([0.0, 1.3, 0.0]), span=1.2, distance=4.0, size=120)
RED = (200, 40, 40)


def blank(size=30) -> Canvas:
    return Canvas(Image.new("RGBA", (size, size), (10, 20, 30, 0)))


def parts(canvas: Canvas) -> np.ndarray:
    return np.asarray(canvas.image.getchannel("A"))


def test_the_camera_sees_its_centre_in_the_middle_and_the_bodys_left_on_the_right():
    middle, left, above = CAMERA.project(
        CAMERA.center + np.array([(0, 0, 0), (0.3, 0, 0), (0, 0.3, 0)])
    )
    np.testing.assert_allclose(middle, (60, 60))
    np.testing.assert_allclose(left, (90, 60))
    np.testing.assert_allclose(above, (60, 30))


@given(st.floats(-0.8, 0.8), st.floats(0.01, 0.5))
def test_what_is_nearer_looks_larger(depth, step):
    far, near = CAMERA.pixels_per_metre(np.array([(0.0, 1.0, z) for z in (depth, depth + step)]))
    assert near > far


def test_behind_the_camera_nothing_grows_without_bound():
    assert np.isfinite(CAMERA.project(np.array([(1.0, 1.0, 4.0), (1.0, 1.0, 9.0)]))).all()


def test_a_stroke_writes_colour_and_part_at_once():
    canvas = blank()
    canvas.disc(np.array([15.0, 15.0]), 6.0, ink(RED, Part.LEFT_HAND))
    painted = (np.asarray(canvas.image)[..., :3] == RED).all(axis=-1)
    assert painted.any()
    assert np.array_equal(painted, parts(canvas) == Part.LEFT_HAND)


def test_a_capsule_of_equal_points_is_a_disc():
    canvas, other = blank(), blank()
    centre = np.array([15.0, 15.0])
    canvas.limb(centre, centre, 6.0, 6.0, ink(RED, Part.NECK))
    other.disc(centre, 6.0, ink(RED, Part.NECK))
    assert canvas.image.tobytes() == other.image.tobytes()


def test_a_texture_lies_where_its_axes_say():
    tile = Image.new("RGBA", (8, 8), (0, 0, 0, int(Part.TRUNK)))
    tile.putpixel((2, 5), (255, 255, 255, int(Part.TRUNK)))
    canvas = blank()
    square = np.array([(4.0, 4.0), (28.0, 4.0), (28.0, 28.0), (4.0, 28.0)])
    canvas.texture(square, tile, np.array([4.0, 4.0]), 3.0 * np.eye(2))
    rows, columns = np.nonzero(np.asarray(canvas.image)[..., 0] == 255)
    assert (columns.mean() + 0.5, rows.mean() + 0.5) == (4 + 3 * 2.5, 4 + 3 * 5.5)


def test_a_texture_outside_the_canvas_is_no_error():
    canvas = blank()
    tile = Image.new("RGBA", (8, 8), (0, 0, 0, int(Part.TRUNK)))
    away = np.array([(-90.0, -90.0), (-50.0, -90.0), (-50.0, -50.0)])
    canvas.texture(away, tile, away[0], np.eye(2))
    assert (parts(canvas) == Part.TRUNK).sum() <= 1


@pytest.mark.parametrize("curve", [open_curve, closed_curve])
def test_a_smooth_curve_goes_through_its_points(curve):
    points = np.random.default_rng(0).normal(0, 10, (6, 2))
    distances = np.linalg.norm(curve(points)[:, None] - points, axis=-1)
    np.testing.assert_allclose(distances.min(axis=0), 0, atol=1e-9)


def test_an_arc_of_equal_axes_keeps_its_radius():
    ring = arc(np.array([3.0, 4.0]), np.array([2.0, 0.0]), np.array([0.0, 2.0]), 10.0, 250.0)
    np.testing.assert_allclose(np.linalg.norm(ring - (3, 4), axis=1), 2)


def test_a_chart_counts_in_its_own_metres():
    chart = Chart(np.array([5.0, 5.0]), np.array([10.0, 0.0]), np.array([0.0, -20.0]))
    np.testing.assert_allclose(chart.at((1.0, 0.0), (0.0, 1.0)), [(15, 5), (5, -15)])
    assert chart.scale == 20


def test_a_finished_picture_averages_colours_and_picks_parts():
    canvas = blank(6)
    canvas.image.putpixel((1, 1), (100, 110, 120, int(Part.FACE)))
    picture = finish(canvas, 3)
    assert picture.frame[0, 0].tolist() == [20, 30, 40]  # (8 x 10 + 100) / 9
    assert picture.parts.tolist() == [[Part.FACE, 0], [0, 0]]


def test_mixing_goes_from_one_colour_to_the_other():
    assert mix((0, 100, 200), (100, 0, 100), 0.0) == (0, 100, 200)
    assert mix((0, 100, 200), (100, 0, 100), 0.5) == (50, 50, 150)
    assert mix((0, 100, 200), (100, 0, 100), 1.0) == (100, 0, 100)
