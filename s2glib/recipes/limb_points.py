"""Where keypoints could sit: five on each arm, hand and forearm, on the trunk and on the head.

Paper:    - (MDD learns its keypoints without labels; these are ours)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.body.keypoints2d import BODY_POINTS, HAND_POINTS
from s2glib.corpus import KEYPOINT_NAMES

LIMBS = (
    *(("left_shoulder", "left_elbow"), ("left_elbow", "left_wrist")),
    ("left_wrist", "left_middle_tip"),
    *(("right_shoulder", "right_elbow"), ("right_elbow", "right_wrist")),
    ("right_wrist", "right_middle_tip"),
    *(("left_shoulder", "right_shoulder"), ("left_ear", "right_ear")),
)
"""One for each group of keypoints: from where to where."""

ALONG = (0.0, 0.0, 0.5, 1.0, 1.0)  # shares of a limb
ASIDE = (0.05, -0.05, 0.0, 0.05, -0.05)  # image units: about half as wide as an arm
SHORTEST = 0.05  # image units; a limb that points at the camera has no direction

_LIMBS = torch.tensor([[KEYPOINT_NAMES.index(end) for end in limb] for limb in LIMBS])
_HANDS = len(BODY_POINTS)
_OTHER = {"left": "right", "right": "left", "nose": "nose"}


def _other_side(name: str) -> int:
    side, *rest = name.split("_")
    return BODY_POINTS.index("_".join([_OTHER[side], *rest]))


_SWAPPED = [
    *map(_other_side, BODY_POINTS),
    *range(_HANDS + HAND_POINTS, _HANDS + 2 * HAND_POINTS),
    *range(_HANDS, _HANDS + HAND_POINTS),
]


def limb_points(keypoints: Float[Tensor, "*b 55 2"]) -> Float[Tensor, "*b 8 5 2"]:
    """Two points abreast at each end of a limb, and one in its middle; NaN where ends are."""
    start, end = keypoints[..., _LIMBS[:, 0], :], keypoints[..., _LIMBS[:, 1], :]
    limb = end - start
    across = torch.stack([-limb[..., 1], limb[..., 0]], dim=-1)
    across = across / across.norm(dim=-1, keepdim=True).clamp_min(SHORTEST)
    along, aside = (keypoints.new_tensor(shares)[:, None] for shares in (ALONG, ASIDE))
    return start[..., None, :] + along * limb[..., None, :] + aside * across[..., None, :]


def mirrored_keypoints(keypoints: Float[Tensor, "*b 55 2"]) -> Float[Tensor, "*b 55 2"]:
    """Keypoints of the mirrored picture: left is right."""
    return keypoints[..., _SWAPPED, :] * keypoints.new_tensor([-1.0, 1.0])
