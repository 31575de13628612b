"""Arms and hands: sleeves with bands, and hands that show a palm or a back.

Paper:    -
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import numpy as np

from s2glib.body.skeleton import joint
from s2glib.corpus.appearance import Color
from s2glib.corpus.puppet.drawing import Canvas, Ink, Part, Point, Points, across, ink, mix
from s2glib.corpus.puppet.pose import HAND_ORDER, HAND_SCALE, Frame, Sketch

CONTOUR = 0.66  # shade of the line around clothes
_FLESH, _NAIL = (226, 158, 140), (255, 226, 220)
_FINGER_WIDTHS = {
    "thumb": 0.0235,
    "index": 0.0195,
    "middle": 0.0195,
    "ring": 0.0195,
    "pinky": 0.0165,
}
_BANDS: dict[str, tuple[float, ...]] = {  # where on a sleeve's upper and lower half
    "stripes": (0.18, 0.46, 0.74),
    "checks": (0.3, 0.7),
    "dots": (0.62, 0.78),
    "argyle": (0.35, 0.65),
    "pinstripes": (0.82,),
    "plain": (0.82,),
}
_ARMS = {"left": Part.LEFT_ARM, "right": Part.RIGHT_ARM}
_HANDS = {"left": Part.LEFT_HAND, "right": Part.RIGHT_HAND}


def paint_upper_arm(sketch: Sketch, side: str) -> None:
    """The sleeve down to the elbow."""
    outfit, part = sketch.look.outfit, _ARMS[side]
    tube = _Tube(sketch.frame, f"{side}_shoulder", f"{side}_elbow", (0.055, 0.045))
    tube.paint(sketch.canvas, outfit.cloth, part)
    if outfit.rolled_sleeves:
        tube.band(sketch.canvas, 0.93, 0.05, ink(outfit.cloth, part, 0.85))
    for share in _BANDS[outfit.pattern]:
        tube.band(sketch.canvas, share, 0.028, ink(outfit.accent, part))


def paint_forearm(sketch: Sketch, side: str) -> None:
    """The sleeve down to its cuff, or a bare arm."""
    outfit, part = sketch.look.outfit, _ARMS[side]
    elbow, wrist = f"{side}_elbow", f"{side}_wrist"
    if outfit.rolled_sleeves:
        bare = _Tube(sketch.frame, elbow, wrist, (0.038, 0.026))
        bare.paint(sketch.canvas, sketch.skin, part)
        return
    tube = _Tube(sketch.frame, elbow, wrist, (0.045, 0.034))
    tube.paint(sketch.canvas, outfit.cloth, part)
    for share in _BANDS[outfit.pattern]:
        tube.band(sketch.canvas, share, 0.028, ink(outfit.accent, part))
    tube.band(sketch.canvas, 0.97, 0.022, ink(outfit.cloth, part, 0.78))


class _Tube:
    """A tapered piece of arm between two joints, thicker where it is nearer."""

    def __init__(self, frame: Frame, start: str, end: str, radii: tuple[float, float]) -> None:
        self.a, self.b = frame.place[start], frame.place[end]
        self.radius_a, self.radius_b = radii[0] * frame.scale[start], radii[1] * frame.scale[end]
        self.normal = across(self.a, self.b)

    def paint(self, canvas: Canvas, color: Color, part: Part) -> None:
        """Contour, colour, and the side away from the light."""
        line = 0.07 * (self.radius_a + self.radius_b)
        dark, base, shade = (ink(color, part, light) for light in (CONTOUR, 1.0, 0.86))
        canvas.limb(self.a, self.b, self.radius_a, self.radius_b, dark)
        canvas.limb(self.a, self.b, self.radius_a - line, self.radius_b - line, base)
        below = self.normal if self.normal[1] > 0 else -self.normal
        edge = [self.a + 0.6 * self.radius_a * below, self.b + 0.6 * self.radius_b * below]
        canvas.stroke(np.array(edge), 0.5 * self.radius_b, shade)

    def band(self, canvas: Canvas, share: float, width: float, fill: Ink) -> None:
        """A ring around the arm, as wide as this many metres of an arm seen from the side."""
        middle = self.a + share * (self.b - self.a)
        radius = self.radius_a + share * (self.radius_b - self.radius_a)
        along = (self.b - self.a) * width / 0.52
        side = self.normal * radius * 0.93
        ring = [middle - along - side, middle + along - side]
        canvas.polygon(np.array([*ring, middle + along + side, middle - along + side]), fill)


def paint_hand(sketch: Sketch, side: str) -> None:
    """Fingers behind the palm, the palm or the back of the hand, fingers before it."""
    frame, part = sketch.frame, _HANDS[side]
    palm_seen = bool(frame.turn[joint(f"{side}_wrist"), 2, 1] < 0)  # at rest the palm faces down
    color = mix(sketch.skin, _FLESH, 0.30) if palm_seen else sketch.skin
    depth = {finger: frame.depth[f"{side}_{finger}2"] for finger in HAND_ORDER}
    level = frame.depth[f"{side}_middle1"] + 0.004
    order = sorted(HAND_ORDER, key=depth.__getitem__)
    behind = [finger for finger in order if depth[finger] < level]
    for finger in behind:
        _paint_finger(sketch, side, finger, ink(color, part), nail=not palm_seen)
    _paint_palm(sketch, side, ink(color, part), palm_seen=palm_seen)
    for finger in order[len(behind) :]:
        _paint_finger(sketch, side, finger, ink(color, part), nail=not palm_seen)


def _darker(color: Ink, shade: float) -> Ink:
    return ink(color[:3], Part(color[3]), shade)


def _paint_palm(sketch: Sketch, side: str, fill: Ink, *, palm_seen: bool) -> None:
    canvas, place = sketch.canvas, sketch.frame.place
    size = HAND_SCALE * sketch.frame.scale[f"{side}_middle1"]
    wrist = place[f"{side}_wrist"]
    knuckles = np.array([place[f"{side}_{f}1"] for f in ("index", "middle", "ring", "pinky")])
    heel = wrist + 0.25 * (knuckles[-1] - knuckles[0])
    ring = np.array([wrist, place[f"{side}_thumb1"], *knuckles, heel, wrist])
    for width, shade in ((0.031 * size, 0.78), (0.024 * size, 1.0)):
        canvas.limb(wrist, knuckles[1], width, 0.8 * width, _darker(fill, shade))
        canvas.polygon(ring, _darker(fill, shade))
        canvas.stroke(ring, width, _darker(fill, shade))
    if palm_seen:
        _paint_creases(canvas, wrist, knuckles, 0.0035 * size, _darker(fill, 0.82))
    else:
        for knuckle in knuckles:
            canvas.disc(knuckle, 0.004 * size, _darker(fill, 0.82))


def _paint_creases(canvas: Canvas, wrist: Point, knuckles: Points, width: float, fill: Ink) -> None:
    for share in (0.35, 0.62):
        shares = np.array([[0.9 * share], [share + 0.1], [share]])
        ends = np.array([knuckles[0], knuckles.mean(axis=0), knuckles[-1]])
        canvas.stroke(ends + shares * (wrist - ends), width, fill)


def _paint_finger(sketch: Sketch, side: str, finger: str, fill: Ink, *, nail: bool) -> None:
    names = [f"{side}_{finger}{bone}" for bone in ("1", "2", "3", "_tip")]
    points = np.array([sketch.frame.place[name] for name in names])
    size = HAND_SCALE * sketch.frame.scale[names[1]]
    width = _FINGER_WIDTHS[finger] * size
    sketch.canvas.stroke(points, width + 0.007 * size, _darker(fill, 0.72))
    sketch.canvas.stroke(points, width, fill)
    if nail:
        color = ink(mix(fill[:3], _NAIL, 0.55), Part(fill[3]))
        sketch.canvas.disc(points[3], 0.28 * width, color)
