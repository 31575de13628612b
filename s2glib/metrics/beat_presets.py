"""The beat scores in print, side by side: seven definitions that cannot be compared.

Paper:    PT B Tab. 7-8 (BC), AM E (BA), MDD H (BAS)
Notebook: notebooks/18_beats.ipynb
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from s2glib.metrics.beats import beat_alignment, select_joints, step_sizes, strict_minima
from s2glib.metrics.doors import require, require_positive

_ARMS = tuple(range(16, 22))  # shoulders, elbows, wrists of SMPL-X
_UPPER_BODY = (3, 6, 9, *range(12, 22))  # spine, neck, collars, head, arms


def _steps(motion: np.ndarray, fps: float | int) -> np.ndarray:
    return step_sizes(motion)


def _steps_into(motion: np.ndarray, fps: float | int) -> np.ndarray:
    return step_sizes(np.concatenate([motion[:1], motion]))  # frame 0 is entered at speed 0


def _central_speeds(motion: np.ndarray, fps: float | int) -> np.ndarray:
    return np.linalg.norm(np.gradient(motion, axis=0) * fps, axis=-1)


def _arm_angle_steps(motion: np.ndarray, fps: float | int) -> np.ndarray:
    """Change of both elbow and both shoulder angles, in half turns: (frames - 1, 4)."""
    spine, shoulders = motion[:, [9]], motion[:, 16:18]
    elbows, wrists = motion[:, 18:20], motion[:, 20:22]
    ends = np.concatenate([wrists - elbows, elbows - shoulders], axis=1)  # (frames, 4, 3)
    starts = np.concatenate([shoulders - elbows, spine - shoulders], axis=1)
    cosine = (_unit(ends) * _unit(starts)).sum(axis=-1).clip(-1, 1)
    return np.abs(np.diff(np.arccos(cosine) / np.pi, axis=0))


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)


@dataclass(frozen=True)
class BeatPreset:
    """One published beat score: what it looks at, what it calls a beat, what it averages over."""

    quantity: str  # what `motion` must hold, and at which rate
    curves: Callable[[np.ndarray, float | int], np.ndarray]  # (motion, fps) -> (n, curves)
    direction: Literal["audio to motion", "motion to audio"]
    sigma: float | int
    sigma_unit: Literal["seconds", "frames"]
    order: int  # frames
    joints: tuple[int, ...] | None = None  # None: every joint of the motion
    shift: float | int = 0  # frames from index k of a curve to the time of that step
    smooth: float | int = 0  # frames
    depth: float | int = 0  # least rise beside a minimum
    floor: float | int = -np.inf  # a beat is FASTER than this (EMAGE)
    relative: bool = False  # curves are divided by their mean over the real motions
    per_joint: bool = (
        False  # the mean of one score per curve; otherwise the score of the mean curve
    )


BEAT_PRESETS: dict[str, BeatPreset] = {
    "probtalk": BeatPreset(
        quantity="SMPL-X joint positions (frames, 22 or more, 3), 30 fps; four arm angles",
        curves=_arm_angle_steps,
        direction="audio to motion",
        sigma=0.1,  # authors' code
        sigma_unit="seconds",
        order=1,
        joints=tuple(range(22)),
        shift=1,
        depth=0.01,
        relative=True,
    ),
    "beat": BeatPreset(
        quantity="Euler angles in degrees (frames, joints, 3), 15 fps; right wrist only",
        curves=_steps,
        direction="audio to motion",
        sigma=0.3,
        sigma_unit="seconds",
        order=2,
        joints=(21,),
    ),
    "emage": BeatPreset(
        quantity="SMPL-X joint positions (frames, 22 or more, 3), m, 30 fps; 13 upper joints",
        curves=_central_speeds,
        direction="audio to motion",
        sigma=0.3,
        sigma_unit="seconds",
        order=7,
        joints=_UPPER_BODY,
        floor=0.1,  # evaluation tools; the 2024 trainer has .3
        relative=True,
        per_joint=True,
    ),
    "aist": BeatPreset(
        quantity="joint positions (frames, joints, 3), 60 fps; all joints given (24 of SMPL)",
        curves=_steps_into,
        direction="motion to audio",
        sigma=3,
        sigma_unit="frames",
        order=10,
    ),
    "bailando": BeatPreset(
        quantity="joint positions (frames, joints, 3), 60 fps; all joints given (24 of SMPL)",
        curves=_steps,
        direction="audio to motion",
        sigma=3,
        sigma_unit="frames",
        order=1,
        smooth=5,
    ),
    "amuse": BeatPreset(
        quantity="SMPL-X joint positions (frames, 22 or more, 3), 30 fps; six arm joints",  # [AM E]
        curves=_steps,
        direction="motion to audio",  # "each kinematic beat and its nearest audio beat" [AM E]
        sigma=0.1,  # ours, and so are the next three
        sigma_unit="seconds",
        order=5,
        shift=0.5,
        joints=_ARMS,
    ),
    "mddiffusion": BeatPreset(
        quantity="2-D body and hand points (frames, 55, 2), 25 fps; every point",  # [MDD C]
        curves=_steps,
        direction="audio to motion",  # [MDD H]
        sigma=3,  # not stated; as in bailando
        sigma_unit="frames",
        order=1,
        smooth=5,  # "filtered with a Gaussian kernel" [MDD H]; width as in bailando
    ),
}
"""By name, what each score wants; orders and widths are in frames of the rate it names."""


def preset_beats(
    motion: Float[np.ndarray, "frames joints dims"],
    fps: float | int,
    *,
    preset: str,
    reference_speed: Float[np.ndarray, " curves"] | None = None,
) -> list[Float[np.ndarray, " _"]]:
    """The kinematic beats by which a preset scores a motion: one array of seconds per curve.

    Arguments and errors are those of `beat_score`. Only `emage` has more than one curve.
    """
    chosen = _preset(preset)
    curves = _curves(motion, fps, chosen)
    if chosen.relative:
        curves = curves / _reference(curves, reference_speed)
    curves = curves if chosen.per_joint else curves.mean(axis=1, keepdims=True)
    beats = []
    for curve in curves.T:
        lows = strict_minima(curve, chosen.order, smooth=chosen.smooth, depth=chosen.depth)
        beats.append((lows[curve[lows] > chosen.floor] + chosen.shift) / fps)
    return beats


def mean_speeds(
    motions: Sequence[Float[np.ndarray, "_ joints dims"]], fps: float | int, *, preset: str
) -> Float[np.ndarray, " curves"]:
    """The `reference_speed` of `probtalk` and `emage`, measured on real motions.

    Mean over time, then over clips, of each of the preset's curves: 4 angles in half turns a frame,
    or 13 joints in metres a second.
    """
    if not len(motions):
        raise ValueError("the mean speed of no motions is undefined; pass real motions")
    chosen = _preset(preset)
    return np.mean([_curves(motion, fps, chosen).mean(axis=0) for motion in motions], axis=0)


def beat_score(
    motion: Float[np.ndarray, "frames joints dims"],
    audio_beats: Float[np.ndarray, " beats"],
    fps: float | int,
    *,
    preset: str,
    reference_speed: Float[np.ndarray, " curves"] | None = None,
) -> float:
    """Beat alignment of one clip, as one of the papers takes it.

    | preset | quantity | from -> to | sigma | order |
    |---|---|---|---|---|
    | probtalk | change of 4 arm angles, 30 fps | audio -> motion | .1 s | 1 |
    | beat | right wrist's Euler angles, degrees, 15 fps | audio -> motion | .3 s | 2 |
    | emage | 13 upper joints, m, 30 fps, one by one | audio -> motion | .3 s | 7 |
    | aist | all joints, summed, 60 fps | motion -> audio | 3 frames | 10 |
    | bailando | all joints, Gaussian of 5 frames, 60 fps | audio -> motion | 3 frames | 1 |
    | amuse (ours where unknown) | 6 arm joints, summed, 30 fps | motion -> audio | .1 s | 5 |
    | mddiffusion (as bailando) | all 2-D points, 25 fps | audio -> motion | 3 frames | 1 |

    Joints are counted as in SMPL-X. PT pools its corpus over audio beats: weight clips by their
    number of audio beats to get its figure. Higher is not better: closer to real motion is, and
    chance alone gives most of a score (`shuffled_alignment`).

    Args:
        motion: what `BEAT_PRESETS[preset].quantity` names.
        audio_beats: onset times in seconds.
        fps: frames per second; orders stay in frames, whatever it is.
        preset: a key of `BEAT_PRESETS`.
        reference_speed: for `probtalk` and `emage`, mean speeds of REAL motion (`mean_speeds`); by
            default the clip's own, so that scores of two systems share no scale.

    Returns:
        A number in [0, 1]; 0.0 if the body has no beats, nan where audio beats are averaged over
        and there are none.

    Raises:
        TypeError, ValueError: for an unknown preset, other shapes, missing joints, NaN.
    """
    chosen = _preset(preset)
    curves_beats = preset_beats(motion, fps, preset=preset, reference_speed=reference_speed)
    sigma = chosen.sigma / fps if chosen.sigma_unit == "frames" else chosen.sigma
    scores = []
    for beats in curves_beats:
        if chosen.direction == "audio to motion":
            scores.append(beat_alignment(audio_beats, beats, sigma=sigma))
        else:
            scores.append(beat_alignment(beats, audio_beats, sigma=sigma) if len(beats) else 0.0)
    return float(np.mean(scores))


def _preset(name: str) -> BeatPreset:
    if name not in BEAT_PRESETS:
        raise ValueError(
            f"no beat score is called {name!r}; choose one of {', '.join(BEAT_PRESETS)}"
        )
    return BEAT_PRESETS[name]


def _curves(motion: np.ndarray, fps: float | int, preset: BeatPreset) -> np.ndarray:
    motion = require("motion", motion, "frames joints dims", at_least=2)
    require_positive("fps", fps)
    return preset.curves(select_joints(motion, preset.joints), fps)


def _reference(curves: np.ndarray, reference: np.ndarray | None) -> np.ndarray:
    if reference is None:
        return np.maximum(curves.mean(axis=0), np.finfo(float).tiny)
    reference = require("reference_speed", reference, f"{curves.shape[1]}")
    if (reference <= 0).any():
        raise ValueError("reference_speed must be positive; measure it with mean_speeds")
    return reference
