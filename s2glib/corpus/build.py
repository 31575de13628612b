"""Rendering: one clip, or thousands at once into the cache.

Paper:    AM F
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import groupby
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Float16
from tqdm import tqdm

from s2glib.audio import Waveform, onset_times
from s2glib.body import FACE_CURVES
from s2glib.corpus.clock import Timing, readings, timing
from s2glib.corpus.gestures import render_gestures
from s2glib.corpus.intensity import intensity
from s2glib.corpus.script import Cell, check_cell, speech_take, split
from s2glib.corpus.speech import SAMPLE_RATE, render_speech
from s2glib.data.samples import Clip, Interval
from s2glib.data.windows import speech_window
from s2glib.folders import cache_folder

VERSION = 2  # of the generator: a new number leaves old caches alone
WINDOW = {"n_mels": 64, "frames": 352, "pool": 2}  # of cached speech


class Request(NamedTuple):
    """A cell to render, perhaps on another emotion's clock."""

    cell: Cell
    clock_of: str | None = None

    @property
    def key(self) -> str:
        """The clip's name, with the clock's emotion where that differs."""
        return self.cell.id if self.clock_of is None else f"{self.cell.id}@{self.clock_of}"


def timing_of(cell: Cell, clock_of: str | None = None) -> Timing:
    """The clock of a cell, or the clock it would have in the emotion `clock_of`."""
    reading = readings()[cell.sentence]
    return timing(reading, cell.sentence, clock_of or cell.emotion, speech_take(cell.take))


def render_clip(
    sentence: int, speaker: str, emotion: str, take: int, *, clock_of: str | None = None
) -> Clip:
    """Render one clip: speech, gestures, face and meaning.

    Args:
        sentence: 0 to 15.
        speaker: "voice_01" to "voice_30".
        emotion: one of `EMOTIONS`.
        take: 0, 1 (training), 2 (test); from 10 on only the motion differs.
        clock_of: keep the timing of this emotion, so that the clip can be compared with one of
            that emotion frame by frame.

    Raises:
        ValueError: if a factor is not in the script.
        ImportError: without the extra `corpus`.
    """
    return _render(Cell(sentence, speaker, emotion, take), clock_of, with_sound=True)


def render_motion(cell: Cell, *, clock_of: str | None = None) -> Clip:
    """Render a clip without its sound; this needs no extra."""
    return _render(cell, clock_of, with_sound=False)


def _render(cell: Cell, clock_of: str | None, *, with_sound: bool) -> Clip:
    check_cell(cell)
    if clock_of is not None:
        check_cell(cell._replace(emotion=clock_of))
    clock, strength = timing_of(cell, clock_of), intensity(cell)
    gesturing = render_gestures(cell, clock, strength)
    spoken = cell._replace(take=speech_take(cell.take))
    sound = Waveform(render_speech(spoken, clock, strength), SAMPLE_RATE) if with_sound else None
    return Clip(
        id=Request(cell, clock_of).key,
        **cell._asdict(),
        intensity=strength,
        waveform=sound,
        motion=gesturing.motion,
        words=_intervals(clock.words, clock.word_starts, clock.word_ends),
        phonemes=_intervals(clock.phonemes, clock.boundaries[:-1], clock.boundaries[1:]),
        semantic=gesturing.semantic,
        gesture_type=gesturing.gesture_type,
    )


def _intervals(names, starts, ends) -> tuple[Interval, ...]:
    return tuple(
        Interval(n, float(a), float(b)) for n, a, b in zip(names, starts, ends, strict=True)
    )


class SpeechSet(NamedTuple):
    """Log-mel windows of many clips, and how long each clip is."""

    windows: Float16[np.ndarray, "n frames mels"]
    seconds: Float[np.ndarray, " n"]


class MotionSet(NamedTuple):
    """Poses of many clips, and their frames a second."""

    poses: list[Float16[np.ndarray, "_ 55 3"]]
    fps: int


def speech_set(
    requests: Sequence[Request],
    window: dict[str, int] = WINDOW,
    *,
    processes: int | None = None,
) -> SpeechSet:
    """Speech windows of the requested clips, rendered where the cache lacks them.

    Args:
        requests: which clips.
        window: what `speech_window` is to cut: `n_mels`, `frames`, `pool`.
        processes: that render; as many as there are processors unless said.
    """
    size = "" if window == WINDOW else "-{frames}x{n_mels}x{pool}".format(**window)
    found = _gather(f"speech{size}", requests, partial(_render_windows, window), processes)
    return SpeechSet(
        np.stack([entry["window"] for entry in found]),
        np.array([float(entry["seconds"]) for entry in found]),
    )


def motion_set(wanted: Iterable[Cell | Request], *, processes: int | None = None) -> MotionSet:
    """Poses of the requested clips, rendered where the cache lacks them."""
    requests = [Request(each) if isinstance(each, Cell) else each for each in wanted]
    found = _gather("motion", requests, _render_poses, processes)
    return MotionSet([entry["poses"] for entry in found], 30)


def face_set(
    wanted: Iterable[Cell | Request], *, processes: int | None = None
) -> list[Float16[np.ndarray, "_ curves"]]:
    """`FACE_CURVES` of the requested clips, rendered where the cache lacks them."""
    requests = [Request(each) if isinstance(each, Cell) else each for each in wanted]
    return [entry["face"] for entry in _gather("face", requests, _render_face, processes)]


def onset_set(
    requests: Sequence[Request], *, processes: int | None = None
) -> list[Float[np.ndarray, " _"]]:
    """Seconds of the onsets in the requested clips' speech, rendered where the cache lacks them."""
    return [e["onsets"] for e in _gather("onsets", requests, _render_onsets, processes)]


def render_split(name: str) -> int:
    """Render a split into the cache, motion and (but for further performances) speech.

    Returns:
        How many clips it has.

    Raises:
        ValueError: if there is no such split.
    """
    cells = split(name)
    motion_set(cells)
    if name != "motion":
        speech_set([Request(cell) for cell in cells])
    return len(cells)


def _render_windows(window: dict[str, int], request: Request) -> dict[str, np.ndarray]:
    clock = timing_of(*request)
    samples = render_speech(request.cell, clock, intensity(request.cell))
    heard = speech_window(samples, **window).astype(np.float16)
    return {"window": heard, "seconds": np.array(clock.duration)}


def _render_onsets(request: Request) -> dict[str, np.ndarray]:
    samples = render_speech(request.cell, timing_of(*request), intensity(request.cell))
    return {"onsets": onset_times(samples, SAMPLE_RATE)}


def _render_poses(request: Request) -> dict[str, np.ndarray]:
    clip = render_motion(request.cell, clock_of=request.clock_of)
    return {"poses": clip.motion.poses.numpy().astype(np.float16)}


def _render_face(request: Request) -> dict[str, np.ndarray]:
    face = render_motion(request.cell, clock_of=request.clock_of).motion.expression
    return {"face": face[:, : len(FACE_CURVES)].numpy().astype(np.float16)}


def _gather(
    kind: str,
    requests: Sequence[Request],
    render: Callable[[Request], dict[str, np.ndarray]],
    processes: int | None,
) -> list[dict[str, np.ndarray]]:
    """Entries in the order of the requests; one cache file holds a sentence of a speaker."""

    def group(request: Request) -> tuple[int, str]:
        return request.cell.sentence, request.cell.speaker

    groups = [list(g) for _, g in groupby(sorted(set(requests), key=group), key=group)]
    jobs = [(_cache_file(kind, *group(members[0])), members, render) for members in groups]
    missing = [job for job in jobs if not _is_complete(*job[:2])]
    if missing:
        _render_all(kind, missing, processes or os.cpu_count() or 1)
    entries: dict[str, dict[str, np.ndarray]] = {}
    for path, members, _ in jobs:
        stored = np.load(path)
        for request in members:
            fields = [name for name in stored.files if name.startswith(f"{request.key}/")]
            entries[request.key] = {name.split("/")[1]: stored[name] for name in fields}
    return [entries[request.key] for request in requests]


def _render_all(kind: str, jobs: list, processes: int) -> None:
    with (
        ProcessPoolExecutor(processes, get_context("spawn"), torch.set_num_threads, (1,)) as pool,
        tqdm(total=len(jobs), desc=f"rendering {kind}", unit="group") as bar,
    ):
        for _ in pool.map(_render_group, *zip(*jobs, strict=True)):
            bar.update()


def _cache_file(kind: str, sentence: int, speaker: str) -> Path:
    return cache_folder() / f"{kind}-v{VERSION}" / f"s{sentence:02d}-{speaker}.npz"


def _stored_keys(path: Path) -> set[str]:
    if not path.exists():
        return set()
    with np.load(path) as stored:
        return {name.split("/")[0] for name in stored.files}


def _is_complete(path: Path, requests: list[Request]) -> bool:
    return {request.key for request in requests} <= _stored_keys(path)


def _render_group(path: Path, requests: list[Request], render) -> None:
    fields: dict[str, np.ndarray] = {}
    if path.exists():
        with np.load(path) as stored:
            fields = {name: stored[name] for name in stored.files}
    have = {name.split("/")[0] for name in fields}
    for request in requests:
        if request.key not in have:
            entry = render(request)
            fields |= {f"{request.key}/{name}": value for name, value in entry.items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(f".{os.getpid()}.tmp.npz")
    np.savez(unfinished, allow_pickle=False, **fields)
    unfinished.replace(path)
