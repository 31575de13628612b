"""The figure: everything of the speaker, from far to near; and the clothed trunk.

Paper:    -
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from functools import partial

import numpy as np
from PIL import Image

from s2glib.body.skeleton import REST_JOINTS, joint
from s2glib.corpus.puppet.drawing import Chart, Part, Point, Points, across, closed_curve, ink
from s2glib.corpus.puppet.hair import paint_back_hair
from s2glib.corpus.puppet.head import paint_head
from s2glib.corpus.puppet.limbs import CONTOUR, paint_forearm, paint_hand, paint_upper_arm
from s2glib.corpus.puppet.pose import SIDES, Frame, Sketch
from s2glib.corpus.puppet.scenery import CLOTH_PIXEL, CLOTH_SIZE, COLLAR_ROW

_SLEEVE_LIFT = 0.07  # metres: sleeves lie on the trunk's surface, not in its middle
_SHOULDER_WIDTH = 2 * REST_JOINTS[joint("left_shoulder"), 0]
_TRUNK_LENGTH = REST_JOINTS[joint("neck"), 1]
_BUTTON = (245, 242, 232)
# Outlines on the trunk's chart: metres to the left of the neck and down from it.
_FLANK = ((0.146, 0.28), (0.158, 0.48), (0.168, 0.95))
_CREW = ((-0.064, -0.02), (-0.052, 0.022), (-0.028, 0.048), (0.0, 0.056), (0.028, 0.048),
         (0.052, 0.022), (0.064, -0.02))  # fmt: skip
_VEE = ((-0.064, -0.025), (0.0, 0.135), (0.064, -0.025))
_PLACKET = ((0.0, 0.075), (0.0, 0.9))
_WING = ((0.05, -0.045), (0.075, -0.01), (0.060, 0.085), (0.0, 0.070))
_INSIDE = ((-0.07, -0.03), (0.07, -0.03), (0.06, 0.20), (0.045, 0.95), (-0.045, 0.95),
           (-0.06, 0.20))  # fmt: skip
_LAPEL = ((0.055, -0.045), (0.085, -0.01), (0.125, 0.12), (0.095, 0.14), (0.105, 0.165),
          (0.05, 0.34))  # fmt: skip


def paint_figure(sketch: Sketch, cloth: Image.Image) -> None:
    """Paint the speaker: what is nearer hides what is farther."""
    depth = sketch.frame.depth
    trunk = (depth["neck"] + depth["pelvis"]) / 2
    head = max(depth["head"], trunk + 0.01)
    layers = [
        (min(head - 0.12, trunk - 0.01), partial(paint_back_hair, sketch)),
        (trunk, partial(_paint_trunk, sketch, cloth)),
        (head, partial(paint_head, sketch)),
    ]
    for side in SIDES:
        shoulder, elbow, wrist, knuckle = (
            depth[f"{side}_{name}"] + _SLEEVE_LIFT
            for name in ("shoulder", "elbow", "wrist", "middle1")
        )
        layers += [
            ((shoulder + elbow) / 2, partial(paint_upper_arm, sketch, side)),
            ((elbow + wrist) / 2, partial(paint_forearm, sketch, side)),
            ((wrist + knuckle) / 2, partial(paint_hand, sketch, side)),
        ]
    for _, paint in sorted(layers, key=lambda layer: layer[0]):
        paint()


def _trunk_chart(frame: Frame, build: float) -> Chart:
    """Across the shoulders and down the spine, kept upright where the body is seen edge-on."""
    scale = frame.scale["neck"]
    right = (frame.place["left_shoulder"] - frame.place["right_shoulder"]) / _SHOULDER_WIDTH
    down = (frame.place["pelvis"] - frame.place["neck"]) / _TRUNK_LENGTH
    right = _at_least(right, 0.5 * scale)
    down = _at_least(down, 0.5 * scale)
    if abs(right[0] * down[1] - right[1] * down[0]) < 0.2 * scale * scale:
        right, down = np.array([scale, 0.0]), np.array([0.0, scale])
    return Chart(frame.place["neck"], build * right, down)


def _at_least(vector: Point, length: float) -> Point:
    return vector * max(1.0, length / max(float(np.hypot(*vector)), 1e-6))


def _paint_trunk(sketch: Sketch, cloth: Image.Image) -> None:
    canvas, frame, look = sketch
    chart = _trunk_chart(frame, look.person.build)
    outline = closed_curve(_trunk_outline(frame, chart))
    axes = np.array([chart.across, chart.along]) * CLOTH_PIXEL
    corner = chart.origin - axes[0] * CLOTH_SIZE[0] / 2 - axes[1] * COLLAR_ROW
    canvas.texture(outline, cloth, corner, axes)
    canvas.stroke(outline, 0.006 * chart.scale, ink(look.outfit.cloth, Part.TRUNK, CONTOUR))
    _paint_neck(sketch)
    _NECKLINES[look.outfit.neckline](sketch, chart)


def _trunk_outline(frame: Frame, chart: Chart) -> Points:
    return np.concatenate(
        [_half_outline(frame, chart, "left", 1), _half_outline(frame, chart, "right", -1)[::-1]]
    )


def _half_outline(frame: Frame, chart: Chart, side: str, sign: int) -> Points:
    """From the neck over the shoulder, wherever it is, and down the flank."""
    shoulder = frame.place[f"{side}_shoulder"]
    neck = chart.at((sign * 0.045, -0.015))[0]
    top = shoulder - 0.052 * chart.along
    slope = (neck + top) / 2 + 0.004 * chart.along
    tip = shoulder + sign * 0.040 * chart.across - 0.015 * chart.along
    armpit = shoulder + sign * 0.012 * chart.across + 0.110 * chart.along
    flank = chart.at(*((sign * x, y) for x, y in _FLANK))
    return np.array([neck, slope, top, tip, armpit, *flank])


def _paint_neck(sketch: Sketch) -> None:
    canvas, frame, _ = sketch
    scale = frame.scale["neck"]
    low, high = frame.place["neck"], frame.place["head"]
    canvas.limb(low, high, 0.056 * scale, 0.050 * scale, ink(sketch.skin, Part.NECK, 0.86))
    shadow = low + 0.80 * (high - low)
    canvas.limb(shadow, high, 0.049 * scale, 0.049 * scale, ink(sketch.skin, Part.NECK, 0.74))


def _crew(sketch: Sketch, chart: Chart) -> None:
    edge = chart.at(*_CREW)
    sketch.canvas.polygon(edge, ink(sketch.skin, Part.NECK, 0.90))
    hem = ink(sketch.look.outfit.accent, Part.TRUNK, 0.92)
    sketch.canvas.stroke(edge, 0.017 * chart.scale, hem)


def _vee(sketch: Sketch, chart: Chart) -> None:
    edge = chart.at(*_VEE)
    sketch.canvas.polygon(edge, ink(sketch.skin, Part.NECK, 0.92))
    hem = ink(sketch.look.outfit.accent, Part.TRUNK, 0.92)
    sketch.canvas.stroke(edge, 0.018 * chart.scale, hem)


def _roll(sketch: Sketch, chart: Chart) -> None:
    scale, cloth = chart.scale, sketch.look.outfit.cloth
    low, high = chart.at((0.0, 0.025))[0], sketch.frame.between("neck", "head", 0.38)
    sketch.canvas.limb(low, high, 0.066 * scale, 0.058 * scale, ink(cloth, Part.TRUNK, 0.84))
    fold = across(low, high) * 0.058 * scale
    sketch.canvas.stroke(
        np.array([high - fold, high + fold]), 0.018 * scale, ink(cloth, Part.TRUNK)
    )


def _shirt(sketch: Sketch, chart: Chart) -> None:
    canvas, scale, cloth = sketch.canvas, chart.scale, sketch.look.outfit.cloth
    _open_collar(sketch, chart, 0.075)
    canvas.stroke(chart.at(*_PLACKET), 0.034 * scale, ink(cloth, Part.TRUNK, 0.93))
    for button in chart.at(*((0.0, 0.12 + 0.09 * row) for row in range(7))):
        canvas.disc(button, 0.0075 * scale, ink(_BUTTON, Part.TRUNK))
    for sign in (-1, 1):
        wing = chart.at(*((sign * x, y) for x, y in _WING))
        canvas.polygon(wing, ink(cloth, Part.TRUNK, 1.12))
        canvas.stroke(wing[1:], 0.007 * scale, ink(cloth, Part.TRUNK, 0.6))


def _jacket(sketch: Sketch, chart: Chart) -> None:
    canvas, outfit = sketch.canvas, sketch.look.outfit
    canvas.polygon(chart.at(*_INSIDE), ink(outfit.accent, Part.TRUNK))
    _open_collar(sketch, chart, 0.09)
    for sign in (-1, 1):
        lapel = chart.at(*((sign * x, y) for x, y in _LAPEL))
        canvas.polygon(lapel, ink(outfit.cloth, Part.TRUNK, 0.82))
        canvas.stroke(lapel[2:], 0.007 * chart.scale, ink(outfit.cloth, Part.TRUNK, 0.55))


def _open_collar(sketch: Sketch, chart: Chart, depth: float) -> None:
    edge = chart.at((-0.06, -0.03), (0.0, depth), (0.06, -0.03))
    sketch.canvas.polygon(edge, ink(sketch.skin, Part.NECK, 0.92))


_NECKLINES = {"crew": _crew, "vee": _vee, "roll": _roll, "shirt": _shirt, "jacket": _jacket}
