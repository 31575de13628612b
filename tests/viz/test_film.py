import matplotlib
import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from matplotlib.figure import Figure
from stand_in_film import moving_film

from s2glib.viz import draw_films, film_bytes
from s2glib.viz.film import check_fps

matplotlib.use("Agg")
FILM = moving_film(20)
SIDES = st.tuples(*3 * [st.integers(1, 5)])


@given(SIDES.flatmap(lambda sides: arrays.arrays(np.uint8, (*sides, 3))))
def test_both_ways_to_hold_a_film_are_the_same_film(film):
    floats = film.transpose(0, 3, 1, 2) / 255
    for same in (film, torch.from_numpy(film), floats, torch.from_numpy(floats).float()):
        assert np.array_equal(film_bytes(same), film)


def test_a_value_that_rounding_pushed_over_the_edge_is_still_white():
    assert (film_bytes(torch.full((1, 3, 2, 2), 1 + 1e-6)) == 255).all()
    assert (film_bytes(torch.full((1, 3, 2, 2), -1e-6)) == 0).all()


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("frames", "fault"),
    [
        (FILM[:0], r"at least one, got uint8 \(0, 48, 64, 3\)"),
        (FILM[0], r"got uint8 \(48, 64, 3\)"),
        (FILM.transpose(0, 3, 1, 2), r"got uint8 \(20, 3, 48, 64\)"),
        (FILM / 255, r"floats \(t, 3, h, w\)"),
        (torch.full((1, 3, 2, 2), 200.0), "from 0 to 1"),
        (torch.full((1, 3, 2, 2), -0.1), "from 0 to 1"),
        (torch.full((1, 3, 2, 2), torch.nan), "from 0 to 1"),
    ],
)
def test_what_is_no_film_is_refused(frames, fault):
    with pytest.raises(ValueError, match=fault):
        film_bytes(frames)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("frames", [FILM.tolist(), "film.mp4", None, FILM.astype(np.int64)])
def test_what_is_neither_bytes_nor_floats_is_refused(frames):
    with pytest.raises(TypeError, match="must be bytes"):
        film_bytes(frames)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("fps", ["25", None, [25]])
def test_a_rate_that_is_no_number_is_refused(fps):
    with pytest.raises(TypeError, match="fps must be a number"):
        check_fps(fps)


@pytest.mark.parametrize(("films", "times"), [({}, (0,)), ({"one": FILM}, ())])
def test_nothing_to_draw_is_refused(films, times):
    with pytest.raises(ValueError, match="nothing to draw"):
        draw_films(Figure().subplots(), films, 25, times)


@pytest.mark.parametrize("fps", [0, -25, 121, float("nan"), float("inf")])
def test_a_rate_that_nobody_can_watch_is_refused(fps):
    with pytest.raises(ValueError, match="fps must be from 1 to 120"):
        check_fps(fps)


def test_moments_stand_in_a_row_for_each_film_at_their_times():
    axes = Figure().add_subplot()
    other = moving_film(10, 32, 32)
    assert draw_films(axes, {"a": FILM, "b": other}, 10, [0.0, 0.5, 1.9]) is axes
    first, second = (np.asarray(image.get_array()) for image in axes.images)
    assert np.array_equal(first, np.concatenate(FILM[[0, 5, 19]], axis=1))
    assert np.array_equal(second, np.concatenate(other[[0, 5, 9]], axis=1))
    assert [label.get_text() for label in axes.get_yticklabels()] == ["a", "b"]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["0.0", "0.5", "1.9"]


def test_pictures_keep_their_shape_in_a_row():
    axes = Figure().add_subplot()
    draw_films(axes, {"": FILM}, 10, [0.0, 1.0])
    left, right, bottom, top = axes.images[0].get_extent()
    assert (right - left) / 2 * 48 / 64 == bottom - top
    assert axes.get_aspect() == 1
