import numpy as np
import pytest
import torch

from s2glib.body import FINGERS, joint
from s2glib.corpus.lexicon import GESTURES, HAND_SHAPES, PALMS, SEMANTIC_WEIGHT, finger_poses
from s2glib.data import GESTURE_TYPES

SIDES = ("left", "right")


def hand(pose_body, side, shape):
    """Fingertip-side knuckles (5, 3) relative to the wrist, arms out and palms down."""
    poses = torch.zeros(1, 55, 3)
    first = joint(f"{side}_index1")
    fingers = finger_poses(np.array([HAND_SHAPES[shape]]), side)
    poses[:, first : first + 15] = torch.from_numpy(fingers).float()
    places = pose_body(poses).positions[0]
    return {f: (places[joint(f"{side}_{f}3")] - places[joint(f"{side}_wrist")]) for f in FINGERS}


@pytest.mark.parametrize("side", SIDES)
def test_a_fist_bends_the_fingers_towards_the_palm(pose_body, side):
    fist, flat = (hand(pose_body, side, shape) for shape in ("fist", "flat"))
    for finger in ("index", "middle", "ring", "pinky"):
        assert fist[finger][1] < flat[finger][1] - 0.02  # the palm faces down
        assert fist[finger].norm() < flat[finger].norm() - 0.01


@pytest.mark.parametrize("side", SIDES)
def test_a_fist_folds_the_thumb_across_the_palm(pose_body, side):
    fist, flat = (hand(pose_body, side, shape)["thumb"] for shape in ("fist", "flat"))
    assert fist[2] < flat[2] - 0.01  # from the front edge of the hand backwards


@pytest.mark.parametrize("side", SIDES)
def test_pointing_keeps_only_the_index_finger_straight(pose_body, side):
    point = hand(pose_body, side, "point")
    others = [point[finger].norm() for finger in ("middle", "ring", "pinky")]
    assert point["index"].norm() > max(others) + 0.02


@pytest.mark.parametrize("side", SIDES)
def test_an_open_hand_spreads_its_fingers(pose_body, side):
    spread, flat = (hand(pose_body, side, shape) for shape in ("open", "flat"))
    wide, narrow = (h["index"][2] - h["pinky"][2] for h in (spread, flat))
    assert wide > narrow + 0.01


def test_the_right_hand_mirrors_the_left():
    shapes = np.array(list(HAND_SHAPES.values()))
    left, right = (finger_poses(shapes, side) for side in SIDES)
    assert np.array_equal(right, left * [1, -1, -1])


@pytest.mark.parametrize("name", GESTURES)
def test_every_entry_uses_known_kinds_palms_and_shapes(name):
    gesture = GESTURES[name]
    assert gesture.kind in GESTURE_TYPES[1:]
    assert gesture.kind in SEMANTIC_WEIGHT
    assert gesture.palm in PALMS
    assert gesture.shape in HAND_SHAPES
    assert gesture.hands in ("one", "both")
    assert gesture.path in ("line", "hop", "circle")
