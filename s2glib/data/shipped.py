"""The clips that come with the workbook: 4 sentences x 4 voices x 8 emotions.

Paper:    AM F (a full factorial of content, style and emotion)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import torch

from s2glib.audio import load
from s2glib.body import Motion
from s2glib.data.samples import Clip, Interval
from s2glib.folders import data_folder

MANIFEST = "manifest.json"
CLIPS = "clips"
WINDOWS = "windows.npz"


@cache
def _manifest(folder: Path) -> dict[str, Any]:
    path = folder / MANIFEST
    if not path.exists():
        raise FileNotFoundError(
            f"no corpus in {folder}; set S2G_DATA to the folder that holds {MANIFEST}"
        )
    return json.loads(path.read_text(encoding="utf8"))


def clips(split: str = "shipped") -> list[str]:
    """The names of the clips of a split, such as "s04-voice_01-anger-t2".

    Args:
        split: "shipped" (these can be loaded), or "train", "validation", "test",
            "unseen-sentences", "unseen-speakers" (these can be rendered).

    Raises:
        ValueError: for another name.
        FileNotFoundError: if the data folder is not there.
    """
    splits = _manifest(data_folder())["splits"]
    if split not in splits:
        raise ValueError(f"splits are {', '.join(splits)}; got {split!r}")
    return list(splits[split])


def load_clip(clip_id: str) -> Clip:
    """Load a shipped clip: sound, motion, timings and meaning.

    Raises:
        ValueError: if the clip is not shipped, or its file was changed.
        FileNotFoundError: if the data folder is not there.
    """
    folder = data_folder()
    facts = _manifest(folder)["clips"].get(clip_id)
    if facts is None:
        raise ValueError(
            f"{clip_id!r} is not among the shipped clips; list them with s2glib.data.clips(), "
            "or render it with s2glib.corpus.render_motion"
        )
    sound, rest = (folder / CLIPS / f"{clip_id}.{ending}" for ending in ("flac", "npz"))
    for path in (sound, rest):
        _check(path, facts["sha256"][path.suffix[1:]])
    with np.load(rest) as stored:
        arrays = {name: stored[name] for name in stored.files}
    expression = np.zeros((len(arrays["poses"]), 100), np.float32)
    expression[:, : arrays["face"].shape[1]] = arrays["face"]
    tracks = {"poses": arrays["poses"], "trans": arrays["trans"], "expression": expression}
    single = {name: torch.from_numpy(x.astype(np.float32)) for name, x in tracks.items()}
    return Clip(
        id=clip_id,
        **{name: facts[name] for name in ("sentence", "speaker", "emotion", "take", "intensity")},
        waveform=load(sound),
        motion=Motion(**single, fps=facts["fps"]),
        words=_intervals(arrays, "word"),
        phonemes=_intervals(arrays, "phoneme"),
        semantic=arrays["semantic"].astype(np.float64),
        gesture_type=arrays["gesture_type"].astype(np.int64),
    )


def speech_windows() -> tuple[list[str], np.ndarray]:
    """Log-mel windows of take 0 of the shipped cells, for live training: names and (128, 352, 64).

    Raises:
        FileNotFoundError: if the data folder is not there.
    """
    folder = data_folder()
    _check(folder / WINDOWS, _manifest(folder)["windows_sha256"])
    with np.load(folder / WINDOWS) as stored:
        return list(stored["id"]), stored["window"].astype(np.float32)


def _check(path: Path, sha256: str) -> None:
    if not path.exists():
        raise FileNotFoundError(f"{path.name} is missing from {path.parent}; restore the data")
    if hashlib.sha256(path.read_bytes()).hexdigest() != sha256:
        raise ValueError(f"{path.name} is not the file that was shipped; restore the data")


def _intervals(arrays: dict[str, np.ndarray], kind: str) -> tuple[Interval, ...]:
    names, times = arrays[f"{kind}_names"], arrays[f"{kind}_times"]
    return tuple(
        Interval(str(name), float(start), float(end))
        for name, (start, end) in zip(names, times, strict=True)
    )
