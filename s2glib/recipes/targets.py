"""What the figures should come to: the aims, and the floors that must hold.

Paper:    AM B.2, E, Tab. A.1-A.2 (the paper's own figures, for comparison)
Notebook: notebooks/17_motion_distances.ipynb
"""

import math
from typing import NamedTuple


class Bounds(NamedTuple):
    """Where a figure should lie."""

    low: float = -math.inf
    high: float = math.inf

    def __str__(self) -> str:
        """Such as `>= 0.95`, `<= 3` or `0.95 .. 1.05`."""
        if self.high == math.inf:
            return f">= {self.low:.4g}"
        if self.low == -math.inf:
            return f"<= {self.high:.4g}"
        return f"{self.low:.4g} .. {self.high:.4g}"


class Target(NamedTuple):
    """What is aimed at, and what must hold at least; None where nothing is asked."""

    aim: Bounds | None = None
    floor: Bounds | None = None


def _least(aim: float, floor: float | None = None) -> Target:
    return Target(Bounds(low=aim), None if floor is None else Bounds(low=floor))


def _most(aim: float, floor: float | None = None) -> Target:
    return Target(Bounds(high=aim), None if floor is None else Bounds(high=floor))


def _near_one(aim: float, floor: float | None = None) -> Target:
    return Target(Bounds(1 - aim, 1 + aim), None if floor is None else Bounds(1 - floor, 1 + floor))


def _gestures(aim: float, floor: float) -> Target:
    """Accuracy over that of real motion; above 1.05 it is a caricature."""
    return Target(Bounds(aim, 1.05), Bounds(low=floor))


_SENTENCES, _VOICES, _EMOTIONS = 14, 24, 8  # of the test block
_LEAK = 3.0  # times chance

AMUSE_SPEECH = {
    "EA": _least(0.97, 0.95),
    "SA": _least(0.99, 0.98),
    "EA, unseen sentences": _least(0.95),
    "SA, unseen sentences": _least(0.98),
    "EA, unseen voices": _least(0.75, 0.60),
    "cross content / self": _most(1.015, 1.02),
    "cross emotion / self": _most(1.015, 1.02),
    "cross style / self": _most(1.015, 1.02),
    "reliance on content": _least(1.30, 1.15),
    "reliance on emotion": _least(1.30, 1.15),
    "reliance on style": _least(1.30, 1.15),
    "judge right, emotion": _least(0.95),
    "judge right, emotion, blurred": _least(0.95),
    "judge right, voice": _least(0.95),
    "judge right, voice, blurred": _least(0.95),
    "emotion edit recognised": _least(0.92, 0.80),
    "style edit recognised": _least(0.95),
    "emotion edit recognised, unseen voices": _least(0.65),
    "edit / target on the source's clock": _most(1.25),
    "sentence in e": _most(_LEAK / _SENTENCES),
    "voice in e": _most(_LEAK / _VOICES),
    "sentence in s": _most(_LEAK / _SENTENCES),
    "emotion in s": _most(_LEAK / _EMOTIONS),
    "emotion in c": _most(0.40),
}

AMUSE_GESTURE = {
    "GA of real motion, M": Target(Bounds(0.64, 0.75)),
    "prior: wrist error, cm": _most(1.5, 2.0),
    "prior: spread / real": _near_one(0.05),
    "prior: GA / real, M": _least(0.94, 0.90),
    "GA generated / real, M": _gestures(0.90, 0.75),
    "GA generated / real, positions": _gestures(0.90, 0.75),
    "GA edited / real, M": _gestures(0.80, 0.60),
    "GA edited / real, positions": _gestures(0.80, 0.60),
    "FGD ratio, M": _most(3.0),
    "FGD ratio, principal components": _most(3.0, 3.0),
    "beat margin / real, motion to audio, stress": _least(0.8, 0.3),
    "beat margin / real, audio to motion, stress": _least(0.8, 0.3),
    "spread of wrists / real": _near_one(0.05, 0.10),
    "jerk of wrists / real": _most(1.3, 1.5),
    "wrist speed, anger / sadness, generated": Target(None, Bounds(low=1.5)),
    "same seed twice, largest difference": _most(0.0),
}

AMUSE_SEAMS = {
    "seams: wrist speed, there over elsewhere / real": _near_one(0.2),
    "seams: wrist jerk, there over elsewhere / real": _near_one(0.2),
}

_LESS = Target(None, Bounds(high=1.0))  # than the other

MDDIFFUSION_VIDEO = {
    "moving region / copied, refined": _most(0.60, 0.75),
    "moving region / copied, decoupler": _most(0.60, 0.75),
    "hand region, refined / decoupler": _LESS,
    "face region, refined / decoupler": _LESS,
    "wrists in keypoints, R2": _least(0.80, 0.70),
    "wrists in keypoints, R2 above untrained": Target(None, Bounds(low=0.20)),
}

PROBTALK = {
    "codes: perplexity / codes, least used group": _least(0.5, 0.5),
    "codes: wrist error, cm": _most(2.0, 3.0),
    "true codes: error, refined / pasted": _most(1.0),
    "true codes: border, refined / pasted": _LESS,
    "true codes: border, refined / eased": _most(1.0),
    "FGD ratio, face, refined": _most(3.0),
    "FGD ratio, body and hands, refined": _most(3.0),
    "FGD ratio, all, refined": _most(3.0),
    "beat margin / real, motion to audio, stressed syllables, refined": _least(0.8),
    "beat margin / real, audio to motion, stressed syllables, refined": _least(0.8),
    "speed of wrists / real, refined": _near_one(0.05),
    "jerk of wrists / real, refined": _most(1.3),
    "one second kept: border, refined / not": _most(1.0),
    "one second kept: largest change of what is written": _most(0.0, 0.0),
    "best of 32 samples / of 32 real clips": _most(1.0),
}
PROBTALK_STUDIES = {  # recorded
    "short runs: wrist error, cm, PQ / VQ, equal memory, worst seed": _LESS,
    "short runs: part-wise error, PQ / VQ, equal memory, worst seed": _LESS,
}

TARGETS: dict[str, Target] = (
    AMUSE_SPEECH | AMUSE_GESTURE | AMUSE_SEAMS | MDDIFFUSION_VIDEO | PROBTALK | PROBTALK_STUDIES
)
