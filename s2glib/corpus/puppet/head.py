"""The head: skin, beard, nose, mouth, eyes and glasses, drawn between the landmarks.

Paper:    -
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import numpy as np

from s2glib.body.skeleton import joint
from s2glib.corpus.appearance import Color
from s2glib.corpus.puppet.drawing import (
    Canvas,
    Chart,
    Part,
    Point,
    Points,
    arc,
    ink,
    mix,
    open_curve,
)
from s2glib.corpus.puppet.hair import cranium_ring, head_chart, paint_drape, paint_front_hair
from s2glib.corpus.puppet.pose import SIDES, Frame, Sketch

_LIPS, _BLUSH, _MOUTH = (176, 66, 74), (226, 112, 104), (92, 30, 34)
_TEETH, _TONGUE, _WHITE, _PUPIL = (246, 244, 238), (196, 92, 92), (252, 252, 250), (24, 20, 22)
_BROW, _GLASSES = (46, 32, 28), (44, 42, 52)
_LIGHT_EYES, _DARK_EYES = (74, 116, 138), (70, 44, 32)
_LIGHT_EYED = ("ivory", "rose")
_EYE_DIRECTION, _CHEEK_DIRECTION = (0.35, 0.0, 0.94), (0.6, 0.0, 0.8)  # of the left side


def paint_head(sketch: Sketch) -> None:
    """The head from the ears to the glasses."""
    chart = head_chart(sketch.frame)
    person = sketch.look.person
    if person.hair_style == "scarf":
        paint_drape(sketch, chart)
    _paint_skull(sketch, chart)
    if person.beard:
        _paint_beard(sketch)
    _paint_nose(sketch, chart.scale)
    _paint_mouth(sketch, chart.scale)
    for side in SIDES:
        if _facing(sketch.frame, side, _EYE_DIRECTION) > 0.5:
            _paint_eye(sketch, side, chart.scale)
            _paint_brow(sketch, side, chart.scale)
    paint_front_hair(sketch, chart)
    if person.glasses:
        _paint_glasses(sketch, chart)


def _facing(frame: Frame, side: str, direction: tuple[float, float, float]) -> float:
    """How much a side of the face is turned to the camera: 1 fully, 0 edge-on."""
    x, y, z = direction
    return float(frame.turn[joint("head"), 2] @ (x if side == "left" else -x, y, z))


def _paint_skull(sketch: Sketch, chart: Chart) -> None:
    canvas, frame, skin = sketch.canvas, sketch.frame, sketch.skin
    if sketch.look.person.hair_style != "scarf":
        for side in SIDES:
            canvas.disc(frame.place[f"{side}_ear"], 0.019 * chart.scale, ink(skin, Part.FACE, 0.84))
    canvas.polygon(cranium_ring(chart, 0.97, 1.0, 0.0, 360.0), ink(skin, Part.FACE))
    half = ("temple", "cheek", "jaw_corner", "chin_side")
    names = [f"left_{name}" for name in half] + ["chin"] + [f"right_{name}" for name in half[::-1]]
    canvas.blob(np.array([frame.place[name] for name in names]), ink(skin, Part.FACE))
    for side in SIDES:
        turned = max(0.0, _facing(frame, side, _CHEEK_DIRECTION) - 0.35)
        blush = ink(mix(skin, _BLUSH, 0.18), Part.FACE)
        canvas.disc(frame.place[f"{side}_blush"], 0.026 * turned * chart.scale, blush)


def _paint_beard(sketch: Sketch) -> None:
    outer = ["left_cheek", "left_jaw_corner", "left_chin_side", "chin"]
    outer += ["right_chin_side", "right_jaw_corner", "right_cheek"]
    between = sketch.frame.between
    inner = [
        between("right_jaw_corner", "right_mouth_corner", 0.45),
        between("right_mouth_corner", "right_nostril", 0.35),
        between("lip_top", "nose", 0.35),
        between("left_mouth_corner", "left_nostril", 0.35),
        between("left_jaw_corner", "left_mouth_corner", 0.45),
    ]
    ring = np.array([sketch.frame.place[name] for name in outer] + inner)
    sketch.canvas.blob(ring, ink(mix(sketch.hair, sketch.skin, 0.22), Part.FACE))


def _paint_nose(sketch: Sketch, scale: float) -> None:
    canvas, skin = sketch.canvas, sketch.skin
    names = ("bridge", "nose", "left_nostril", "right_nostril")
    bridge, tip, left, right = (sketch.frame.place[name] for name in names)
    canvas.polygon(np.array([bridge, tip, right]), ink(skin, Part.FACE, 0.93))
    ridge = ink(mix(skin, _WHITE, 0.12), Part.FACE)
    canvas.stroke(np.array([bridge, tip]), 0.009 * scale, ridge)
    under = tip + 0.30 * ((left + right) / 2 - bridge)
    wings = open_curve(np.array([left, under, right]))
    canvas.stroke(wings, 0.0065 * scale, ink(skin, Part.FACE, 0.68))


def _paint_mouth(sketch: Sketch, scale: float) -> None:
    canvas, place, skin = sketch.canvas, sketch.frame.place, sketch.skin
    right, left = place["right_mouth_corner"], place["left_mouth_corner"]
    lip_top, upper, lower, lip_bottom = (
        open_curve(np.array([right, place[name], left]))
        for name in ("lip_top", "mouth_top", "mouth_bottom", "lip_bottom")
    )
    _fill_between(canvas, lip_top, lip_bottom, mix(skin, _LIPS, 0.55))
    gap = lower - upper
    if np.hypot(*gap[len(gap) // 2]) < 0.006 * scale:
        closed = ink(mix(skin, _MOUTH, 0.8), Part.FACE)
        canvas.stroke((upper + lower) / 2, 0.005 * scale, closed)
    else:
        _fill_between(canvas, upper, lower, _MOUTH)
        _fill_between(canvas, upper + 0.72 * gap, lower, _TONGUE)
        _fill_between(canvas, upper, upper + 0.30 * gap, _TEETH)


def _fill_between(canvas: Canvas, upper: Points, lower: Points, color: Color) -> None:
    canvas.polygon(np.concatenate([upper, lower[::-1]]), ink(color, Part.FACE))


def _paint_eye(sketch: Sketch, side: str, scale: float) -> None:
    canvas, lash = sketch.canvas, ink(_PUPIL, Part.FACE)
    names = ("eye_inner", "lid_top", "eye_outer", "lid_bottom", "iris")
    inner, top, outer, bottom, iris = (sketch.frame.place[f"{side}_{name}"] for name in names)
    if np.hypot(*(top - bottom)) < 0.008 * scale:
        canvas.stroke(open_curve(np.array([inner, bottom, outer])), 0.006 * scale, lash)
        return
    canvas.blob(np.array([inner, top, outer, bottom]), ink(_WHITE, Part.FACE))
    shade = _LIGHT_EYES if sketch.look.person.skin in _LIGHT_EYED else _DARK_EYES
    shine = iris - 0.004 * scale
    for center, radius, color in (
        (iris, 0.0125, shade),
        (iris, 0.0065, _PUPIL),
        (shine, 0.0035, _WHITE),
    ):
        canvas.polygon(_between_lids(center, radius * scale, top, bottom), ink(color, Part.FACE))
    canvas.stroke(open_curve(np.array([inner, top, outer])), 0.005 * scale, lash)


def _between_lids(center: Point, radius: float, top: Point, bottom: Point) -> Points:
    """A disc, cut where the lids cover it."""
    opening = float(np.hypot(*(top - bottom)))
    up = (top - bottom) / opening
    ring = arc(center, np.array([radius, 0.0]), np.array([0.0, radius]), 0.0, 360.0)
    height = (ring - bottom) @ up
    return ring + (height.clip(0.0, opening) - height)[:, None] * up


def _paint_brow(sketch: Sketch, side: str, scale: float) -> None:
    names = [f"{side}_brow_{place}" for place in ("inner", "middle", "outer")]
    line = open_curve(np.array([sketch.frame.place[name] for name in names]))
    sketch.canvas.stroke(line, 0.0085 * scale, ink(mix(sketch.hair, _BROW, 0.55), Part.FACE))


def _paint_glasses(sketch: Sketch, chart: Chart) -> None:
    canvas, place, fill = sketch.canvas, sketch.frame.place, ink(_GLASSES, Part.FACE)
    width, (right, up) = 0.0048 * chart.scale, (0.0235 * chart.across, 0.0205 * chart.along)
    for side, outwards in (("left", right), ("right", -right)):
        eye = place[f"{side}_eye"]
        canvas.stroke(arc(eye, right, up, 0.0, 360.0), width, fill)
        canvas.stroke(np.array([eye + outwards, place[f"{side}_sideburn"]]), width, fill)
    bridge = np.array([place["left_eye"] - right, place["right_eye"] + right])
    canvas.stroke(bridge, width, fill)
