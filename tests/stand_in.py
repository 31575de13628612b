"""A quick body of capsules, a motion and a tone, for tests of what draws and plays them."""

import numpy as np
import torch
import trimesh

from s2glib.audio import Waveform
from s2glib.body import FACE_CURVES, PARENTS, PELVIS_HEIGHT, REST_JOINTS, BodyModel, Motion, joint

FPS = 30


def capsule_body() -> BodyModel:
    """Every bone a capsule that also leans on its neighbours, so that blending is seen."""
    rng = np.random.default_rng(0)
    parts = [_bone(child, parent) for child, parent in enumerate(PARENTS) if parent >= 0]
    vertices = np.concatenate([part.vertices for part, _, _ in parts])
    starts = np.cumsum([0, *(len(part.vertices) for part, _, _ in parts)])
    faces = [part.faces + start for (part, _, _), start in zip(parts, starts, strict=False)]
    weights = np.concatenate([_shares(part, child, parent) for part, child, parent in parts])
    directions = rng.normal(0, 0.01, (len(vertices), 3, len(FACE_CURVES)))
    directions[vertices[:, 1] < 0.5] = 0  # only the face moves
    return BodyModel(
        vertices=torch.tensor(vertices, dtype=torch.float32),
        faces=torch.tensor(np.concatenate(faces)),
        weights=torch.tensor(weights, dtype=torch.float32),
        joints=torch.tensor(REST_JOINTS, dtype=torch.float32),
        parents=PARENTS,
        colors=torch.tensor(0.4 + vertices[:, 1:2] / 3 + [[0.1, 0.0, -0.1]], dtype=torch.float32),
        expression_directions=torch.tensor(directions, dtype=torch.float32),
    )


def _bone(child: int, parent: int) -> tuple[trimesh.Trimesh, int, int]:
    start, end = REST_JOINTS[parent], REST_JOINTS[child]
    length = np.linalg.norm(end - start)
    thick = 0.1 if child in (3, 6, 9, 12, 15) else min(0.05, 0.4 * length)
    part = trimesh.creation.capsule(height=length, radius=thick, count=[8, 8])
    part.apply_translation(-part.bounds.mean(axis=0))
    part.apply_transform(trimesh.geometry.align_vectors([0, 0, 1], (end - start) / length))
    part.apply_translation((start + end) / 2)
    return part, child, parent


def _shares(part: trimesh.Trimesh, child: int, parent: int) -> np.ndarray:
    start, end = REST_JOINTS[parent], REST_JOINTS[child]
    along = np.clip((part.vertices - start) @ (end - start) / ((end - start) ** 2).sum(), 0, 1)
    shares = np.zeros((len(along), 55))
    shares[:, parent] = 1 - along / 2
    shares[:, child] = along / 2
    return shares


def waving_motion(frames: int = 90, *, reach: float = 1.0) -> Motion:
    """Both arms wave, the head turns, the jaw and the face move."""
    seconds = torch.arange(frames) / FPS
    poses, expression = torch.zeros(frames, 55, 3), torch.zeros(frames, 100)
    for side, sign in (("left", -1.0), ("right", 1.0)):
        poses[:, joint(f"{side}_shoulder"), 2] = sign * (1.1 - 0.4 * reach * (4 * seconds).sin())
        poses[:, joint(f"{side}_elbow"), 1] = sign * (1.2 + 0.5 * reach * (5 * seconds).cos())
        poses[:, joint(f"{side}_index1"), 2] = sign * 0.5
    poses[:, joint("head"), 1] = 0.3 * (2 * seconds).sin()
    poses[:, joint("jaw"), 0] = 0.1 + 0.1 * (20 * seconds).sin()
    expression[:, :4] = (3 * seconds).sin().square()[:, None]
    trans = torch.tensor([0.02, PELVIS_HEIGHT, 0.01]).repeat(frames, 1)
    return Motion(poses, trans, expression, FPS)


def tone(seconds: float = 3.0, *, pitch: float = 220.0) -> Waveform:
    """A quiet sine."""
    time = np.arange(round(16000 * seconds)) / 16000
    return Waveform((0.1 * np.sin(2 * np.pi * pitch * time)).astype(np.float32), 16000)
