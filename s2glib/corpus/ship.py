"""Write what the workbook ships: clips, live-training windows, the clock, and a manifest.

Paper:    AM F
Notebook: notebooks/21_cost_and_harm.ipynb
"""

import hashlib
import json
from pathlib import Path
from zipfile import ZIP_BZIP2, ZipFile

import numpy as np
from jaxtyping import Shaped
from tqdm import tqdm

from s2glib.audio import save
from s2glib.body import FACE_CURVES
from s2glib.corpus.build import Request, render_clip, speech_set
from s2glib.corpus.clock import readings
from s2glib.corpus.script import SENTENCES, SPEAKERS, split
from s2glib.corpus.speech import canonical_reading
from s2glib.data.samples import Clip
from s2glib.data.shipped import CLIPS, MANIFEST, WINDOWS

LISTED = ("shipped", "train", "validation", "test", "unseen-sentences", "unseen-speakers")


def write_clock(folder: Path) -> None:
    """Let all voices read all sentences, and write their mean timing (a few minutes)."""
    entries = []
    for sentence in tqdm(range(len(SENTENCES)), desc="phoneme clock", unit="sentence"):
        reading = canonical_reading(sentence, SPEAKERS)
        durations = [round(float(seconds), 5) for seconds in reading.durations]
        entries.append({**reading._asdict(), "durations": durations})
    text = json.dumps(entries, ensure_ascii=False) + "\n"
    (folder / "clock.json").write_text(text, encoding="utf8")
    readings.cache_clear()


def write_samples(folder: Path) -> None:
    """Render and write the shipped clips, the live-training windows and the manifest.

    Raises:
        ImportError: without the extra `corpus`.
    """
    (folder / CLIPS).mkdir(parents=True, exist_ok=True)
    facts = {}
    for cell in tqdm(split("shipped"), desc="shipped clips", unit="clip"):
        clip = render_clip(*cell)
        facts[cell.id] = {**_facts(clip), "sha256": _write_clip(folder / CLIPS, clip)}
    takes = [cell._replace(take=0) for cell in split("shipped")]
    windows = speech_set([Request(cell) for cell in takes]).windows
    write_windows(folder / WINDOWS, [cell.id for cell in takes], windows)
    manifest = {
        "version": 1,
        "licence": "CC0-1.0",
        "sentences": [sentence.text for sentence in SENTENCES],
        "clips": facts,
        "splits": {name: [cell.id for cell in split(name)] for name in LISTED},
        "windows_sha256": _sha256(folder / WINDOWS),
    }
    text = json.dumps(manifest, indent=0, ensure_ascii=False) + "\n"
    (folder / MANIFEST).write_text(text, encoding="utf8")


def write_windows(path: Path, names: list[str], windows: Shaped[np.ndarray, "n t mels"]) -> None:
    """Log-mels to an eighth, which is lost in their spread of 3.4 and halves the file."""
    rounded = (np.round(windows.astype(np.float32) * 8) / 8).astype(np.float16)
    with ZipFile(path, "w", ZIP_BZIP2) as archive:
        for name, array in (("id", np.array(names)), ("window", rounded)):
            with archive.open(f"{name}.npy", "w") as file:
                np.lib.format.write_array(file, array)


def _facts(clip: Clip) -> dict[str, object]:
    names = ("sentence", "speaker", "emotion", "take", "intensity")
    return {**{name: getattr(clip, name) for name in names}, "fps": clip.motion.fps}


def _write_clip(folder: Path, clip: Clip) -> dict[str, str]:
    """Write sound and the rest; give back their checksums."""
    assert clip.waveform is not None
    sound, rest = (folder / f"{clip.id}.{ending}" for ending in ("flac", "npz"))
    save(sound, clip.waveform)
    motion = clip.motion
    np.savez_compressed(
        rest,
        poses=motion.poses.half().numpy(),
        trans=motion.trans.numpy(),
        face=motion.expression[:, : len(FACE_CURVES)].half().numpy(),
        semantic=clip.semantic.astype(np.float16),
        gesture_type=clip.gesture_type.astype(np.uint8),
        word_names=np.array([word.name for word in clip.words]),
        word_times=np.array([(word.start, word.end) for word in clip.words]),
        phoneme_names=np.array([phoneme.name for phoneme in clip.phonemes]),
        phoneme_times=np.array([(phoneme.start, phoneme.end) for phoneme in clip.phonemes]),
    )
    return {"flac": _sha256(sound), "npz": _sha256(rest)}


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
