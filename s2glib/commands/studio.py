"""From a recording to a folder of gestures: read, load, hear, gesture, write, tell.

Paper:    AM Fig. A.4 (inference), A (emotion and style editing)
Notebook: -
"""

import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import torch

from s2glib.audio import Waveform, load
from s2glib.body import BodyModel, Motion, mannequin, write_bvh, write_glb, write_npz
from s2glib.commands.account import describe_job, describe_result, tell
from s2glib.commands.delivery import delivery, writing
from s2glib.commands.diary import Diary
from s2glib.commands.ensemble import open_amuse
from s2glib.commands.job import Job
from s2glib.papers.amuse.pipeline import Amuse, Heard
from s2glib.widgets import write_html

SHOWN = 10 * 60  # seconds that gesture.html holds: 50 MB; for more a browser takes a gigabyte
FILES = ("motion.npz", "motion.glb", "motion.bvh", "gesture.html", "report.json")


@runtime_checkable
class Told(Protocol):
    """What the files say of a job."""

    @property
    def speech(self) -> Path:
        """The sound file."""

    @property
    def out(self) -> Path:
        """Where the files are wanted."""

    @property
    def told(self) -> str:
        """What was done, in a few sentences."""


def perform(job: Job) -> None:
    """Make gestures for a recording, and deliver `FILES`.

    Source and edited motion start from the same noise, so that only the swap tells them apart.

    Raises:
        ValueError: if an input, a network or the output is not usable.
        FileNotFoundError: if a sound or a network is missing.
    """
    job.check()
    diary = Diary()
    with delivery(job.out, FILES) as folder:
        with diary.step("read the sound"):
            files = {"speech": job.speech, **job.donors}
            sounds = {name: load(path) for name, path in files.items()}
        with diary.step("load the networks"):
            amuse, body = open_amuse(job.checkpoints), mannequin()
        with diary.step("hear"):
            heard = hear(amuse, job, sounds)
        with diary.step("gesture"):
            motions = gesture(amuse, heard, job.seed)
        report = describe_job(job, sounds)
        report |= describe_result(amuse, heard["source"], motions, body)
        with diary.step("write"), writing(job.out):
            write_motions(folder, motions, sounds["speech"], body, job)
        write_report(folder, report, diary, job)
    tell(report)
    print(f"Wrote {', '.join(FILES)} to {job.out}")


def hear(amuse: Amuse, job: Job, sounds: Mapping[str, Waveform]) -> dict[str, Heard]:
    """The speech as it is and, if anything is swapped, as it is wanted."""
    heard = {"source": amuse.hear(sounds["speech"])}
    if job.swapped:
        donors = {latent: sounds[latent] for latent in job.donors}
        heard["edited"] = job.edit(amuse, heard["source"], donors)
    return heard


def gesture(amuse: Amuse, heard: Mapping[str, Heard], seed: int) -> dict[str, Motion]:
    """A motion for each, all from the same noise."""
    return {
        name: amuse.gesture(each, generator=torch.Generator().manual_seed(seed))
        for name, each in heard.items()
    }


def write_motions(
    folder: Path, motions: Mapping[str, Motion], waveform: Waveform, body: BodyModel, job: Told
) -> None:
    """The last motion as npz, GLB and BVH; all of them, with the sound, on a page."""
    shown = list(motions)[-1]
    write_npz(folder / "motion.npz", motions[shown])
    write_glb(folder / "motion.glb", motions[shown], body)
    write_bvh(folder / "motion.bvh", motions[shown], body)
    write_page(folder / "gesture.html", motions, waveform, body, job)


def write_page(
    path: Path, motions: Mapping[str, Motion], waveform: Waveform, body: BodyModel, job: Told
) -> None:
    """The first `SHOWN` seconds on a page; where that is not all, page and warning say so."""
    told, view = job.told, list(motions)[-1]
    if waveform.duration > SHOWN:
        part = (
            f"{path.name} shows the first {SHOWN / 60:g} minutes; the other files hold everything"
        )
        warnings.warn(part, stacklevel=2)
        told = f"{told} Here {part}."
    heard = Waveform(waveform.samples[: SHOWN * waveform.sample_rate], waveform.sample_rate)
    seen = {name: opening(motion) for name, motion in motions.items()}
    write_html(path, seen, heard, body, title=job.speech.name, text=told, view=view)


def write_report(folder: Path, report: dict[str, Any], diary: Diary, job: Told) -> None:
    """The account of a job, with the time that its steps took."""
    report |= {"seconds": diary.seconds, "warnings": diary.warnings}
    with writing(job.out):
        (folder / "report.json").write_text(json.dumps(report, indent=2) + "\n", "utf-8")


def opening(motion: Motion) -> Motion:
    """The first `SHOWN` seconds of a motion, or all of a shorter one."""
    end = round(SHOWN * motion.fps)
    return Motion(motion.poses[:end], motion.trans[:end], motion.expression[:end], motion.fps)
