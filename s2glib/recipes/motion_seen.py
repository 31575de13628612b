"""Motion as two judges see it, and what its wrists do.

Paper:    AM D, E
Notebook: notebooks/17_motion_distances.ipynb
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from torch import Tensor

from s2glib.layers import in_batches
from s2glib.metrics import derivative_sizes
from s2glib.papers.amuse.front_end import MOTION_FPS
from s2glib.papers.amuse.motion_extractor import MotionExtractor, PositionJudge
from s2glib.papers.amuse.motion_features import SEEN_JOINTS

WRISTS = [SEEN_JOINTS.index("left_wrist"), SEEN_JOINTS.index("right_wrist")]


class Judges(NamedTuple):
    """M, and the judge that sees positions."""

    extractor: MotionExtractor
    positions: PositionJudge


class Seen(NamedTuple):
    """Windows of motion and what the judges make of them."""

    motion: Float[Tensor, "n frames features"]
    places: Float[np.ndarray, "n frames 9 3"]
    code: Float[np.ndarray, "n width"]  # M's features
    emotion: dict[str, Int[np.ndarray, " n"]]  # by judge


def look(judges: Judges, motion: Float[Tensor, "n frames features"]) -> Seen:
    """Show motion to the judges, as rotations that are rotations."""
    features = judges.extractor.features
    motion = in_batches(features.valid, motion)
    by_rotations, by_places = (in_batches(judge, motion) for judge in judges)
    called = {"M": by_rotations, "positions": by_places}
    return Seen(
        motion,
        in_batches(features.positions, motion).double().numpy(),
        by_rotations.features.numpy(),
        {name: judgement.logits.argmax(-1).numpy() for name, judgement in called.items()},
    )


def wrist_spread(seen: Seen) -> Float[np.ndarray, " n"]:
    """Standard deviation of the wrists' coordinates over time, metres."""
    return seen.places[:, :, WRISTS].std(axis=1).mean(axis=(1, 2))


def wrist_motion(seen: Seen, order: int) -> Float[np.ndarray, " n"]:
    """Mean size of a time derivative of the wrists: 1 is speed, 3 is jerk."""
    wrists = seen.places[:, :, WRISTS]
    return np.array([derivative_sizes(clip, MOTION_FPS, order=order).mean() for clip in wrists])
