import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.body import BODY_POINTS, HAND_POINTS, upper_body_points

BODY, LEFT, RIGHT = slice(0, 13), slice(13, 34), slice(34, 55)
LEFT_WRIST, RIGHT_WRIST = BODY_POINTS.index("left_wrist"), BODY_POINTS.index("right_wrist")


def detection(frames=6, seed=0):
    generator = torch.Generator().manual_seed(seed)
    points = 256 * torch.rand(frames, 55, 2, generator=generator, dtype=torch.float64)
    return points, torch.ones(frames, 55, dtype=torch.float64)


def test_the_55_points_are_13_and_two_hands():
    assert len(BODY_POINTS) + 2 * HAND_POINTS == 55


@given(st.integers(0, 1000))
def test_hands_keep_their_shape_and_hang_on_the_wrists(seed):
    points, confidence = detection(seed=seed)
    ours = upper_body_points(points, confidence)
    torch.testing.assert_close(ours[:, BODY], points[:, BODY])
    for hand, wrist in ((LEFT, LEFT_WRIST), (RIGHT, RIGHT_WRIST)):
        torch.testing.assert_close(ours[:, hand][:, 0], points[:, wrist])
        torch.testing.assert_close(
            ours[:, hand].diff(dim=-2), points[:, hand].diff(dim=-2), atol=1e-9, rtol=0.0
        )


def test_aligning_twice_changes_nothing():
    points, confidence = detection()
    once = upper_body_points(points, confidence)
    torch.testing.assert_close(upper_body_points(once, confidence), once)


@pytest.mark.parametrize("filler", [0.0, float("nan"), float("inf")])
def test_a_missing_hand_lies_on_its_wrist(filler):
    points, confidence = detection()
    whole = upper_body_points(points, confidence)
    points[2, LEFT], confidence[2, LEFT] = filler, 0.0
    ours = upper_body_points(points, confidence)
    torch.testing.assert_close(ours[2, LEFT], points[2, [LEFT_WRIST] * 21])
    ours[2, LEFT] = whole[2, LEFT]
    torch.testing.assert_close(ours, whole)


@pytest.mark.parametrize("center", [(128.0, 128.0), (320.0, 180.0)])
def test_without_a_body_all_points_are_at_the_centre(center):
    points, confidence = detection()
    points[4, BODY], confidence[4, BODY] = float("nan"), 0.0
    ours = upper_body_points(points, confidence, center=center)
    assert ours[4].tolist() == [list(center)] * 55
    assert ours[:4].tolist() == upper_body_points(points[:4], confidence[:4]).tolist()


@given(st.floats(0, 1), st.floats(0, 1))
def test_a_part_is_seen_above_the_threshold(score, threshold):
    points, confidence = detection(frames=1)
    confidence[:, RIGHT] = score
    ours = upper_body_points(points, confidence, threshold=threshold - 1e-6)
    collapsed = ours[0, RIGHT].diff(dim=-2).abs().max() == 0
    body_is_seen = threshold - 1e-6 < 1
    assert collapsed == (not (body_is_seen and confidence[0, RIGHT].mean() > threshold - 1e-6))


def test_leading_axes_and_dtype_are_kept():
    points, confidence = detection(frames=6)
    clips = upper_body_points(points.float().view(2, 3, 55, 2), confidence.float().view(2, 3, 55))
    assert clips.dtype == torch.float32
    torch.testing.assert_close(
        clips.flatten(0, 1), upper_body_points(points.float(), confidence.float())
    )


def test_a_detected_part_without_a_place_is_refused():
    points, confidence = detection()
    points[1, LEFT.start + 3] = float("nan")
    with pytest.raises(ValueError, match="set its confidence to 0"):
        upper_body_points(points, confidence)


def test_no_frames_give_no_frames():
    points, confidence = detection(frames=0)
    assert upper_body_points(points, confidence).shape == (0, 55, 2)
