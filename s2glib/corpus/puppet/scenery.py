"""Cloth and walls: the textures that stay the same from frame to frame.

Paper:    -
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import numpy as np
from jaxtyping import Bool, Float
from PIL import Image, ImageDraw, ImageFilter

from s2glib.corpus.appearance import Color, Outfit, Room
from s2glib.corpus.puppet.drawing import Part, mix

CLOTH_PIXEL = 0.004  # metres a side
CLOTH_SIZE = (260, 320)  # across and down: 1.04 m and 1.28 m
COLLAR_ROW = 40  # the neck lies this far below the upper edge
_GRAIN, _PLASTER = 7.0, 2.5  # standard deviations in grey levels


def cloth_tile(outfit: Outfit) -> Image.Image:
    """The cloth of a trunk: pattern, weave, darker towards the sides."""
    width, height = CLOTH_SIZE
    across = (np.arange(width) - width / 2 + 0.5)[None] * CLOTH_PIXEL
    down = np.arange(height)[:, None] * CLOTH_PIXEL
    accent = _pattern(outfit.pattern, across, down)[..., None]
    color = np.where(accent, np.array(outfit.accent, float), np.array(outfit.cloth, float))
    grain = np.random.default_rng(3).normal(0, _GRAIN, (height, width, 1))
    light = 1.06 - 0.42 * (np.abs(across) / 0.22).clip(0, 1.2)[..., None] ** 2.5
    rgb = ((color + grain) * light).clip(0, 255).astype(np.uint8)
    tile = Image.fromarray(rgb).convert("RGBA")
    tile.putalpha(int(Part.TRUNK))
    return tile


def _pattern(name: str, across: Float[np.ndarray, "1 w"], down: Float[np.ndarray, "h 1"]) -> (
    Bool[np.ndarray, "h w"]
):  # fmt: skip
    """Where the accent colour shows; metres across from the middle and down."""
    flat = np.zeros(np.broadcast_shapes(across.shape, down.shape), bool)
    diamond = np.abs(across % 0.12 - 0.06) * 1.5 + np.abs(down % 0.16 - 0.08)
    patterns = {
        "plain": flat,
        "stripes": flat | (down % 0.085 < 0.03),
        "pinstripes": flat | (across % 0.04 < 0.008),
        "checks": (across % 0.09 < 0.03) ^ (down % 0.09 < 0.03),
        "dots": np.hypot((across + 0.03 * (down // 0.06)) % 0.06 - 0.03, down % 0.06 - 0.03)
        < 0.014,
        "argyle": diamond < 0.055,
    }
    return patterns[name]


def backdrop(room: Room, size: int) -> Image.Image:
    """The room behind the speaker, static over a clip; every pixel is marked as background."""
    picture = Image.fromarray(_wall(room.wall, size))
    furnish = _Furniture(picture, room.wall)
    getattr(furnish, room.scene)()
    picture = picture.filter(ImageFilter.GaussianBlur(size / 400)).convert("RGBA")
    picture.putalpha(int(Part.BACKGROUND))
    return picture


def _wall(color: Color, size: int) -> np.ndarray:
    """Plaster under soft light from the upper left."""
    noise = np.random.default_rng(5).normal(0, 1, (40, 40))
    soft = np.asarray(Image.fromarray(noise.astype(np.float32)).resize((size, size), 3))
    y, x = np.mgrid[0:size, 0:size] / size
    light = 1.05 - 0.13 * y - 0.07 * x
    wall = np.array(color) * light[..., None] + _PLASTER * soft[..., None]
    return wall.clip(0, 255).astype(np.uint8)


class _Furniture:
    """What stands in a room; coordinates are shares of the picture."""

    def __init__(self, picture: Image.Image, wall: Color) -> None:
        self.size = picture.width
        self.draw = ImageDraw.Draw(picture)
        self.dark = mix(wall, (40, 40, 50), 0.35)
        self.light = mix(wall, (255, 255, 255), 0.45)
        self.wood = mix((150, 108, 74), wall, 0.35)
        self.leaf = mix((74, 120, 78), wall, 0.3)
        self.wall = wall

    def box(self, left, top, right, bottom, fill, edge=None) -> None:
        corners = [share * self.size for share in (left, top, right, bottom)]
        self.draw.rectangle(corners, fill=fill, outline=edge, width=max(1, self.size // 90))

    def shelf(self) -> None:
        """Two boards of books on the left, a clock on the right."""
        shades = [(176, 96, 84), (92, 120, 150), (206, 178, 110), (120, 140, 104), (130, 104, 140)]
        for row, top in enumerate((0.14, 0.40)):
            for place in range(6):
                tall = 0.10 + 0.025 * ((place * 3 + row) % 4)
                left = 0.025 + 0.034 * place
                book = mix(shades[(place + 2 * row) % 5], self.wall, 0.35)
                self.box(left, top + 0.18 - tall, left + 0.028, top + 0.18, book)
            self.box(0, top + 0.18, 0.25, top + 0.205, self.wood)
        disc = [share * self.size for share in (0.80, 0.10, 0.94, 0.24)]
        self.draw.ellipse(disc, fill=self.light, outline=self.dark, width=max(1, self.size // 90))
        for x, y in ((0.87, 0.125), (0.905, 0.18)):
            line = [share * self.size for share in (0.87, 0.17, x, y)]
            self.draw.line(line, fill=self.dark, width=max(1, self.size // 110))

    def pictures(self) -> None:
        """Three framed pictures."""
        for left, top, right, bottom in ((0.04, 0.08, 0.24, 0.34), (0.07, 0.42, 0.21, 0.58)):
            self.box(left, top, right, bottom, self.light, self.wood)
            self.box(left + 0.03, (top + bottom) / 2, right - 0.03, bottom - 0.03, self.leaf)
        self.box(0.78, 0.10, 0.97, 0.46, self.light, self.dark)
        self.box(0.82, 0.15, 0.93, 0.28, mix((206, 140, 90), self.wall, 0.3))
        self.box(0.82, 0.30, 0.93, 0.41, mix((90, 120, 160), self.wall, 0.3))

    def window(self) -> None:
        """A window with four panes on the right, a curtain on the left."""
        self.box(0.72, 0.05, 1.02, 0.52, mix((196, 222, 240), self.wall, 0.15), self.light)
        self.box(0.86, 0.05, 0.875, 0.52, self.light)
        self.box(0.72, 0.27, 1.02, 0.285, self.light)
        for fold in range(4):
            shade = mix(self.wall, (150, 90, 80), 0.25 + 0.08 * (fold % 2))
            self.box(0.045 * fold, 0, 0.045 * (fold + 1), 1, shade)

    def board(self) -> None:
        """A blackboard with chalk lines."""
        slate = mix((58, 84, 76), self.wall, 0.2)
        self.box(0.03, 0.07, 0.97, 0.50, slate, self.wood)
        for row, (left, right) in enumerate(
            ((0.08, 0.27), (0.08, 0.22), (0.75, 0.92), (0.78, 0.9))
        ):
            top = 0.15 + 0.09 * (row % 2)
            self.box(left, top, right, top + 0.012, mix(slate, (255, 255, 255), 0.6))
        self.box(0.03, 0.50, 0.97, 0.525, self.wood)

    def plant(self) -> None:
        """A plant on a stand, and a lamp."""
        root, bulge = np.array([0.13, 0.54]), np.array([0.02, 0.01])
        for angle in np.radians((35, 60, 85, 110, 140)):
            tip = root + np.array([0.15 * np.cos(angle), -0.02 - 0.34 * np.sin(angle)])
            middle = (root + tip) / 2
            leaf = np.array([root, middle + bulge, tip, middle - bulge]) * self.size
            self.draw.polygon(leaf.ravel().tolist(), fill=self.leaf)
        self.box(0.08, 0.54, 0.18, 0.66, mix((188, 110, 80), self.wall, 0.2))
        self.box(0.05, 0.66, 0.21, 0.69, self.wood)
        self.box(0.07, 0.69, 0.085, 1, self.wood)
        self.box(0.175, 0.69, 0.19, 1, self.wood)
        shade = np.array([(0.83, 0.2), (0.93, 0.2), (0.98, 0.36), (0.78, 0.36)]) * self.size
        self.draw.polygon(shade.ravel().tolist(), fill=mix((250, 226, 170), self.wall, 0.2))
        self.box(0.874, 0.36, 0.886, 1, self.dark)
