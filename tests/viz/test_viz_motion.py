import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from s2glib.body import JOINT_NAMES, PARENTS, REST_JOINTS
from s2glib.viz import draw_pose, draw_strip
from s2glib.viz.motion import LEFT, RIGHT

matplotlib.use("Agg")
WALK = np.stack([REST_JOINTS + [0, 0.97, 0.01 * frame] for frame in range(60)])


@pytest.fixture
def axes():
    return Figure().add_subplot()


def bones(axes):
    return axes.collections[0]


def test_a_pose_is_drawn_bone_by_bone_where_the_joints_are(axes):
    assert draw_pose(axes, REST_JOINTS) is axes
    drawn = {tuple(np.round(s, 6).flatten()) for s in bones(axes).get_segments()}
    shown = [j for j, n in enumerate(JOINT_NAMES) if j and "eye" not in n]
    wanted = {tuple(np.round(REST_JOINTS[[PARENTS[j], j], :2], 6).flatten()) for j in shown}
    assert drawn == wanted


def test_the_left_side_is_blue_and_the_right_one_vermilion(axes):
    draw_pose(axes, REST_JOINTS)
    for segment, colour in zip(bones(axes).get_segments(), bones(axes).get_colors(), strict=True):
        if segment[:, 0].min() > 0.02:
            assert to_hex(colour) == LEFT.lower()
        if segment[:, 0].max() < -0.02:
            assert to_hex(colour) == RIGHT.lower()


def test_from_the_side_one_sees_depth_and_a_shift_moves_the_figure(axes):
    draw_pose(axes, REST_JOINTS, view="side", shift=2.0)
    places = np.concatenate(bones(axes).get_segments())
    assert places[:, 0].min() == pytest.approx(2 + REST_JOINTS[:, 2].min(), abs=0.1)


def test_a_strip_shows_the_frames_of_its_times(axes):
    assert draw_strip(axes, WALK, 30, [0.0, 1.0, 99.0], view="side", spacing=1.0) is axes
    feet = [np.concatenate(c.get_segments())[:, 0].min() for c in axes.collections[::2]]
    assert np.diff(feet) == pytest.approx([1 + 0.30, 1 + 0.29])
    assert [label.get_text() for label in axes.get_xticklabels()] == ["0.0 s", "1.0 s", "99.0 s"]


def test_an_unknown_view_is_refused(axes):
    with pytest.raises(ValueError, match="'top'"):
        draw_pose(axes, REST_JOINTS, view="top")
