import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from s2glib.body import REST_OFFSETS, joint
from s2glib.corpus.arms import (
    ARM,
    FOREARM,
    clear_of_body,
    push_out_of_body,
    shoulder_places,
    solve_arm,
    wrist_targets,
)
from s2glib.corpus.strokes import HandPath

SIDES = ("left", "right")
SHORTEST_BEND = np.deg2rad(15)
sides = st.sampled_from(SIDES)
seeds = st.integers(0, 2**32)


def arm_at(side, targets, palm, elbow_out=0.0):
    """Solve for wrists in arm lengths from the shoulder, out to the side; give the chain back."""
    sign = np.array([1.0 if side == "left" else -1.0, 1, 1])
    count = len(targets)
    collar = Rotation.from_rotvec(np.tile([0.0, 0.0, 0.1 * sign[0]], (count, 1)))
    shoulder = shoulder_places(dict.fromkeys(SIDES, collar))[side]
    wrist = shoulder + targets * sign * ARM
    arm = solve_arm(wrist, palm, side, shoulder, collar, elbow_out)
    upper = collar * arm.shoulder
    elbow = shoulder + upper.apply(REST_OFFSETS[joint(f"{side}_elbow")])
    fore = upper * arm.elbow
    reached = elbow + fore.apply(REST_OFFSETS[joint(f"{side}_wrist")])
    return arm, wrist, shoulder, elbow, reached, fore * arm.wrist


def some_targets(seed, count=20, reach=(0.35, 0.9)):
    """Places in front of the body."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3)) * [0.5, 1, 0.5] + [0.1, 0, 1.0]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * rng.uniform(*reach, (count, 1))


def bend(shoulder, elbow, wrist):
    upper, fore = elbow - shoulder, wrist - elbow
    cosine = (upper * fore).sum(1) / np.linalg.norm(upper, axis=1) / np.linalg.norm(fore, axis=1)
    return np.arccos(cosine.clip(-1, 1))


PALM_IN = np.tile([-1.0, -0.15, 0.0], (20, 1))


@given(sides, seeds, st.floats(-0.15, 0.15))
def test_the_wrist_gets_where_it_should(side, seed, elbow_out):
    _, wanted, _, _, reached, _ = arm_at(side, some_targets(seed), PALM_IN, elbow_out)
    assert reached == pytest.approx(wanted, abs=1e-9)


@given(sides, seeds)
def test_the_hand_points_where_the_arm_says(side, seed):
    arm, *_, hand = arm_at(side, some_targets(seed), PALM_IN)
    forwards = REST_OFFSETS[joint(f"{side}_wrist")] / FOREARM
    assert hand.apply(forwards) == pytest.approx(arm.hand, abs=1e-9)


@given(sides, seeds)
def test_out_of_reach_the_arm_points_there_and_keeps_its_elbow_bent(side, seed):
    targets = some_targets(seed, reach=(0.97, 3.0))
    _, wanted, shoulder, elbow, reached, _ = arm_at(side, targets, PALM_IN)
    assert (bend(shoulder, elbow, reached) > SHORTEST_BEND).all()
    along = wanted - shoulder
    away = np.cross(reached - shoulder, along / np.linalg.norm(along, axis=1, keepdims=True))
    assert away == pytest.approx(0, abs=1e-9)


@given(sides, st.floats(-0.2, 0.4), st.floats(-0.7, 0.0), st.floats(0.3, 0.6))
def test_elbows_hang_below_the_line_from_shoulder_to_hand(side, out, up, forward):
    targets = np.tile([out, up, forward], (20, 1))
    _, _, shoulder, elbow, reached, _ = arm_at(side, targets, PALM_IN)
    share = ((elbow - shoulder) * (reached - shoulder)).sum(1) / ((reached - shoulder) ** 2).sum(1)
    on_line = shoulder + share[:, None] * (reached - shoulder)
    assert (elbow[:, 1] < on_line[:, 1] + 1e-9).all()


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("palm", [(-1.0, -0.15, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)])
def test_the_palm_faces_as_asked_within_what_a_forearm_can_turn(side, palm):
    target = np.tile([0.1, -0.3, 0.55], (20, 1))
    sign = np.array([1.0 if side == "left" else -1.0, 1, 1])
    *_, hand = arm_at(side, target, np.tile(palm, (20, 1)))
    assert (hand.apply([0.0, -1.0, 0.0]) @ (np.array(palm) * sign) > 0.7).all()


@given(seeds)
def test_the_right_arm_mirrors_the_left(seed):
    left, right = (arm_at(side, some_targets(seed), PALM_IN)[0] for side in SIDES)
    mirror = np.array([1, -1, -1])
    for name in ("shoulder", "elbow", "wrist"):
        turns = getattr(left, name).as_rotvec() * mirror
        assert Rotation.from_rotvec(turns).approx_equal(getattr(right, name), atol=1e-6).all()


@given(sides, arrays(float, (12, 3), elements=st.floats(-3, 3)))
def test_reach_is_softened_but_keeps_its_direction(side, wrist):
    sign = np.array([1.0 if side == "left" else -1.0, 1, 1])
    path = HandPath(wrist, np.zeros((12, 3)), np.zeros((12, 6)))
    target = wrist_targets(path, side, np.zeros((12, 3))) * sign / ARM
    length = np.linalg.norm(wrist, axis=1)
    near = (length > 0.3) & (length < 0.8)
    assert target[near] == pytest.approx(wrist[near], abs=1e-9)
    assert (np.linalg.norm(target, axis=1) < 0.96 + 1e-9).all()
    assert np.cross(target, wrist) == pytest.approx(0, abs=1e-6)


@given(arrays(float, (30, 3), elements=st.floats(-0.5, 0.7)))
def test_a_pushed_point_is_out_of_head_and_torso(points):
    push = push_out_of_body(points)
    assert (push >= 0).all()
    moved = points + push[:, None] * [0, 0, 1]
    assert push_out_of_body(moved) == pytest.approx(0, abs=1e-7)


def test_points_in_front_of_the_body_are_left_alone():
    assert push_out_of_body(np.array([[0.0, -0.1, 0.3], [0.2, 0.5, 0.3]])) == pytest.approx(0)


def test_hands_that_meet_in_the_chest_come_out_and_keep_apart():
    middle = np.zeros((30, 3))
    forwards = np.tile([0.0, 0.0, 1.0], (30, 1))
    cleared = clear_of_body(dict.fromkeys(SIDES, middle), dict.fromkeys(SIDES, forwards))
    for side in SIDES:
        assert push_out_of_body(cleared[side]) == pytest.approx(0, abs=1e-6)
    gap = np.linalg.norm(cleared["left"] - cleared["right"], axis=1)
    assert (gap > 0.149).all()
    assert (cleared["left"][:, 0] > cleared["right"][:, 0]).all()


def test_hands_that_touch_nothing_stay_where_they_are():
    wrists = {s: np.tile([x, -0.1, 0.35], (30, 1)) for s, x in zip(SIDES, (0.2, -0.2), strict=True)}
    hands = {s: np.tile([0.0, 0.0, 1.0], (30, 1)) for s in SIDES}
    cleared = clear_of_body(wrists, hands)
    for side in SIDES:
        assert cleared[side] == pytest.approx(wrists[side])
