"""Clips that many tests look at, rendered once."""

import numpy as np
import pytest
import torch

from s2glib.body import PARENTS, REST_JOINTS, axis_angle_to_matrix, forward_kinematics, joint
from s2glib.corpus import EMOTIONS, SPEAKERS, Cell, render_clip, render_motion


@pytest.fixture(scope="session")
def clips():
    """32 motions from all over the corpus: every emotion four times."""
    rng = np.random.default_rng(11)
    cells = [
        Cell(int(rng.integers(16)), str(rng.choice(SPEAKERS)), emotion, int(rng.integers(20)))
        for emotion in 4 * EMOTIONS
    ]
    return [render_motion(cell) for cell in cells]


@pytest.fixture(scope="session")
def pose_body():
    """Global rotations and positions (metres from the pelvis) of every joint of some poses."""
    rest = torch.from_numpy(REST_JOINTS).float()
    return lambda poses: forward_kinematics(axis_angle_to_matrix(poses), rest, PARENTS)


@pytest.fixture(scope="session")
def bodies(clips, pose_body):
    return [pose_body(clip.motion.poses) for clip in clips]


@pytest.fixture(scope="session")
def in_chest():
    """Points given in the pelvis' frame, as the chest (spine3) sees them."""

    def turn(body, points):
        chest = joint("spine3")
        moved = points - body.positions[:, chest]
        return (moved[:, None] @ body.rotations[:, chest])[:, 0].numpy()

    return turn


@pytest.fixture(scope="session")
def spoken():
    """One sentence by a low and by a high voice, in three emotions, on neutral's clock."""
    return {
        (speaker, emotion): render_clip(1, speaker, emotion, 2, clock_of="neutral")
        for speaker in ("voice_01", "voice_05")
        for emotion in ("neutral", "sadness", "surprise")
    }
