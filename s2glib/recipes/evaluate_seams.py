"""Whether a long motion shows where its windows meet: jerk and speed of the wrists there.

Windows that disagree jolt where one takes over from the next, and a cross-fade of them goes
limp. Speech has a rhythm of its own, so real motion is measured at the very same frames, and every
recording is heard several times, after more and more silence, so that seams meet other words.

Paper:    AM generates single windows; measure: ours
Notebook: notebooks/15_long_sequences.ipynb
"""

from collections.abc import Iterator, Sequence
from itertools import groupby, product
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from s2glib.audio import Waveform
from s2glib.data import clips, load_clip
from s2glib.metrics import derivative_sizes
from s2glib.papers.amuse.front_end import MOTION_FPS
from s2glib.papers.amuse.pipeline import SAMPLE_RATE, Amuse
from s2glib.papers.amuse.stitching import window_starts
from s2glib.recipes.motion_seen import WRISTS
from s2glib.recipes.report import Row, figure

REACH = 5  # frames to either side of a seam
LEADS = (0, 21, 42)  # frames of silence before a recording
_STEP = 3  # frames that are a whole number of samples: 0.1 s
_SEED = 11


class Recording(NamedTuple):
    """Clips spoken one after the other, and the real motion of each."""

    waveform: Waveform
    poses: list[Float[Tensor, "_ 55 3"]]


def recordings() -> Iterator[Recording]:
    """All that each shipped voice says: three minutes a voice.

    Raises:
        FileNotFoundError: if the data folder is not there.
    """
    spoken = sorted((load_clip(name) for name in clips()), key=lambda clip: clip.speaker)
    for _, own in groupby(spoken, key=lambda clip: clip.speaker):
        sounds = [(clip.waveform, clip.motion.poses) for clip in own]
        yield joined([(sound.samples, poses) for sound, poses in sounds if sound is not None])


def joined(
    parts: Sequence[tuple[Float[np.ndarray, " _"], Float[Tensor, "_ 55 3"]]],
) -> Recording:
    """One recording of samples at 16 kHz and poses at 30 fps; each part ends on a tenth second."""
    sounds, motions = [], []
    for samples, poses in parts:
        steps = len(poses) // _STEP
        sounds.append(np.zeros(steps * _STEP * SAMPLE_RATE // MOTION_FPS, np.float32))
        kept = min(len(samples), len(sounds[-1]))
        sounds[-1][:kept] = samples[:kept]
        motions.append(poses[: steps * _STEP])
    return Recording(Waveform(np.concatenate(sounds), SAMPLE_RATE), motions)


def seam_rows(amuse: Amuse, recordings: Sequence[Recording]) -> list[Row]:
    """Size of a derivative near seams over elsewhere, over the same ratio in real motion."""
    heard = list(product(recordings, LEADS))
    made = [generated(amuse, recording, lead) for recording, lead in heard]
    real = [recording.poses for recording, _ in heard]

    def by_clip(motions: Sequence[list[Tensor]], order: int) -> np.ndarray:
        found = [
            totals(amuse, poses, order, lead)
            for poses, (_, lead) in zip(motions, heard, strict=True)
        ]
        each = range(0, len(found), len(LEADS))
        return np.concatenate([sum(found[k : k + len(LEADS)]) for k in each])

    return [
        figure(
            f"seams: wrist {name}, there over elsewhere / real",
            by_clip(made, order),
            by_clip(real, order),
            statistic=lambda ours, theirs: contrast(ours) / contrast(theirs),
        )
        for name, order in (("speed", 1), ("jerk", 3))
    ]


def generated(amuse: Amuse, recording: Recording, lead: int) -> list[Float[Tensor, "_ 55 3"]]:
    """Poses for a recording after `lead` silent frames, generated in one go, cut into its clips."""
    silence = np.zeros(lead * SAMPLE_RATE // MOTION_FPS, np.float32)
    waveform = Waveform(np.concatenate([silence, recording.waveform.samples]), SAMPLE_RATE)
    poses = amuse.generate(waveform, generator=torch.Generator().manual_seed(_SEED)).poses
    return list(poses[lead:].split([len(clip) for clip in recording.poses]))


def totals(
    amuse: Amuse, clips: Sequence[Float[Tensor, "_ 55 3"]], order: int, begin: int
) -> Float[np.ndarray, "clips 4"]:
    """For each clip the sum and the count near seams, then elsewhere; what spans two clips is out.

    Args:
        amuse: whose windows and features count.
        clips: poses, which follow one another.
        order: of the derivative.
        begin: frame of the recording at which the first of them starts.
    """
    features, rows = amuse.prior.features, []
    end = begin + sum(map(len, clips))
    seams = seam_frames(end, amuse.prior.config.frames, amuse.sampling.overlap)
    for poses in clips:
        wrists = features.positions(features.from_poses(poses))[:, WRISTS].double().numpy()
        sizes = derivative_sizes(wrists, MOTION_FPS, order=order).mean(axis=1)
        near = near_seams(begin, len(sizes), order, seams)
        rows.append([sizes[near].sum(), near.sum(), sizes[~near].sum(), (~near).sum()])
        begin += len(poses)
    return np.array(rows)


def seam_frames(frames: int, window: int, overlap: int) -> Int[np.ndarray, " seams"]:
    """The first frame of every cross-fade, and the first one after it."""
    later = np.array(window_starts(frames, window, overlap)[1:], dtype=int)
    return np.sort(np.concatenate([later, later + overlap]))


def near_seams(
    begin: int, count: int, order: int, seams: Int[np.ndarray, " seams"]
) -> Bool[np.ndarray, " count"]:
    """Which of `count` differences, the first one from frame `begin` on, lie near a seam.

    A seam lies between its frame and the one before; a difference, in the middle of its frames.
    """
    middles = begin + np.arange(count) + order / 2
    return np.any(np.abs(middles[:, None] - (seams - 0.5)) <= REACH, axis=1)


def contrast(totals: Float[np.ndarray, "clips 4"]) -> float:
    """Mean near seams over mean elsewhere."""
    near, near_count, far, far_count = totals.sum(axis=0)
    return float((near / near_count) / (far / far_count))
