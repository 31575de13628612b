"""Hair and headscarves: what hangs behind the head, and what covers the forehead.

Paper:    -
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from s2glib.body.skeleton import joint
from s2glib.corpus.puppet.drawing import (
    Canvas,
    Chart,
    Ink,
    Part,
    Points,
    arc,
    closed_curve,
    ink,
    mix,
    open_curve,
)
from s2glib.corpus.puppet.pose import HEAD_SCALE, Frame, Sketch

_CRANIUM = np.array([0.078, 0.094])  # half axes in metres of the head bone
_WHITE = (255, 255, 255)
# Outlines on the head's chart: metres to the left of the cranium's middle and up from it.
_TAIL = ((0.03, 0.09), (0.10, 0.07), (0.128, -0.04), (0.118, -0.17), (0.085, -0.10), (0.05, 0.0))
_DRAPE = ((0.088, 0.02), (0.060, -0.05), (0.0, -0.085), (-0.060, -0.05), (-0.088, 0.02))
_LENGTHS = {"bob": -0.125, "long": -0.27}
_CAPS = {  # how far the hair stands out, in shares of the cranium: sideways and upwards
    "short": (1.06, 1.11),
    "parted": (1.09, 1.17),
    "crop": (1.02, 1.03),
    "curls": (1.12, 1.14),
    "bob": (1.14, 1.13),
    "long": (1.12, 1.12),
    "bun": (1.05, 1.07),
    "tail": (1.06, 1.09),
    "scarf": (1.21, 1.16),
}


def head_chart(frame: Frame) -> Chart:
    """A chart of the head that rolls with it but always faces the camera."""
    scale = HEAD_SCALE * frame.scale["head"]
    up = frame.turn[joint("head"), :2, 1] * (1, -1)
    length = float(np.hypot(*up))
    up = up / length if length > 0.1 else np.array([0.0, -1.0])
    return Chart(frame.place["cranium"], np.array([-up[1], up[0]]) * scale, up * scale)


def cranium_ring(chart: Chart, width: float, height: float, start: float, stop: float) -> Points:
    """Part of an ellipse around the cranium, its axes in shares of the cranium's."""
    right, up = chart.across * _CRANIUM[0] * width, chart.along * _CRANIUM[1] * height
    return arc(chart.origin, right, up, start, stop)


def paint_back_hair(sketch: Sketch) -> None:
    """What hangs or stands behind the head."""
    paint = _BACKS.get(sketch.look.person.hair_style)
    if paint:
        paint(sketch.canvas, head_chart(sketch.frame), ink(sketch.hair, Part.HAIR, 0.78))


def _curls(canvas: Canvas, chart: Chart, fill: Ink) -> None:
    for lock in cranium_ring(chart, 1.16, 1.12, -35.0, 215.0)[::2]:
        canvas.disc(lock, 0.036 * chart.scale, fill)


def _bun(canvas: Canvas, chart: Chart, fill: Ink) -> None:
    canvas.disc(chart.at((0.0, 0.125))[0], 0.047 * chart.scale, fill)


def _tail(canvas: Canvas, chart: Chart, fill: Ink) -> None:
    canvas.blob(chart.at(*_TAIL), fill)


def _fall(low: float, canvas: Canvas, chart: Chart, fill: Ink) -> None:
    side = ((0.086, 0.03), (0.102, 0.5 * low), (0.092, low), (0.04, low - 0.012))
    left = chart.at(*side)[::-1]
    right = chart.at(*((-x, y) for x, y in side))
    crown = cranium_ring(chart, 1.14, 1.12, 10.0, 170.0)
    canvas.blob(np.concatenate([crown, right, left]), fill)


_BACKS: dict[str, Callable[[Canvas, Chart, Ink], None]] = {
    "curls": _curls,
    "bun": _bun,
    "tail": _tail,
    **{style: partial(_fall, low) for style, low in _LENGTHS.items()},
}


def paint_drape(sketch: Sketch, chart: Chart) -> None:
    """The part of a headscarf that lies round the face and on the collar."""
    collar = chart._replace(origin=sketch.frame.place["neck"]).at(*_DRAPE)
    crown = cranium_ring(chart, 1.24, 1.17, -10.0, 190.0)[::-1]
    outline = closed_curve(np.concatenate([collar, crown]))
    sketch.canvas.polygon(outline, ink(sketch.hair, Part.HAIR, 0.9))


def paint_front_hair(sketch: Sketch, chart: Chart) -> None:
    """What lies on the head, down to the hairline."""
    canvas, style = sketch.canvas, sketch.look.person.hair_style
    if style == "bald":
        return
    thin = 0.25 if style == "crop" else 0.0
    fill = ink(mix(sketch.hair, sketch.skin, thin), Part.HAIR)
    width, height = _CAPS[style]
    hairline = _hairline(sketch.frame, chart, style)
    canvas.polygon(
        np.concatenate([cranium_ring(chart, width, height, -6.0, 186.0), hairline]), fill
    )
    if style == "curls":
        for lock in cranium_ring(chart, 1.08, 1.06, 5.0, 175.0)[::2]:
            canvas.disc(lock, 0.030 * chart.scale, fill)
    if style in _LENGTHS:
        _paint_locks(canvas, chart, 0.8 * _LENGTHS[style], fill)
    if style not in ("crop", "scarf"):
        shine = cranium_ring(chart, 0.78 * width, 0.92 * height, 105.0, 140.0)
        canvas.stroke(shine, 0.007 * chart.scale, ink(mix(sketch.hair, _WHITE, 0.22), Part.HAIR))


def _hairline(frame: Frame, chart: Chart, style: str) -> Points:
    """From the right sideburn over the forehead to the left one, never outside the head."""
    names = ["right_sideburn", "right_hairline", "forehead", "left_hairline", "left_sideburn"]
    line = np.array([frame.place[name] for name in names])
    if style == "parted":
        line[1] += 0.22 * (frame.place["right_brow_middle"] - line[1])
        line[3] += 0.0105 * chart.along
    axes = np.array([chart.across, chart.along]) * _CRANIUM[:, None]
    reach = np.linalg.norm((line - chart.origin) @ np.linalg.inv(axes), axis=1, keepdims=True)
    return open_curve(chart.origin + (line - chart.origin) / np.maximum(1, reach))


def _paint_locks(canvas: Canvas, chart: Chart, low: float, fill: Ink) -> None:
    lock = ((0.060, 0.062), (0.085, 0.05), (0.101, 0.4 * low), (0.094, low), (0.072, 0.9 * low),
            (0.070, 0.0))  # fmt: skip
    for sign in (-1, 1):
        canvas.blob(chart.at(*((sign * x, y) for x, y in lock)), fill)
