"""Two-dimensional upper-body points from a detector, made comparable between frames.

Paper:    MDD Sup. C
Notebook: notebooks/19_judging_video.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor

BODY_POINTS: tuple[str, ...] = (
    *("nose", "left_eye", "right_eye", "left_ear", "right_ear", "left_shoulder"),
    *("right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist"),
    *("left_hip", "right_hip"),
)
"""The 13 upper-body points: the first 13 of COCO's 17."""

HAND_POINTS = 21
"""Points of a hand, its wrist first (COCO-WholeBody's and MediaPipe's order)."""

_PARTS = [len(BODY_POINTS), HAND_POINTS, HAND_POINTS]


def upper_body_points(
    points: Float[Tensor, "*b 55 2"],
    confidence: Float[Tensor, "*b 55"],
    *,
    center: tuple[float, float] = (128.0, 128.0),
    threshold: float = 0.3,
) -> Float[Tensor, "*b 55 2"]:
    """Align the hands with the wrists, and say where undetected parts are  [MDD Sup. C].

    Args:
        points: x, y in pixels: `BODY_POINTS`, then the left hand's 21, then the right hand's.
            Undetected ones may hold anything, NaN too.
        confidence: the detector's confidence in each point, in [0, 1].
        center: where all points go while no body is detected; the middle of a 256-pixel image.
        threshold: a part is detected if its mean confidence is above this (the paper does not
            say how it decides; ours).

    Raises:
        ValueError: if a point of a detected part is not finite.
    """
    body, *hands = points.split(_PARTS, dim=-2)
    seen, *hands_seen = (
        part.mean(dim=-1)[..., None, None] > threshold for part in confidence.split(_PARTS, dim=-1)
    )
    wrists = [body[..., BODY_POINTS.index(f"{side}_wrist"), None, :] for side in ("left", "right")]
    aligned = [
        torch.where(hand_seen, hand - hand[..., :1, :] + wrist, wrist)
        for hand, hand_seen, wrist in zip(hands, hands_seen, wrists, strict=True)
    ]
    result = torch.where(seen, torch.cat([body, *aligned], dim=-2), points.new_tensor(center))
    if not result.isfinite().all():
        raise ValueError("a detected part holds NaN or infinite points; set its confidence to 0")
    return result
