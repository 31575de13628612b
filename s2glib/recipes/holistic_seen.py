"""Holistic motion as it is measured: where the joints are, and what FGD's networks make of it.

Paper:    PT B
Notebook: notebooks/17_motion_distances.ipynb
"""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from numpy.lib.stride_tricks import sliding_window_view
from torch import Tensor

from s2glib.body import axis_angle_to_matrix, forward_kinematics
from s2glib.body.skeleton import JOINT_NAMES, PARENTS, REST_JOINTS, joint
from s2glib.layers import in_batches
from s2glib.metrics import derivative_sizes
from s2glib.papers.probtalk.feature_autoencoder import SEEN, FeatureNets, split_windows
from s2glib.papers.probtalk.motion_features import POINTS, HolisticFeatures
from s2glib.papers.probtalk.speech_features import MOTION_FPS

BORDER = 2  # frames on either side of a border that belong to it
WRISTS = [joint("left_wrist"), joint("right_wrist")]
NINE = [joint(name) for name in POINTS]
"""Head, arms and hands: where the nine points that AMUSE's judges see are."""


def _other_side(name: str) -> str:
    side, _, rest = name.partition("_")
    return {"left": f"right_{rest}", "right": f"left_{rest}"}.get(side, name)


_MIRRORED = [JOINT_NAMES.index(_other_side(name)) for name in JOINT_NAMES]


class Seen(NamedTuple):
    """Windows of motion, and what is seen of them.

    Attributes:
        motion: standardised features; after a clip's end its last frame is held.
        joints: metres from the pelvis.
        codes: of half windows that lie within their clip, by each network of `FeatureNets`.
        lengths: frames of each clip that are not held.
    """

    motion: Float[Tensor, "n frames features"]
    joints: Float[np.ndarray, "n frames 55 3"]
    codes: dict[str, Float[np.ndarray, "m code"]]
    lengths: Int[np.ndarray, " n"]

    @property
    def nine(self) -> Float[np.ndarray, "n frames 9 3"]:
        """Head, arms and hands."""
        return self.joints[:, :, NINE]

    @property
    def own(self) -> list[Float[np.ndarray, "_ 55 3"]]:
        """The joints of each clip, without the frames that are held."""
        return [clip[:length] for clip, length in zip(self.joints, self.lengths, strict=True)]


def look(
    nets: FeatureNets, motion: Float[Tensor, "n frames features"], lengths: Int[np.ndarray, " n"]
) -> Seen:
    """See windows from the beginning of clips that have so many frames."""
    motion, lengths = held(motion, lengths), lengths.clip(max=motion.shape[1])
    places, codes = joint_places(nets.features, motion), half_codes(nets, motion, lengths)
    return Seen(motion, places, codes, lengths)


@torch.no_grad()
def half_codes(
    nets: FeatureNets, motion: Float[Tensor, "n frames features"], lengths: Int[np.ndarray, " n"]
) -> dict[str, Float[np.ndarray, "m code"]]:
    """What FGD's networks make of the windows' halves, but for those that leave their clip."""
    size = nets.config.frames
    ends = size * np.arange(1, motion.shape[1] // size + 1)
    within = torch.from_numpy((ends[:, None] <= lengths).reshape(-1))
    codes = [nets(windows) for windows in split_windows(motion, size)[within].split(256)]
    return {kind: torch.cat([code[kind] for code in codes]).double().numpy() for kind in SEEN}


def held(
    motion: Float[Tensor, "n frames features"], lengths: Int[np.ndarray, " n"]
) -> Float[Tensor, "n frames features"]:
    """After a clip's end its last frame is held, in real and in made motion alike."""
    frames = torch.arange(motion.shape[1]).minimum(torch.from_numpy(lengths)[:, None] - 1)
    return motion.gather(1, frames[..., None].expand_as(motion))


def joints_of(
    features: HolisticFeatures, motion: Float[Tensor, "*b features"]
) -> Float[Tensor, "*b 55 3"]:
    """Where the joints are, metres from the pelvis, which does not turn."""
    turns = axis_angle_to_matrix(features.to_poses(motion))
    places = forward_kinematics(turns, torch.from_numpy(REST_JOINTS).to(motion), PARENTS).positions
    return places - places[..., :1, :]


def joint_places(
    features: HolisticFeatures, motion: Float[Tensor, "n frames features"]
) -> Float[np.ndarray, "n frames 55 3"]:
    """The joints of many windows, a few windows at a time."""
    return in_batches(partial(joints_of, features), motion, size=16).double().numpy()


def mirrored(joints: Float[np.ndarray, "*b 55 3"]) -> Float[np.ndarray, "*b 55 3"]:
    """The same movement with left and right exchanged."""
    return joints[..., _MIRRORED, :] * np.array([-1.0, 1.0, 1.0])


def border_errors(
    real: Float[np.ndarray, "n frames joints 3"],
    made: Float[np.ndarray, "n frames joints 3"],
    known: Bool[np.ndarray, "n frames"],
) -> Float[np.ndarray, " n"]:
    """How wrongly motion crosses the borders between frames that were given and made, m/s^2.

    Length of the difference of accelerations, mean over joints and over the frames that lie within
    `BORDER` frames of a border on either side.

    Raises:
        ValueError: if a clip has no border.
    """
    apart = np.stack([derivative_sizes(clip, MOTION_FPS, order=2) for clip in made - real])
    borders = np.pad(known[:, 1:] != known[:, :-1], ((0, 0), (BORDER - 1, BORDER - 1)))
    near = sliding_window_view(borders, 2 * BORDER, axis=1).any(-1)  # at frames 1, 2, ...
    count = near.sum(1)
    if not count.all():
        raise ValueError(
            "expected a border between frames that are given and made in every clip; clip "
            f"{count.argmin()} has none: leave it out, or give some of its frames"
        )
    return (apart.mean(-1) * near).sum(1) / count


def wrist_agreement(clips: Sequence[Float[np.ndarray, "_ 55 3"]]) -> Float[np.ndarray, " n"]:
    """Correlation of the speeds of the left and the right wrist in each clip; 0 where one rests."""
    found = []
    for clip in clips:
        speeds = derivative_sizes(clip[:, WRISTS], MOTION_FPS, order=1)
        apart = speeds - speeds.mean(axis=0)
        found.append(apart.prod(axis=-1).mean() / max(apart.std(axis=0).prod(), 1e-9))
    return np.array(found)
