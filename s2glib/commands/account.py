"""The account of a job: what went in, what came out, and what it was made with.

Paper:    -
Notebook: -
"""

import platform
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import torch

import s2glib
from s2glib.audio import Waveform
from s2glib.body import BodyModel, Motion, joint, joint_positions
from s2glib.commands.job import Job
from s2glib.corpus.script import EMOTIONS
from s2glib.papers.amuse.pipeline import Amuse, Heard


def describe_job(job: Job, sounds: Mapping[str, Waveform]) -> dict[str, Any]:
    """What was asked for."""
    files = {"speech": job.speech, **job.donors}
    return {
        "system": "amuse",
        "told": job.told,
        "inputs": {
            name: {"file": str(path), "seconds": sounds[name].duration}
            for name, path in files.items()
        },
        "options": {
            "emotion": job.emotion if isinstance(job.emotion, str) else None,
            "checkpoints": str(job.checkpoints),
        },
        "seed": job.seed,
        "swapped": job.swapped,
        "kept": job.kept,
    }


def describe_result(
    amuse: Amuse, heard: Heard, motions: Mapping[str, Motion], body: BodyModel
) -> dict[str, Any]:
    """What came out, by which sampling, on which versions."""
    motion = next(iter(motions.values()))
    return {
        "recognised_emotion": recognised_emotion(amuse, heard),
        "windows": len(heard.tracks),
        "frames": motion.frames,
        "fps": motion.fps,
        "wrist_speed": {name: wrist_speed(each, body) for name, each in motions.items()},
        "sampling": asdict(amuse.sampling),
        "versions": versions(),
    }


@torch.no_grad()
def recognised_emotion(amuse: Amuse, heard: Heard) -> dict[str, float]:
    """What the emotion head makes of the speech: a probability for each emotion."""
    shares = amuse.speech.emotion_head(heard.latents.emotion.mean(0)).softmax(-1)
    return dict(zip(EMOTIONS, shares.tolist(), strict=True))


def wrist_speed(motion: Motion, body: BodyModel) -> float:
    """Mean speed of both wrists (metres per second)."""
    wrists = [joint("left_wrist"), joint("right_wrist")]
    steps = joint_positions(motion, body)[:, wrists].diff(dim=0)
    return float(steps.norm(dim=-1).mean() * motion.fps)


def versions() -> dict[str, str]:
    """Of everything that can change a number."""
    return {
        "s2glib": s2glib.__version__,
        "python": platform.python_version(),
        "torch": torch.__version__,
        "numpy": np.__version__,
    }


def tell(report: Mapping[str, Any]) -> None:
    """Print what matters of a report."""
    if "recognised_emotion" in report:
        likely = sorted(report["recognised_emotion"].items(), key=lambda item: -item[1])[:3]
        print("The speech sounds of", ", ".join(f"{name} ({share:.0%})" for name, share in likely))
    speeds = (f"{name} {speed:.2f} m/s" for name, speed in report["wrist_speed"].items())
    print("Wrist speed:", ", ".join(speeds))
    print(report["told"])
