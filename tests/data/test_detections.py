"""What detectors saw, in both orders of points, and every refusal of it."""

import numpy as np
import pytest

from s2glib.corpus import Part, appearances, parse_id, render_motion, render_video
from s2glib.data.detections import read_boxes, read_keypoints

FRAMES, PICTURE = 3, (64, 48)


@pytest.fixture
def points(rng):
    """All of COCO-WholeBody's: x, y, confidence."""
    return np.concatenate(
        [rng.uniform(2, 40, (FRAMES, 133, 2)), np.ones((FRAMES, 133, 1))], axis=-1
    )


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture
def keypoints(tmp_path):
    def read(numbers, frames=FRAMES):
        np.save(tmp_path / "keypoints.npy", numbers)
        return read_keypoints(tmp_path / "keypoints.npy", frames)

    return read


@pytest.fixture
def boxes(tmp_path):
    def read(numbers, frames=FRAMES):
        np.save(tmp_path / "hands.npy", numbers)
        return read_boxes(tmp_path / "hands.npy", frames, PICTURE)

    return read


def test_the_whole_body_is_taken_apart(points, keypoints):
    found = keypoints(points)
    np.testing.assert_array_equal(found.body, points[:, :13, :2])
    np.testing.assert_array_equal(found.face, points[:, 17 + 6 : 17 + 6 + 68, :2])
    np.testing.assert_array_equal(found.left_hand, points[:, -42:-21, :2])
    np.testing.assert_array_equal(found.right_hand, points[:, -21:, :2])


def test_the_papers_55_points_are_taken_apart(points, keypoints):
    found = keypoints(points[:, :55, :2].astype(np.float32))
    parts = (found.body, found.left_hand, found.right_hand)
    np.testing.assert_array_equal(np.concatenate(parts, axis=1), points[:, :55, :2].astype("f4"))
    np.testing.assert_array_equal(found.face, found.body[:, :5])


def test_what_the_detector_doubts_is_not_seen(points, keypoints):
    points[1, -21:, 2], points[2, 23:91, 2] = 0.2, np.nan
    found = keypoints(points)
    assert np.isnan(found.right_hand).all(axis=(1, 2)).tolist() == [False, True, False]
    assert np.isnan(found.face).all(axis=(1, 2)).tolist() == [False, False, True]
    assert np.isfinite(found.left_hand).all()


def test_without_confidence_nan_is_not_seen(points, keypoints):
    points[0, -42:-21] = np.nan
    found = keypoints(points[..., :2])
    assert (
        np.isnan(found.boxes["hands"]).all(axis=2).tolist() == [[True, False]] + [[False] * 2] * 2
    )


def test_boxes_around_keypoints_are_padded_by_their_longer_side(keypoints, points):
    points[:, -21:, :2] = 20
    points[:, -21, :2] = 30, 25
    points[:, 23:91, :2] = 10
    points[:, 23, :2] = 30, 14
    found = keypoints(points)
    np.testing.assert_allclose(found.boxes["hands"][0, 1], [18, 18, 32, 27])
    np.testing.assert_allclose(found.boxes["face"][0, 0], [6, -2, 34, 26])  # a square


@pytest.mark.parametrize("name", ["hands", "face"])
def test_boxes_around_true_keypoints_are_like_boxes_of_true_masks(keypoints, name):
    cell = parse_id("s04-voice_01-anger-t2")
    video = render_video(render_motion(cell), appearances(cell.speaker)[0], 96, 2)
    part = Part.RIGHT_HAND if name == "hands" else Part.FACE
    whole = (video.parts == part).sum(axis=(1, 2)) > 30
    found = keypoints((video.keypoints + 1) / 2 * 95, len(video.frames))
    overlaps = [
        overlap(box, true_box(mask))
        for box, mask in zip(found.boxes[name][whole, -1], video.parts[whole] == part, strict=True)
    ]
    assert np.mean(overlaps) > 0.7


def true_box(mask):
    rows, columns = np.nonzero(mask)
    return np.array([columns.min(), rows.min(), columns.max(), rows.max()])


def overlap(box, other):
    """Intersection over union."""
    sides = np.minimum(box, other)[2:] - np.maximum(box, other)[:2]
    shared = np.prod(sides.clip(0))
    return shared / (np.prod(box[2:] - box[:2]) + np.prod(other[2:] - other[:2]) - shared)


def test_boxes_keep_what_is_given(boxes):
    given = np.full((FRAMES, 2, 4), np.nan)
    given[0, 0], given[1] = (-4, 3, 10, 50), ((1, 2, 3, 4), (0, 0, 63, 47))
    np.testing.assert_array_equal(boxes(given), given)
    assert boxes(np.full((FRAMES, 0, 4), 1)).shape == (FRAMES, 0, 4)


@pytest.mark.parametrize(
    "box",
    [
        (5, 5, 4, 9),
        (5, 9, 6, 5),
        (64, 5, 70, 9),
        (-9, -9, -1, 9),
        (5, 5, np.nan, 9),
        (5, 5, 9, np.inf),
    ],
)
def test_boxes_that_cannot_be_are_refused(boxes, box):
    given = np.full((FRAMES, 1, 4), np.nan)
    given[1] = box
    with pytest.raises(ValueError, match="x0 <= x1 and y0 <= y1 inside a picture of 64 x 48 pixel"):
        boxes(given)


@pytest.mark.parametrize(
    ("shape", "reason"),
    [
        ((2, 1, 4), r"expected \(t, n, 4\) with t = 3, .* got \(2, 1, 4\); detect every frame"),
        ((3, 4), r"expected boxes \(t, n, 4\), x0, y0, x1, y1; got \(3, 4\)"),
        ((3, 1, 5), "expected boxes"),
        ((), r"with t = 3"),
    ],
)
def test_boxes_of_another_shape_are_refused(boxes, shape, reason):
    with pytest.raises(ValueError, match=reason):
        boxes(np.full(shape, 2.0))


def test_shares_of_the_picture_are_refused(boxes, keypoints, points):
    for read, numbers in (
        (boxes, np.array([[[0.1, 0.2, 0.5, 0.9]]] * FRAMES)),
        (keypoints, points[..., :2] / 64),
    ):
        with pytest.raises(ValueError, match=r"in pixels .* within -1 \.\. 1; multiply them"):
            read(numbers)


@pytest.mark.parametrize("shape", [(3, 54, 2), (3, 55, 3), (3, 133, 4), (3, 133), (3, 2, 133)])
def test_keypoints_of_another_shape_are_refused(keypoints, shape):
    with pytest.raises(ValueError, match=r"expected keypoints \(t, 55, 2\) .* got \(3, "):
        keypoints(np.full(shape, 2.0))


@pytest.mark.parametrize(("value", "numbers"), [(np.nan, 2), (np.inf, 2), (np.nan, 3)])
def test_a_part_that_is_seen_must_be_seen_whole(keypoints, points, value, numbers):
    points[1, -1, 0] = value
    with pytest.raises(ValueError, match="the right hand is seen in frame 1, but some of its poi"):
        keypoints(points[..., :numbers])


@pytest.mark.parametrize(
    "numbers", [np.array(["a"] * 3), np.array([{}] * 3), np.full((3, 55, 2), 2j)]
)
def test_arrays_without_numbers_are_refused(keypoints, numbers):
    with pytest.raises(ValueError, match=r"keypoints.npy is no array of numbers; save it anew"):
        keypoints(numbers)


@pytest.mark.parametrize("content", [b"", b"a letter", b"PK\x03\x04"])
def test_files_without_an_array_are_refused(tmp_path, content):
    path = tmp_path / "keypoints.npy"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"keypoints.npy is no array of numbers; save it anew"):
        read_keypoints(path, FRAMES)
