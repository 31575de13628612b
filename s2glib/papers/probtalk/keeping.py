"""Keeping: frames and parts of a given motion stand in the result bit for bit, and meet the rest.

Paper:    PT Eq. 8 (what is known stays); parts of the body, and easing: ours
Notebook: notebooks/07_refiner.ipynb
"""

import math

import torch
from jaxtyping import Bool, Float, Shaped
from torch import Tensor

from s2glib.body import Motion
from s2glib.body.skeleton import JOINT_NAMES, PELVIS_HEIGHT, joint
from s2glib.papers.probtalk.motion_features import JOINTS_OF, PARTS
from s2glib.papers.probtalk.speech_features import MOTION_FPS

EASE = 8  # frames over which made motion leaves what it has to meet
_FACE, _BODY = PARTS.index("face"), PARTS.index("body")
_EYES = [joint("left_eye"), joint("right_eye")]
_DRAWN = {number for joints in JOINTS_OF.values() for number in joints}
_LEGS = [number for number in range(joint("jaw")) if number not in _DRAWN]  # and the pelvis


def check_known(known: Motion) -> None:
    """Refuse what is no motion.

    Raises:
        TypeError: if it is no Motion.
    """
    if not isinstance(known, Motion):
        raise TypeError(f"known must be a Motion, got {type(known).__name__}")


def kept_parts(
    known: Motion | None, context_mask: Bool[Tensor, "frames 4"] | None, frames: int
) -> Bool[Tensor, "frames 4"]:
    """Which parts of which frames are kept; all that a known motion has, unless a mask says less.

    Raises:
        TypeError: if the known motion is none, or the mask not one of bools.
        ValueError: if the two do not fit each other or the speech.
    """
    if known is None:
        if context_mask is not None:
            raise ValueError("a context_mask says what to keep of a known motion; give one")
        return torch.zeros(frames, len(PARTS), dtype=torch.bool)
    check_known(known)
    if known.fps != MOTION_FPS:
        raise ValueError(f"known must have {MOTION_FPS} frames a second, got {known.fps:g}")
    has = torch.arange(frames) < known.frames
    if context_mask is None:
        return has[:, None].repeat(1, len(PARTS))
    if not isinstance(context_mask, Tensor) or context_mask.dtype != torch.bool:
        raise TypeError("context_mask must be a tensor of bools, true where motion is kept")
    if context_mask.shape != (frames, len(PARTS)):
        raise ValueError(
            f"context_mask must be ({frames}, {len(PARTS)}), the frames of the speech and "
            f"{', '.join(PARTS)}; got {tuple(context_mask.shape)}"
        )
    if context_mask[~has].any():
        raise ValueError(
            f"context_mask keeps frames that known has not: it ends after {known.frames} frames"
        )
    return context_mask


def to_length(track: Shaped[Tensor, "n ..."], frames: int) -> Shaped[Tensor, "frames ..."]:
    """The first frames of a track; where it is shorter, its last frame is held."""
    return track[torch.arange(frames).clamp_max(len(track) - 1)]


def embody(
    poses: Float[Tensor, "frames 55 3"],
    expression: Float[Tensor, "frames 100"],
    known: Motion | None,
    kept: Bool[Tensor, "frames 4"],
) -> Motion:
    """Stand a body up that moves as was made, and as is known where that is kept.

    Legs, pelvis and its place belong to the body, and the eyes to the face, but nobody makes them:
    without a known motion they rest, else they go straight from one kept frame to the next.
    """
    frames = len(poses)
    trans = poses.new_tensor([0.0, PELVIS_HEIGHT, 0.0]).repeat(frames, 1)
    if known is None or not kept.any():
        return Motion(poses, trans, expression, MOTION_FPS)
    given = [to_length(track, frames) for track in (known.poses, known.trans, known.expression)]
    kept_joints = torch.zeros(frames, len(JOINT_NAMES), 1, dtype=torch.bool)
    for column, part in enumerate(PARTS):
        kept_joints[:, JOINTS_OF[part], 0] = kept[:, column, None]
    poses = torch.where(kept_joints, given[0], poses.to(given[0]))
    expression = torch.where(kept[:, _FACE, None], given[2], expression.to(given[2]))
    trans = trans.to(given[1])
    for joints, column in ((_LEGS, _BODY), (_EYES, _FACE)):
        poses[:, joints] = bridged(given[0][:, joints], poses[:, joints], kept[:, column])
    return Motion(poses, bridged(given[1], trans, kept[:, _BODY]), expression, MOTION_FPS)


def bridged(
    given: Float[Tensor, "frames ..."],
    made: Float[Tensor, "frames ..."],
    kept: Bool[Tensor, " frames"],
) -> Float[Tensor, "frames ..."]:
    """What is given where it is kept, and straight lines between; `made` if nothing is."""
    places = kept.nonzero()[:, 0]
    if not len(places):
        return made
    frame = torch.arange(len(kept), device=kept.device)
    after = torch.searchsorted(places, frame).clamp_max(len(places) - 1)
    before = (torch.searchsorted(places, frame, right=True) - 1).clamp_min(0)
    low, high = places[before], places[after]
    share = ((frame - low).to(given) / (high - low).clamp_min(1)).clamp(0, 1)
    share = share.view(-1, *[1] * (given.ndim - 1))
    return given[low] * (1 - share) + given[high] * share


def eased(
    given: Float[Tensor, "batch frames size"],
    made: Float[Tensor, "batch frames size"],
    known: Bool[Tensor, "batch frames size"],
) -> Float[Tensor, "batch frames size"]:
    """What is known, and what was made, which begins and ends where it meets what is known.

    How far the two are apart at a border is taken back over `EASE` frames.
    """
    apart = torch.where(known, given - made, 0.0)
    error, weight = _carried(apart, known)
    error_after, weight_after = (track.flip(1) for track in _carried(apart.flip(1), known.flip(1)))
    share = (weight + weight_after).clamp_min(1)
    step = (error * weight + error_after * weight_after) / share
    return torch.where(known, given, made + step)


def _carried(
    apart: Float[Tensor, "batch frames size"], known: Bool[Tensor, "batch frames size"]
) -> tuple[Float[Tensor, "batch frames size"], Float[Tensor, "batch frames size"]]:
    """The difference at the last known frame, and how much of it is left after so many frames."""
    frame = torch.arange(known.shape[1], device=known.device)[:, None]
    last = torch.where(known, frame, -EASE - 1).cummax(dim=1).values
    distance = ((frame - last) / (EASE + 1)).clamp_max(1)
    return apart.gather(1, last.clamp_min(0)), 0.5 + 0.5 * (math.pi * distance).cos()
