import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure
from stand_in import capsule_body, waving_motion

from s2glib.body import skin_motion
from s2glib.viz import draw_bodies, draw_surface

matplotlib.use("Agg")
NEAR = np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 1]])
FAR = NEAR - [0, 0, 2]
FACES = np.array([[0, 1, 2], [3, 4, 5]])
COLORS = np.repeat([[1.0, 0, 0], [0, 0, 1.0]], 3, axis=0)  # the first triangle is red


@pytest.fixture
def axes():
    return Figure().add_subplot()


def triangles(axes):
    return [np.asarray(path.vertices[:3]) for each in axes.collections for path in each.get_paths()]


@pytest.mark.parametrize("order", [[NEAR, FAR], [FAR, NEAR]])
def test_near_triangles_are_drawn_over_far_ones(axes, order):
    assert draw_surface(axes, np.concatenate(order), FACES, COLORS) is axes
    near = order[0] is NEAR
    first, last = axes.collections[0].get_facecolors()
    red, blue = first[0] > first[2], last[2] > last[0]
    assert (red, blue) == (not near, not near)


def test_what_faces_away_is_not_drawn(axes):
    draw_surface(axes, NEAR, FACES[:1, ::-1], COLORS[:3])
    assert triangles(axes) == []


def test_a_body_that_turns_left_shows_what_was_in_front_at_the_right_of_the_picture(axes):
    thin = np.array([[-0.01, 0, 1], [0.01, 0, 1], [0, 0.1, 1]])
    draw_surface(axes, thin, FACES[:1], COLORS[:3], turn=np.pi / 4, shift=2.0)
    (drawn,) = triangles(axes)
    assert drawn[:, 0].mean() == pytest.approx(2 + np.sqrt(0.5), abs=0.01)


def test_bodies_stand_side_by_side_under_their_seconds(axes):
    motion, body = waving_motion(), capsule_body()
    assert draw_bodies(axes, motion, body, [0.5, 99.0], spacing=2.0) is axes
    assert [label.get_text() for label in axes.get_xticklabels()] == ["0.5", "99.0"]
    ends = skin_motion(motion, body).vertices[[15, 89], :, 1].amax(dim=1).tolist()
    drawn = [
        max(path.vertices[:, 1].max() for path in each.get_paths()) for each in axes.collections
    ]
    assert drawn == pytest.approx(ends, abs=0.02)
