"""Drawing: a camera, a canvas that records what it paints, and the textures of cloth and walls.

Ink is a colour and a part. Every stroke writes both at once, so the map of parts is not an
estimate of the picture but the same picture in other colours.

Paper:    MDD B.3 (masks of hands and face, exact here)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from enum import IntEnum
from functools import cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image, ImageDraw

Ink = tuple[int, int, int, int]  # red, green, blue, part
Color = tuple[int, int, int]
Points = Float[np.ndarray, "_ 2"]
Point = Float[np.ndarray, " 2"]

_CURVE_STEPS = 6


class Part(IntEnum):
    """What a pixel shows."""

    BACKGROUND = 0
    TRUNK = 1  # clothes without the sleeves
    NECK = 2
    HAIR = 3  # or a headscarf
    FACE = 4  # skin, eyes, mouth, ears, beard, glasses
    LEFT_ARM = 5
    RIGHT_ARM = 6
    LEFT_HAND = 7
    RIGHT_HAND = 8


class Camera(NamedTuple):
    """A pinhole on the body's front, a few metres away; the picture spans `span` metres."""

    center: Float[np.ndarray, " 3"]  # the point in the middle of the picture
    span: float
    distance: float
    size: int  # pixels

    def pixels_per_metre(self, points: Float[np.ndarray, "*b 3"]) -> Float[np.ndarray, "*b"]:
        """How large things look at these points; nearer is larger."""
        depth = self.distance - (points[..., 2] - self.center[2])
        return self.size / self.span * self.distance / depth.clip(self.distance / 4)

    def project(self, points: Float[np.ndarray, "*b 3"]) -> Float[np.ndarray, "*b 2"]:
        """Pixels, x then y from the top left corner of the picture; the body's left is right."""
        offset = (points - self.center)[..., :2] * (1, -1)
        return self.size / 2 + offset * self.pixels_per_metre(points)[..., None]


@cache
def ink(color: Color, part: int, shade: float = 1.0) -> Ink:
    """A colour, made darker or lighter, that also writes a part."""
    red, green, blue = (min(255, round(channel * shade)) for channel in color)
    return red, green, blue, part


def mix(color: Color, other: Color, share: float) -> Color:
    """The colour with a share of another."""
    red, green, blue = (round(a + share * (b - a)) for a, b in zip(color, other, strict=True))
    return red, green, blue


@cache
def _catmull_rom(steps: int) -> Float[np.ndarray, "steps 4"]:
    u = np.arange(steps)[:, None] / steps
    return np.hstack(
        [-u + 2 * u**2 - u**3, 2 - 5 * u**2 + 3 * u**3, u + 4 * u**2 - 3 * u**3, -(u**2) + u**3]
    ) / 2  # fmt: skip


def closed_curve(points: Points) -> Points:
    """A smooth ring through the points (Catmull-Rom)."""
    neighbours = np.stack([np.roll(points, shift, axis=0) for shift in (1, 0, -1, -2)])
    return np.einsum("sk,knd->nsd", _catmull_rom(_CURVE_STEPS), neighbours).reshape(-1, 2)


def open_curve(points: Points) -> Points:
    """A smooth line through the points, ends included."""
    padded = np.concatenate([points[:1], points, points[-1:]])
    neighbours = np.stack([padded[k : len(points) - 1 + k] for k in range(4)])
    curve = np.einsum("sk,knd->nsd", _catmull_rom(_CURVE_STEPS), neighbours).reshape(-1, 2)
    return np.concatenate([curve, points[-1:]])


def arc(center: Point, right: Point, up: Point, start: float, stop: float, n: int = 20) -> Points:
    """Points on an ellipse with these half axes, by angle in degrees from `right` to `up`."""
    cosine, sine = _circle(start, stop, n)
    return center + cosine * right + sine * up


@cache
def _circle(start: float, stop: float, n: int) -> tuple[np.ndarray, np.ndarray]:
    angle = np.radians(np.linspace(start, stop, n))[:, None]
    return np.cos(angle), np.sin(angle)


class Chart(NamedTuple):
    """A flat chart of a body part: where its metres lie on the canvas."""

    origin: Point
    across: Point  # pixels per metre towards the body's left
    along: Point  # pixels per metre down the trunk, or up the head

    def at(self, *places: tuple[float, float]) -> Points:
        """The canvas places of chart points."""
        return self.origin + np.array(places) @ np.array([self.across, self.along])

    @property
    def scale(self) -> float:
        """Pixels per metre along the chart."""
        return float(np.hypot(*self.along))


class Canvas:
    """A picture in the making: red, green, blue, and in place of opacity the part."""

    def __init__(self, background: Image.Image) -> None:
        self.image = background.copy()
        self._draw = ImageDraw.Draw(self.image)

    def polygon(self, points: Points, fill: Ink) -> None:
        """Fill an outline."""
        self._draw.polygon(points.ravel().tolist(), fill=fill)

    def blob(self, points: Points, fill: Ink) -> None:
        """Fill a smooth ring through the points."""
        self.polygon(closed_curve(points), fill)

    def disc(self, center: Point, radius: float, fill: Ink) -> None:
        """Fill a circle."""
        x, y = center.tolist()
        self._draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=fill)

    def stroke(self, points: Points, width: float, fill: Ink) -> None:
        """A line with round ends and corners."""
        self._draw.line(
            points.ravel().tolist(), fill=fill, width=max(1, round(width)), joint="curve"
        )
        if width > 2:
            self.disc(points[0], width / 2, fill)
            self.disc(points[-1], width / 2, fill)

    def limb(self, a: Point, b: Point, radius_a: float, radius_b: float, fill: Ink) -> None:
        """A capsule that tapers from one end to the other."""
        normal = across(a, b)
        near, far = normal * radius_a, normal * radius_b
        self.polygon(np.array([a + near, b + far, b - far, a - near]), fill)
        self.disc(a, radius_a, fill)
        self.disc(b, radius_b, fill)

    def texture(self, outline: Points, tile: Image.Image, origin: Point, axes: Points) -> None:
        """Fill an outline with a tile whose pixel (u, v) lies at origin + u axes[0] + v axes[1]."""
        low = np.floor(outline.min(axis=0).clip(0, self.image.width - 1)).astype(int)
        high = np.ceil(outline.max(axis=0).clip(1, self.image.width)).astype(int)
        width, height = (high - low).clip(1).tolist()
        mask = Image.new("L", (width, height))
        ImageDraw.Draw(mask).polygon((outline - low).ravel().tolist(), fill=255)
        inverse = np.linalg.inv(axes.T)
        (a, b), (d, e) = inverse.tolist()
        c, f = (inverse @ (low - origin)).tolist()
        cloth = tile.transform((width, height), Image.Transform.AFFINE, (a, b, c, d, e, f))
        self.image.paste(cloth, tuple(low.tolist()), mask)


def across(a: Point, b: Point) -> Point:
    """The unit normal of the line from a to b; any direction if they coincide."""
    x, y = (b - a).tolist()
    length = max((x * x + y * y) ** 0.5, 1e-6)
    return np.array([-y / length, x / length])


class Picture(NamedTuple):
    """A finished frame: colours, and the part at the centre of every pixel."""

    frame: UInt8[np.ndarray, "h w 3"]
    parts: UInt8[np.ndarray, "h w"]


def finish(canvas: Canvas, supersampling: int) -> Picture:
    """Average colours over the finer canvas; take parts, which have no average, at the centres."""
    center = supersampling // 2
    parts = np.asarray(canvas.image.getchannel("A"))[center::supersampling, center::supersampling]
    frame = np.asarray(canvas.image.convert("RGB").reduce(supersampling))
    return Picture(frame, parts)
