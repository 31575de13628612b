import io

import matplotlib
import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure
from PIL import Image

from s2glib.warping import apply_tps
from s2glib.widgets.tps_pad import TPSPad, sample_picture

matplotlib.use("Agg")
POINTS = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [0.0, 0.1]]
PLACES = st.floats(-3, 3)
SHARED = TPSPad(POINTS)


@pytest.fixture
def pad():
    return TPSPad(POINTS)


def news(pad, driving, number=None):
    """What the page sends after a drag."""
    pad.heard = {"number": pad.order["number"] if number is None else number, "driving": driving}


@given(st.integers(0, 4), PLACES, PLACES)
def test_a_moved_point_is_there_and_inside_the_picture(index, x, y):
    SHARED.reset()
    SHARED.move(index, x, y)
    assert SHARED.driving[index] == [min(max(x, -1), 1), min(max(y, -1), 1)]
    assert sum(a != b for a, b in zip(SHARED.driving, POINTS, strict=True)) <= 1


def test_at_first_nothing_is_bent(pad):
    assert pad.driving == POINTS
    queries = torch.rand(9, 2).double()
    torch.testing.assert_close(apply_tps(pad.spline, queries), queries)


def test_the_spline_leads_from_the_moved_points_to_their_starts(pad):
    pad.move(2, 0.7, 0.4)
    moved, starts = torch.tensor([pad.driving, POINTS]).double()
    torch.testing.assert_close(apply_tps(pad.spline, moved), starts)


def test_a_ridge_set_later_holds(pad):
    pad.move(2, 0.7, 0.4)
    pad.ridge = 0.01
    moved, starts = torch.tensor([pad.driving, POINTS]).double()
    assert (apply_tps(pad.spline, moved) - starts).abs().max() > 1e-4


def test_a_drag_in_the_page_is_heard_and_can_be_observed(pad):
    heard = []
    pad.observe(lambda change: heard.append(change["new"]), "driving")
    moved = [*POINTS[:4], [0.2, 0.3]]
    news(pad, moved)
    assert pad.driving == moved
    assert heard == [moved]


def test_news_from_before_an_order_is_not_believed(pad):
    pad.move(0, 0.1, 0.2)
    news(pad, POINTS, number=0)
    assert pad.driving[0] == [0.1, 0.2]


def test_news_is_not_sent_back_as_an_order(pad):
    before = pad.order
    news(pad, [[0.0, 0.9], *POINTS[1:]])
    assert pad.order == before


def test_a_burst_of_moves_and_a_reset_end_at_the_start(pad):
    for step in range(200):
        pad.move(step % 5, step / 200, -step / 200)
    pad.reset()
    assert pad.driving == POINTS
    assert pad.order == {"number": 201, "driving": POINTS}


def test_points_driven_onto_each_other_have_no_spline_until_there_is_a_ridge(pad):
    pad.move(0, *POINTS[1])
    with pytest.raises(ValueError, match="coincide"):
        _ = pad.spline
    pad.ridge = 0.01
    assert pad.spline.weights.isfinite().all()


def test_the_page_gets_the_picture(pad):
    shown = np.asarray(Image.open(io.BytesIO(pad.picture))) / 255
    assert np.abs(shown.transpose(2, 0, 1) - sample_picture()).max() < 0.5 / 255 + 1e-9


def test_tensors_and_arrays_will_do():
    picture = torch.rand(3, 20, 30)
    for points in (torch.tensor(POINTS), np.array(POINTS, dtype=np.float32)):
        pad = TPSPad(points, picture=picture)
        np.testing.assert_allclose(pad.driving, POINTS, atol=1e-7)
        assert Image.open(io.BytesIO(pad.picture)).size == (30, 20)


def test_drawn_it_shows_the_bent_picture_and_its_points(pad):
    flat, bent = Figure().add_subplot(), Figure().add_subplot()
    assert pad.draw(flat) is flat
    pad.move(4, 0.3, 0.4)
    pad.draw(bent)
    shown = [np.asarray(axes.images[0].get_array()) for axes in (flat, bent)]
    np.testing.assert_allclose(shown[0], sample_picture().transpose(1, 2, 0), atol=1e-6)
    assert np.abs(shown[1] - shown[0]).max() > 0.2
    assert np.array_equal(bent.lines[1].get_xydata(), pad.driving)


def test_its_words_never_change(pad):
    before = repr(pad)
    pad.move(0, 0.0, 0.0)
    assert repr(pad) == before
    assert len(before) < 110


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("points", "fault"),
    [
        (POINTS[:2], "at least 3 control points"),
        ([[0.0, 0.0, 0.0]] * 3, r"\(n, 2\)"),
        ([[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]], "on one line"),
        ([[0.0, 0.0], [0.5, 0.2], [0.0, 1.2]], "in the picture"),
        ([[0.0, 0.0], [0.5, 0.2], [0.0, float("nan")]], "in the picture"),
        (np.random.default_rng(0).uniform(-1, 1, (31, 2)), "at most 30 points"),
    ],
)
def test_points_that_make_no_pad_are_refused(points, fault):
    with pytest.raises(ValueError, match=fault):
        TPSPad(points)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("picture", "fault"),
    [
        (np.zeros((20, 20, 3)), r"\(3, height, width\)"),
        (np.full((3, 8, 8), 255.0), "from 0 to 1"),
        (np.full((3, 8, 8), np.nan), "from 0 to 1"),
    ],
)
def test_a_picture_that_is_none_is_refused(picture, fault):
    with pytest.raises(ValueError, match=fault):
        TPSPad(POINTS, picture=picture)
