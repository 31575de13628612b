"""From words to hand paths: which strokes happen, when, and the way the hands take.

Strokes end just before stressed vowels. Between key positions hands move with minimum jerk; on
every stressed vowel the hand's path turns (a zigzag), which is what ties motion to speech.

Paper:    AM E (beat alignment), method: ours
Notebook: notebooks/18_beats.ipynb
"""

from typing import NamedTuple

import numpy as np

from s2glib.corpus.bearing import Performance
from s2glib.corpus.clock import Timing
from s2glib.corpus.lexicon import GESTURES, HAND_SHAPES, PALMS, SEMANTIC_WEIGHT
from s2glib.data.samples import GESTURE_TYPES

SIDES = ("left", "right")
EARLY = 0.05  # seconds from the end of a stroke to the stressed vowel
_FASTEST = 4.5  # arm lengths a second, averaged over a move; its peak is 1.9 times that
_CENTRE = np.array([0.12, -0.35, 0.50])  # gestures grow and shrink around here
_ZIGZAG = 0.10  # arm lengths
_ZIGZAG_DIRECTION = np.array([0.25, 1.0, 0.45])
_ZIGZAG_EARLY = 0.02
_ZIGZAG_TURNS = 0.88  # share of stressed vowels on which the path turns


class Stroke(NamedTuple):
    """A gesture and the moment it culminates (seconds)."""

    apex: float
    name: str
    scale: float


class Key(NamedTuple):
    """Where a hand is at one moment, in arm lengths from its shoulder."""

    time: float
    place: np.ndarray
    palm: str
    shape: str


class HandPath(NamedTuple):
    """A hand over time: wrist (frames, 3), palm normal (frames, 3), shape (frames, 6)."""

    wrist: np.ndarray
    palm: np.ndarray
    shape: np.ndarray


def minimum_jerk(progress: np.ndarray) -> np.ndarray:
    """The smoothest way from 0 to 1."""
    u = np.clip(progress, 0, 1)
    return u**3 * (10 - 15 * u + 6 * u**2)


def smooth(values: np.ndarray, width: int) -> np.ndarray:
    """Average over a Hann window of `width` frames, along the first axis."""
    window = np.hanning(width + 2)[1:-1]
    window /= window.sum()
    padded = np.pad(values, ((width // 2, width - 1 - width // 2), (0, 0)), mode="edge")
    return np.stack([np.convolve(column, window, "valid") for column in padded.T], axis=1)


def plan_strokes(
    marks: dict[int, str], timing: Timing, performance: Performance, rng: np.random.Generator
) -> list[Stroke]:
    """Decide for every word whether a gesture or a beat goes with it, and when."""
    bearing, manner = performance.bearing, performance.manner
    strokes: list[Stroke] = []
    last = -1.0
    for word, (start, end) in enumerate(zip(timing.word_starts, timing.word_ends, strict=True)):
        stresses = [s for s in timing.stress_times if start - 1e-3 <= s < end]
        apex = (stresses[0] if stresses else start) - EARLY
        chance, size = rng.random(), rng.uniform(0.4, 1.0)
        if word in marks and chance < bearing.gestures + manner.eagerness:
            name, scale, gap = marks[word], 1.0, 0.30
        elif (word in marks or stresses) and rng.random() < bearing.beats * 0.85:
            name, scale, gap = "beat", size, 0.28 / bearing.tempo
        else:
            continue
        if apex - last < gap:
            if name == "beat":
                continue
            if strokes and strokes[-1].name == "beat":
                strokes.pop()
        jitter = 0.3 * manner.lag + rng.normal(0, 0.015)
        strokes.append(Stroke(max(apex + jitter, 0.3), name, scale))
        last = apex
    return strokes


def hand_keys(
    strokes: list[Stroke],
    side: str,
    duration: float,
    performance: Performance,
    rng: np.random.Generator,
) -> list[Key]:
    """Key positions of one hand: rest, stroke by stroke, and back to rest in long pauses."""
    bearing, manner = performance.bearing, performance.manner
    resting = ("in", "fist" if bearing.tension > 0.5 else "relax")
    rest = performance.rest + rng.normal(0, 0.02, 3)
    joins = [side == manner.dominant or GESTURES[s.name].hands == "both" for s in strokes]
    joins = [j or rng.random() < bearing.second_hand * 0.8 for j in joins]
    mine = [stroke for stroke, join in zip(strokes, joins, strict=True) if join]
    keys = [Key(0.0, rest, *resting)]
    for number, stroke in enumerate(mine):
        keys += _stroke_keys(stroke, performance, rng)
        following = mine[number + 1].apex if number + 1 < len(mine) else duration + 9
        end = keys[-1].time
        if following - end > 0.9 / bearing.tempo:
            away = rest + rng.normal(0, 0.025, 3)
            keys.append(Key(end + 0.55 / bearing.tempo, away, *resting))
    return _unhurried(_thinned(sorted(keys, key=lambda key: key.time)))


def _stroke_keys(stroke: Stroke, performance: Performance, rng) -> list[Key]:
    bearing = performance.bearing
    gesture = GESTURES[stroke.name]
    size = bearing.amplitude * stroke.scale
    lift = np.array([bearing.elbows, bearing.height, 0.0]) + rng.normal(0, 0.02, 3)
    start = _CENTRE + (np.array(gesture.start) - _CENTRE) * size + lift
    end = _CENTRE + (np.array(gesture.end) - _CENTRE) * size + lift
    shape = gesture.shape
    if stroke.name == "self":
        end = np.array(gesture.end) + (0.0, 0.5 * bearing.height, 0.0)
    if stroke.name == "beat":
        start = end + np.array([-0.02, 0.20 * size, -0.06])
        shape = "fist" if bearing.tension > 0.5 else "open" if bearing.tension < -0.2 else "relax"
    span = float(np.clip(0.22 / bearing.tempo, 0.11, 0.4))
    begin = stroke.apex - span
    places = [(begin, start), *_path(gesture, begin, span, start, end, bearing.amplitude)]
    time, place = places[-1]
    is_beat = gesture.kind == "beat"
    hold = float(np.clip(0.15 / bearing.tempo * (0.6 if is_beat else 1.6), 0.05, 0.5))
    places.append((time + hold, place + rng.normal(0, 0.01, 3)))
    return [Key(time, place, gesture.palm, shape) for time, place in places]


def _path(gesture, begin, span, start, end, amplitude):
    """(time, place) after the start: a line, maybe repeated; a hop; or a circle."""
    if gesture.path == "circle":
        angles = np.arange(1, 4 * gesture.repeats + 1) * np.pi / 2
        around = np.stack([np.sin(angles), np.cos(angles), 0 * angles], axis=1)
        times = begin + np.arange(1, len(angles) + 1) * 0.55 * span
        return list(zip(times, end + 0.13 * amplitude * around, strict=True))
    if gesture.path == "hop":
        return [
            (begin + 0.8 * span * n, start + (end - start) * n / 3 + (0, 0.08 * (n % 2), 0))
            for n in (1, 2, 3)
        ]
    places, time = [], begin + span
    for repeat in range(gesture.repeats):
        places.append((time, end))
        if repeat < gesture.repeats - 1:
            places.append((time + 0.9 * span, start + 0.35 * (end - start)))
            time += 1.9 * span
    return places


def _thinned(keys: list[Key], gap: float = 0.06) -> list[Key]:
    """Of keys that crowd together, keep the latest."""
    kept = keys[:1]
    for key in keys[1:]:
        if key.time - kept[-1].time < gap:
            kept.pop()
        kept.append(key)
    return kept


def _unhurried(keys: list[Key]) -> list[Key]:
    """Where there is too little time for a move, make the move smaller."""
    slow = keys[:1]
    for key in keys[1:]:
        move = key.place - slow[-1].place
        room = _FASTEST * (key.time - slow[-1].time)
        share = min(1.0, room / max(float(np.linalg.norm(move)), 1e-9))
        slow.append(key._replace(place=slow[-1].place + share * move))
    return slow


def zigzag(
    timing: Timing, times: np.ndarray, performance: Performance, rng: np.random.Generator
) -> np.ndarray:
    """(frames,) an offset that changes sign on stressed vowels and nowhere else."""
    knots, values, value = [0.0], [0.0], 0.0
    for stress in timing.stress_times:
        if stress - knots[-1] < 0.16:
            continue
        if rng.random() < _ZIGZAG_TURNS:
            value = (1.0 if value <= 0 else -1.0) * rng.uniform(0.7, 1.3)
        knots.append(stress - _ZIGZAG_EARLY)
        values.append(value)
    size = _ZIGZAG * (0.6 + 0.4 * performance.bearing.amplitude)
    return size * _between(np.array(knots), np.array(values)[:, None], times, np.inf)[:, 0]


def _between(knots, values, times, longest):
    """Minimum-jerk interpolation; a move takes at most `longest` seconds before its knot."""
    low = np.clip(np.searchsorted(knots, times, "right") - 1, 0, len(knots) - 1)
    high = np.minimum(low + 1, len(knots) - 1)
    span = np.minimum(np.maximum(knots[high] - knots[low], 1e-3), longest)
    progress = minimum_jerk((times - (knots[high] - span)) / span)
    progress = np.where(low == high, 0.0, progress)[:, None]
    return values[low] * (1 - progress) + values[high] * progress


def hand_path(
    keys: list[Key],
    times: np.ndarray,
    turn: np.ndarray,
    performance: Performance,
    rng: np.random.Generator,
) -> HandPath:
    """Join the keys, with a small arc, and add the zigzag `turn`, drift and tremor."""
    bearing, manner = performance.bearing, performance.manner
    knots = np.array([key.time for key in keys])
    longest = 0.8 / bearing.tempo
    place = _between(knots, np.stack([key.place for key in keys]), times, longest)
    palm = _between(knots, np.array([PALMS[key.palm] for key in keys]), times, longest)
    shape = _between(knots, np.array([HAND_SHAPES[key.shape] for key in keys]), times, longest)
    drift = smooth(rng.normal(0, 1, (len(times), 3)), 41) * 0.025
    tremor = smooth(rng.normal(0, 1, (len(times), 3)), 5) * 0.9 * bearing.tremor
    wrist = place + drift + tremor + turn[:, None] * _ZIGZAG_DIRECTION
    fingers = np.array([1, 1, 1, 1, 0.6, 0]) * max(bearing.tension, 0) * 0.25
    fingers = fingers - manner.openness * 0.1 * np.array([1, 1, 1, 1, 1, -1])
    palm = palm / np.linalg.norm(palm, axis=1, keepdims=True).clip(1e-6)
    return HandPath(wrist, palm, smooth(np.clip(shape + fingers, 0, 1), 5))


def meaning(
    strokes: list[Stroke], times: np.ndarray, tempo: float
) -> tuple[np.ndarray, np.ndarray]:
    """Semantic score in [0, 1] and gesture type (index into `GESTURE_TYPES`) per frame."""
    semantic, kind = np.zeros(len(times)), np.zeros(len(times), dtype=np.int64)
    before = float(np.clip(0.22 / tempo, 0.11, 0.4))
    after = float(np.clip(0.24 / tempo, 0.05, 0.5))
    for stroke in strokes:
        name = GESTURES[stroke.name].kind
        score = SEMANTIC_WEIGHT[name] * stroke.scale
        inside = (times > stroke.apex - before) & (times < stroke.apex + after)
        wins = inside & (score > semantic)
        semantic[wins] = score
        kind[wins] = GESTURE_TYPES.index(name)
    return semantic, kind
