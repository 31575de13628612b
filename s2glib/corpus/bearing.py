"""How emotions and speakers move: the tables behind every gesture of the corpus.

Paper:    AM E, Fig. A.9-A.10 (gestures differ by emotion and by speaker), values: ours
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from typing import NamedTuple

import numpy as np

from s2glib.corpus.script import EMOTIONS, SPEAKERS

STRONGEST_REACH = 1.35  # beyond this, elbows lock


class Bearing(NamedTuple):
    """How a body in one emotion carries itself. Angles in radians, lengths in arm lengths."""

    amplitude: float  # size of gestures
    tempo: float  # speed of strokes
    beats: float  # probability of a beat on a stressed word
    gestures: float  # probability of a marked word's gesture
    height: float  # of the hands
    lean: float  # trunk, + forwards
    head: float  # pitch, + down
    shoulders: float  # raised
    elbows: float  # away from the body
    sway: float
    tension: float  # hands: -1 spread, +1 fists
    shake: float  # of the head
    tremor: float  # of the hands
    roll: float  # of the head
    second_hand: float  # probability that the other hand joins
    nod: float  # with each stroke


BEARINGS = {
    "neutral": Bearing(
        1.00, 1.00, 0.45, 0.75, 0.00, 0.00, 0.00, 0.00, 0.00, 0.010, 0.0, 0.00, 0.000, 0.00, 0.20,
        0.04,
    ),
    "happiness": Bearing(
        1.30, 1.15, 0.75, 0.95, 0.10, -0.05, -0.08, 0.00, 0.08, 0.035, -0.1, 0.00, 0.000, 0.10,
        0.60, 0.08,
    ),
    "anger": Bearing(
        1.25, 1.50, 0.95, 0.95, 0.05, 0.16, 0.10, 0.05, 0.10, 0.012, 0.6, 0.03, 0.000, 0.00, 0.50,
        0.12,
    ),
    "sadness": Bearing(
        0.50, 0.65, 0.15, 0.45, -0.18, 0.20, 0.28, -0.06, -0.05, 0.008, -0.1, 0.02, 0.000, 0.00,
        0.10, 0.01,
    ),
    "contempt": Bearing(
        0.75, 0.80, 0.30, 0.65, -0.05, -0.10, -0.16, 0.03, 0.05, 0.008, 0.0, 0.05, 0.000, 0.20,
        0.05, 0.02,
    ),
    "surprise": Bearing(
        1.40, 1.30, 0.35, 0.95, 0.18, -0.14, -0.12, 0.12, 0.06, 0.015, -0.3, 0.00, 0.000, 0.00,
        0.80, 0.03,
    ),
    "fear": Bearing(
        0.65, 1.35, 0.35, 0.70, 0.12, -0.08, 0.05, 0.16, -0.10, 0.010, 0.4, 0.04, 0.035, 0.00,
        0.70, 0.02,
    ),
    "disgust": Bearing(
        0.85, 0.90, 0.30, 0.75, 0.02, -0.16, 0.10, 0.08, -0.04, 0.010, 0.3, 0.10, 0.000, -0.16,
        0.40, 0.02,
    ),
}  # fmt: skip

POSTURE = ("height", "lean", "head", "shoulders", "elbows", "roll")

REST_SHIFTS = {  # how an emotion moves resting hands: add the shift, lose this share of the place
    "fear": ((-0.005, -0.175, 0.305), 0.75),
    "contempt": ((0.10, 0.02, -0.12), 0.0),
    "disgust": ((-0.03, 0.12, 0.05), 0.0),
}


class Manner(NamedTuple):
    """How one speaker moves in every emotion."""

    dominant: str  # "left" or "right"
    reach: float
    rest: tuple[float, float, float]  # resting wrist from the shoulder: out, up, forward
    yaw: float  # of the head
    twist: float  # of the trunk
    eagerness: float  # shift of the probability of a gesture
    openness: float  # of the fingers
    sway_rate: float  # Hz
    lag: float  # seconds behind the words


_BY_HAND = (
    Manner("right", 1.00, (0.12, -0.78, 0.30), 0.00, 0.00, 0.00, 0.0, 0.25, 0.00),
    Manner("right", 1.15, (0.20, -0.85, 0.15), 0.10, 0.05, 0.10, 0.2, 0.35, -0.05),
    Manner("left", 0.85, (0.05, -0.65, 0.38), -0.10, 0.00, -0.10, -0.1, 0.20, 0.05),
    Manner("right", 0.95, (0.28, -0.88, 0.05), 0.05, -0.10, 0.00, 0.0, 0.30, 0.00),
    Manner("left", 1.10, (0.15, -0.70, 0.32), -0.05, 0.08, 0.10, 0.2, 0.40, -0.03),
    Manner("right", 0.80, (0.02, -0.60, 0.40), 0.00, 0.00, -0.20, -0.1, 0.22, 0.06),
    Manner("right", 1.20, (0.24, -0.80, 0.22), -0.12, -0.05, 0.15, 0.3, 0.33, -0.06),
    Manner("left", 0.95, (0.10, -0.82, 0.25), 0.08, 0.04, 0.00, 0.1, 0.28, 0.02),
)


def _drawn(number: int) -> Manner:
    """The other speakers, drawn once and for all within the range of the first eight."""
    rng = np.random.default_rng([4242, number])
    side, height, front = rng.uniform((0.02, -0.88, 0.05), (0.28, -0.60, 0.40))
    return Manner(
        dominant="left" if rng.random() < 0.35 else "right",
        reach=rng.uniform(0.80, 1.20),
        rest=(side, height, front),
        yaw=rng.uniform(-0.12, 0.12),
        twist=rng.uniform(-0.10, 0.10),
        eagerness=rng.uniform(-0.20, 0.15),
        openness=rng.uniform(-0.1, 0.3),
        sway_rate=rng.uniform(0.20, 0.40),
        lag=rng.uniform(-0.06, 0.06),
    )


MANNERS = {
    speaker: _BY_HAND[number] if number < len(_BY_HAND) else _drawn(number)
    for number, speaker in enumerate(SPEAKERS)
}

# The dials that decide how well the emotion of a true gesture can be recognised.
POSTURE_NOISE = 0.120  # radians or arm lengths, standard deviation per clip
AMPLITUDE_NOISE, TEMPO_NOISE = 0.31, 0.20  # standard deviation of the logarithm
LEAK = 0.30  # at most this share of another emotion shows


def body_strength(intensity: float) -> float:
    """Share of an emotion's bearing that a clip of that intensity shows."""
    return 0.9 * intensity


class Performance(NamedTuple):
    """What one clip's body does: a bearing and a manner with this clip's chances drawn."""

    bearing: Bearing
    manner: Manner
    rest: np.ndarray  # (3,) arm lengths


def perform(emotion: str, speaker: str, intensity: float, rng: np.random.Generator) -> Performance:
    """Draw a clip's bearing: neutral, moved towards the emotion, with a leak and with noise."""
    manner = MANNERS[speaker]
    neutral, target = (np.array(BEARINGS[name]) for name in ("neutral", emotion))
    other = np.array(BEARINGS[EMOTIONS[int(rng.integers(len(EMOTIONS)))]])
    leak, strength = LEAK * rng.random(), body_strength(intensity)
    mixed = Bearing(*(neutral + strength * ((1 - leak) * target + leak * other - neutral)))
    amplitude = mixed.amplitude * manner.reach * np.exp(rng.normal(0, AMPLITUDE_NOISE))
    posture = {name: getattr(mixed, name) + rng.normal(0, POSTURE_NOISE) for name in POSTURE}
    bearing = mixed._replace(
        amplitude=min(amplitude, STRONGEST_REACH),
        tempo=mixed.tempo * np.exp(rng.normal(0, TEMPO_NOISE)),
        shake=mixed.shake * np.exp(rng.normal(0, 6 * POSTURE_NOISE)),
        tremor=mixed.tremor * (rng.random() < 0.5 + 0.5 * strength),
        **posture,
    )
    return Performance(bearing, manner, _rest(manner, bearing, emotion, strength, rng))


def _rest(manner, bearing, emotion, strength, rng):
    rest = np.array(manner.rest) + (bearing.elbows, 0.8 * bearing.height, 0.0)
    rest = rest + rng.normal(0, POSTURE_NOISE, 3)
    if emotion in REST_SHIFTS:
        shift, pull = REST_SHIFTS[emotion]
        rest = rest + strength * (np.array(shift) - pull * rest)
    return rest
