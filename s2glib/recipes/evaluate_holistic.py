"""Rows about generated holistic motion beside the real: the crowd, the one truth, the beat.

Paper:    PT B, Tab. 7 (FGD, MAE, BC)
Notebook: notebooks/17_motion_distances.ipynb
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from s2glib.corpus.build import Request, onset_set, timing_of
from s2glib.metrics import (
    beat_score,
    derivative_sizes,
    mean_absolute_error,
    mean_joint_error,
    mean_speeds,
)
from s2glib.papers.probtalk import FeatureNets
from s2glib.papers.probtalk.speech_features import MOTION_FPS
from s2glib.recipes.evaluate_beats import beat_rows
from s2glib.recipes.evaluate_frechet import Distances, distances
from s2glib.recipes.holistic_data import HolisticClips
from s2glib.recipes.holistic_seen import WRISTS, Seen, look, wrist_agreement
from s2glib.recipes.report import Row, figure, over_draws, ratio


class Truth(NamedTuple):
    """What generated motion is held against.

    Attributes:
        seen: the test clips' own motion.
        others: what FGD's networks make of other real clips.
        onsets: of the speech, seconds, none after a clip's end.
        stresses: likewise.
    """

    seen: Seen
    others: dict[str, Float[np.ndarray, "m code"]]
    onsets: list[Float[np.ndarray, " _"]]
    stresses: list[Float[np.ndarray, " _"]]


def truth_of(
    nets: FeatureNets,
    clips: HolisticClips,
    frames: int,
    others: dict[str, Float[np.ndarray, "m code"]],
) -> Truth:
    """The clips' own motion and beats, in windows of so many frames."""
    seen = look(nets, clips.first(frames), clips.motion.lengths)
    ends = seen.lengths / MOTION_FPS
    onsets = onset_set([Request(cell) for cell in clips.cells])
    stresses = [timing_of(cell).stress_times for cell in clips.cells]
    heard = ([b[b < end] for b, end in zip(k, ends, strict=True)] for k in (onsets, stresses))
    return Truth(seen, others, *heard)


def real_rows(truth: Truth) -> list[Row]:
    """What real motion gets: the marks that generated motion is to reach, not to pass."""
    seen = truth.seen
    return [
        *(row for row in _beats(truth, seen) if "of real motion" in row.name),
        *(
            over_draws(f"FGD, {kind}, other real clips", apart.others, count)
            for kind, apart, count in _distances(truth, seen)
        ),
        consistency_row("BC of real motion", truth, seen),
        figure("agreement of wrists, real motion", wrist_agreement(seen.own)),
    ]


def crowd_rows(truth: Truth, made: Seen, name: str) -> list[Row]:
    """FGD by each network, and over that of other real clips: 1 is as good as real  [PT Tab. 7]."""
    return [
        over_draws(f"{what}, {kind}, {name}", values, count)
        for kind, apart, count in _distances(truth, made)
        for what, values in (("FGD", apart.made), ("FGD ratio", apart.ratios))
    ]


def _distances(truth: Truth, made: Seen) -> Iterator[tuple[str, Distances, int]]:
    for kind, codes in truth.seen.codes.items():
        count = min(len(codes), len(truth.others[kind]))
        yield kind, distances(codes, made.codes[kind], truth.others[kind], count=count), count


def truth_rows(truth: Truth, made: Seen, name: str) -> list[Row]:
    """MAE in both readings, and what a real motion for other words gets  [PT Tab. 7]."""
    real, others = truth.seen.own, np.roll(truth.seen.joints, 1, axis=0)
    summed, mean = (
        np.array([error(*pair) for pair in zip(made.own, real, strict=True)])
        for error in (mean_joint_error, mean_absolute_error)
    )
    pairs = zip(others, real, strict=True)
    other = np.array([mean_joint_error(clip[: len(own)], own) for clip, own in pairs])
    return [
        figure(f"MAE, sum over joints, m, {name}", summed),
        figure(f"MAE, mean over coordinates, cm, {name}", 100 * mean),
        ratio(f"MAE / that of another real clip, {name}", summed, other),
    ]


def rhythm_rows(truth: Truth, made: Seen, name: str) -> list[Row]:
    """BC as PT takes it, and what is left of alignment once chance is taken away."""
    margins = (row for row in _beats(truth, made) if row.name.startswith("beat margin / real"))
    return [
        consistency_row(f"BC, {name}", truth, made),
        *(row._replace(name=f"{row.name}, {name}") for row in margins),
    ]


def _beats(truth: Truth, made: Seen) -> list[Row]:
    kind, lengths = "stressed syllables", truth.seen.lengths
    return beat_rows(truth.seen.nine, made.nine, truth.stresses, kind, lengths)


def consistency_row(name: str, truth: Truth, seen: Seen) -> Row:
    """BC: every onset of the speech counts the same, and so long clips more  [PT Tab. 7]."""
    counts = np.array([len(beats) for beats in truth.onsets])
    speed = mean_speeds([body[:, :22] for body in truth.seen.own], MOTION_FPS, preset="probtalk")
    scores = [
        beat_score(body[:, :22], beats, MOTION_FPS, preset="probtalk", reference_speed=speed)
        for body, beats in zip(seen.own, truth.onsets, strict=True)
    ]
    return ratio(name, np.nan_to_num(scores) * counts, counts)


def manner_rows(truth: Truth, made: Seen, name: str) -> list[Row]:
    """How fast and how smoothly the wrists move, and whether they move together."""
    rows = [figure(f"agreement of wrists, {name}", wrist_agreement(made.own))]
    for what, order in (("speed", 1), ("jerk", 3)):
        sizes = (_wrist_sizes(seen, order) for seen in (made, truth.seen))
        rows.append(ratio(f"{what} of wrists / real, {name}", *sizes))
    return rows


def _wrist_sizes(seen: Seen, order: int) -> Float[np.ndarray, " n"]:
    wrists = (clip[:, WRISTS] for clip in seen.own)
    return np.array([derivative_sizes(w, MOTION_FPS, order=order).mean() for w in wrists])
