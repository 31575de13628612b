"""The face: jaw and lips from the phonemes, brows and mouth from the emotion, and blinks.

Paper:    PT A.2 (jaw and expression), visemes and values: ours
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import numpy as np

from s2glib.body.skeleton import FACE_CURVES
from s2glib.corpus.clock import Timing
from s2glib.corpus.strokes import smooth

WIDEST_JAW = 0.30  # radians

EXPRESSIONS = {  # face curves of an emotion at full strength
    "neutral": {},
    "happiness": {"smile": 0.9, "brow_raise": 0.25},
    "anger": {"brow_furrow": 1.0, "frown": 0.6, "lid_wide": 0.3, "lip_press": 0.2},
    "sadness": {"brow_sad": 0.9, "frown": 0.8, "lid_close": 0.25},
    "contempt": {"smirk": 0.9, "lid_close": 0.25, "brow_raise": 0.15},
    "surprise": {"brow_raise": 1.0, "lid_wide": 0.9},
    "fear": {"brow_sad": 0.6, "brow_raise": 0.6, "lid_wide": 0.8, "frown": 0.3},
    "disgust": {"nose_wrinkle": 0.9, "brow_furrow": 0.5, "frown": 0.6, "lid_close": 0.2},
}

_VISEMES = (  # symbols, then jaw (0-1), lip_round, lip_wide, lip_press
    ("mbp", (0.0, 0.0, 0.0, 1.0)),
    ("fv", (0.1, 0.0, 0.2, 0.5)),
    ("uʊw", (0.25, 1.0, 0.0, 0.0)),
    ("oɔ", (0.55, 0.8, 0.0, 0.0)),
    ("ɹɚɜʃʒ", (0.2, 0.5, 0.0, 0.0)),
    ("iɪjᵻ", (0.3, 0.0, 0.8, 0.0)),
    ("eɛ", (0.55, 0.0, 0.6, 0.0)),
    ("aɑæʌɐə", (0.9, 0.0, 0.2, 0.0)),
)
_OTHER_SOUND = (0.18, 0.0, 0.2, 0.0)


def viseme(phoneme: str) -> tuple[float, float, float, float]:
    """Jaw opening, rounding, spreading and pressing of the lips for one IPA phoneme."""
    sounds = phoneme.strip("ˈˌː")
    if not sounds:
        return (0.0, 0.0, 0.0, 0.0)
    for symbols, shape in _VISEMES:
        if sounds[0] in symbols:
            return shape
    return _OTHER_SOUND


def mouth_shapes(timing: Timing, times: np.ndarray) -> np.ndarray:
    """(frames, 4) jaw, lip_round, lip_wide and lip_press, each in [0, 1], coarticulated."""
    shapes = np.array([viseme(phoneme) for phoneme in timing.phonemes])
    place = np.searchsorted(timing.boundaries, times, "right") - 1
    silent = (place < 0) | (place >= len(shapes))
    shapes = shapes[np.clip(place, 0, len(shapes) - 1)]
    shapes[silent] = 0.0
    return smooth(shapes, 5)


def face_tracks(
    timing: Timing, times: np.ndarray, emotion: str, intensity: float, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Jaw angle (frames,) in radians and face curves (frames, 12) in [0, 1]."""
    mouth = mouth_shapes(timing, times)
    curves = np.zeros((len(times), len(FACE_CURVES)))
    for name, value in EXPRESSIONS[emotion].items():
        slow = smooth(rng.normal(0, 1, (len(times), 1)), 61)[:, 0]
        curves[:, FACE_CURVES.index(name)] = value * intensity * (1 + 0.8 * slow)
    for column, name in enumerate(("lip_round", "lip_wide", "lip_press"), start=1):
        curves[:, FACE_CURVES.index(name)] += 0.8 * mouth[:, column]
    blink = np.zeros(len(times))
    moment = rng.uniform(0.3, 2.5)
    while moment < times[-1]:
        blink = np.maximum(blink, np.exp(-0.5 * ((times - moment) / 0.05) ** 2))
        moment += rng.uniform(1.8, 4.5)
    lid = FACE_CURVES.index("lid_close")
    curves[:, lid] = np.maximum(curves[:, lid], blink)
    openness = mouth[:, 0] * (0.8 + 0.3 * intensity)
    return 0.02 + WIDEST_JAW * openness.clip(0, 1), curves.clip(0, 1)
