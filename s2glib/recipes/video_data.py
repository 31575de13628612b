"""Films for the video stages: clips of four speakers, rendered once, and random pairs of frames.

Paper:    MDD 4.1 (25 fps), B.5 (four speakers jointly), I (several looks of each)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from einops import rearrange
from jaxtyping import Bool, Float, Float16, UInt8
from torch import Tensor
from tqdm import tqdm

from s2glib.corpus import (
    KEYPOINT_NAMES,
    Appearance,
    Cell,
    Part,
    appearances,
    render_motion,
    render_video,
)
from s2glib.corpus.build import VERSION
from s2glib.corpus.script import SHIPPED_SPEAKERS, split
from s2glib.folders import cache_folder

FPS = 25  # [MDD 4.1]
TRAIN_CLIPS, TEST_CLIPS = 32, 6  # of each speaker
WRISTS = [KEYPOINT_NAMES.index(f"{side}_wrist") for side in ("left", "right")]


class Scene(NamedTuple):
    """What is gestured, and who is seen gesturing it."""

    cell: Cell
    appearance: Appearance


class Film(NamedTuple):
    """A clip as pictures, which part of the speaker every pixel shows, and its true keypoints.

    Where they are not known, parts are background and keypoints NaN.
    """

    frames: UInt8[np.ndarray, "t h w 3"]
    parts: UInt8[np.ndarray, "t h w"]
    keypoints: Float16[np.ndarray, "t 55 2"]


class FramePairs(NamedTuple):
    """Sources and drivings, as rows of a `VideoFrames`, and the clip both are from."""

    source: np.ndarray
    driving: np.ndarray
    clips: np.ndarray


def scenes(name: str, per_speaker: int) -> list[Scene]:
    """The same few clips of each filmed speaker in a split, in the two looks by turns."""
    rng = np.random.default_rng(0)
    chosen: list[Scene] = []
    for speaker in SHIPPED_SPEAKERS:
        cells = [cell for cell in split(name) if cell.speaker == speaker]
        rows = sorted(rng.permutation(len(cells))[:per_speaker])
        looks = appearances(speaker)
        chosen += [Scene(cells[row], looks[k % 2]) for k, row in enumerate(rows)]
    return chosen


def films(shots: Sequence[Scene], size: int, *, processes: int | None = None) -> list[Film]:
    """The scenes filmed at `size` pixels, rendered where the cache lacks them."""
    missing = [scene for scene in shots if not _file(scene, size).exists()]
    if missing:
        context = get_context("spawn")
        with (
            ProcessPoolExecutor(
                processes or os.cpu_count() or 1, context, torch.set_num_threads, (1,)
            ) as pool,
            tqdm(total=len(missing), desc=f"filming at {size} pixels", unit="clip") as bar,
        ):
            for _ in pool.map(_shoot, missing, [size] * len(missing)):
                bar.update()
    return [_read(_file(scene, size)) for scene in shots]


def _file(scene: Scene, size: int) -> Path:
    look = scene.appearance.name.replace("/", "")
    return cache_folder() / f"video-v{VERSION}" / str(size) / f"{scene.cell.id}-{look}.npz"


def _shoot(scene: Scene, size: int) -> None:
    video = render_video(render_motion(scene.cell), scene.appearance, size, FPS)
    path = _file(scene, size)
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(f".{os.getpid()}.tmp.npz")
    keypoints = video.keypoints.astype(np.float16)
    np.savez_compressed(unfinished, frames=video.frames, parts=video.parts, keypoints=keypoints)
    unfinished.replace(path)


def _read(path: Path) -> Film:
    with np.load(path) as stored:
        return Film(*(stored[name] for name in Film._fields))


class VideoFrames:
    """All frames of many films in a row, as bytes.

    Attributes:
        frames: (n, 3, h, w), bytes.
        parts: (n, h, w), see `corpus.Part`.
        keypoints: (n, 55, 2), true ones, or NaN.
        starts: the first row of each clip.
        lengths: how many frames each clip has.
        motion: (clips, 1, h, w), how much each pixel changes over its clip (0 .. 1).
    """

    def __init__(self, clips: Sequence[Film]):
        self.lengths = np.array([len(film.frames) for film in clips])
        self.starts = np.concatenate([[0], np.cumsum(self.lengths)[:-1]])
        self.frames = torch.from_numpy(np.concatenate([film.frames for film in clips]))
        self.frames = rearrange(self.frames, "n h w c -> n c h w").contiguous()
        self.parts = torch.from_numpy(np.concatenate([film.parts for film in clips]))
        keypoints = np.concatenate([film.keypoints for film in clips])
        self.keypoints = torch.from_numpy(keypoints).float()
        self.motion = torch.stack([pixel_motion(film.frames) for film in clips])

    @property
    def has_keypoints(self) -> bool:
        """Whether those of all frames are known."""
        return bool(self.keypoints.isfinite().all())

    def images(self, rows: np.ndarray | Tensor) -> Float[Tensor, "batch 3 h w"]:
        """Pictures in 0 .. 1."""
        return self.frames[rows].float() / 255

    def hands(self, rows: np.ndarray) -> Float[Tensor, "batch 1 h w"]:
        """1 where a hand is seen."""
        return (self.parts[rows] >= Part.LEFT_HAND)[:, None].float()

    def faces(self, rows: np.ndarray) -> Float[Tensor, "batch 1 h w"]:
        """1 where the face is seen."""
        return (self.parts[rows] == Part.FACE)[:, None].float()

    def pairs(self, count: int, rng: np.random.Generator, *, furthest: int) -> FramePairs:
        """Two frames of one clip, at most `furthest` frames apart."""
        clips = rng.integers(len(self.starts), size=count)
        here = (rng.random(count) * self.lengths[clips]).astype(int)
        step = rng.integers(-furthest, furthest + 1, size=count)
        there = np.clip(here + step, 0, self.lengths[clips] - 1)
        return FramePairs(self.starts[clips] + here, self.starts[clips] + there, clips)

    def moving(self, clips: np.ndarray) -> Float[Tensor, "batch 1 h w"]:
        """1 in the quarter of the pixels that change most over a clip."""
        return moving_quarter(self.motion[clips]).float()

    def restless_places(self, count: int, rng: np.random.Generator) -> Float[np.ndarray, "count 2"]:
        """Places drawn in proportion to how much is going on there; x then y, -1 .. 1."""
        density = self.motion.square().mean(dim=(0, 1)).double().numpy()
        height, width = density.shape
        drawn = rng.choice(density.size, size=count, p=density.ravel() / density.sum())
        row, column = np.divmod(drawn, width)
        places = np.stack([column / (width - 1), row / (height - 1)], axis=-1) * 2 - 1
        return places + rng.uniform(-1, 1, places.shape) / width


def pixel_motion(frames: UInt8[np.ndarray, "t h w 3"]) -> Float[Tensor, "1 h w"]:
    """Standard deviation of each pixel over a clip, all colours together."""
    return torch.from_numpy((frames / np.float32(255)).var(axis=0).mean(axis=-1) ** 0.5)[None]


def moving_quarter(motion: Float[Tensor, "batch 1 h w"]) -> Bool[Tensor, "batch 1 h w"]:
    """The pixels above the third quartile of each picture."""
    return motion > motion.flatten(1).quantile(0.75, dim=1)[:, None, None, None]


def starting_keypoints(
    video: VideoFrames, transforms: int, points: int, rng: np.random.Generator
) -> Float[Tensor, "k n 2"]:
    """Groups of places where something moves: clusters of restless places, and a few of each."""
    places = video.restless_places(2000, rng)
    centres = places[:transforms]
    for _ in range(20):  # k-means
        nearest = np.linalg.norm(places[:, None] - centres, axis=-1).argmin(axis=1)
        centres = np.stack([places[nearest == k].mean(axis=0) for k in range(transforms)])
    groups = [rng.choice(places[nearest == k], size=points) for k in range(transforms)]
    return torch.from_numpy(np.stack(groups)).float().clamp(-0.98, 0.98)
