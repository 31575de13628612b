"""Films of one's own: pictures, and where in them hands and face are.

A folder holds films. Each is a sub-folder, or merely a film file:

    films/
      anna-01/
        frames/0001.png ...   pictures (.png, .jpg), all of one size, in the order of their names;
                              instead: one file frames.mp4 (extra `video`), .gif or .webp
        hands/0001.png ...    one for each frame: where a hand is, pixels are not black;
                              instead: hands.npy, boxes (t, n, 4): x0, y0, x1, y1
        face/ or face.npy     the same for the face
        keypoints.npy         a detector's: (t, 55, 2) in the order of [MDD C], or (t, 133, 2) or
                              (t, 133, 3) in that of COCO-WholeBody, confidence last
      bert-02.mp4

Only frames must be there. Numbers are pixels of the picture as it lies in its file, x to the right
and y down, 0 in the middle of the first; NaN is for what is not seen. Where hands or face are not
given but keypoints are, boxes around them take their place.

Paper:    MDD B.3 (masks of hands and face), C (keypoints)
Notebook: notebooks/22_capstone.ipynb
"""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32, UInt8
from PIL import Image

from s2glib.body.keypoints2d import upper_body_points
from s2glib.data.detections import Detections, read_boxes, read_keypoints
from s2glib.data.film_files import frames_of, read_pictures

SHORTEST = 10  # frames
SMALLEST = 8  # pixels


class Footage(NamedTuple):
    """A film as the video stages see it; what was not given is None.

    Attributes:
        frames: red, green, blue.
        hands: where a hand is.
        face: where the face is.
        keypoints: see `upper_body_points`; x then y, -1 and 1 in the middle of the outermost
            pixels.
    """

    frames: UInt8[np.ndarray, "t size size 3"]
    hands: Bool[np.ndarray, "t size size"] | None
    face: Bool[np.ndarray, "t size size"] | None
    keypoints: Float32[np.ndarray, "t 55 2"] | None


class View(NamedTuple):
    """The middle square of pictures of width x height pixels, shown with size x size pixels."""

    width: int
    height: int
    size: int

    @property
    def side(self) -> int:
        """Pixels of the square before it is shrunk."""
        return min(self.width, self.height)

    @property
    def corner(self) -> tuple[int, int]:
        """Its first column and row."""
        return (self.width - self.side) // 2, (self.height - self.side) // 2

    def shrink(self, picture: Image.Image) -> UInt8[np.ndarray, "size size 3"]:
        """The picture; every pixel is the mean of those that it covers."""
        left, top = self.corner
        square = (left, top, left + self.side, top + self.side)
        shape = (self.size, self.size)
        return np.asarray(picture.resize(shape, Image.Resampling.BOX, square))

    def pick(self, picture: Image.Image) -> Bool[np.ndarray, "size size"]:
        """The mask: what is not black at the nearest pixels."""
        columns, rows = self._nearest()
        return np.asarray(picture)[rows[:, None], columns].any(axis=-1)

    def fill(self, boxes: Float[np.ndarray, "t n 4"]) -> Bool[np.ndarray, "t size size"]:
        """The mask of boxes: `pick` from pictures of them."""
        columns, rows = self._nearest()
        x0, y0, x1, y1 = np.moveaxis(boxes, -1, 0)[..., None]
        across = (x0 <= columns) & (columns <= x1)
        down = (y0 <= rows) & (rows <= y1)
        return (down[..., :, None] & across[..., None, :]).any(axis=1)

    def place(self, points: Float[np.ndarray, "*b 2"]) -> Float[np.ndarray, "*b 2"]:
        """Where points of the picture are, -1 .. 1 between the middles of the outermost pixels."""
        shrunk = (points - self.corner + 0.5) * self.size / self.side - 0.5
        return 2 * shrunk / (self.size - 1) - 1

    def _nearest(self) -> tuple[np.ndarray, np.ndarray]:
        """Columns and rows of the picture in the middle of those shown."""
        middles = ((np.arange(self.size) + 0.5) * self.side / self.size).astype(int)
        left, top = self.corner
        return left + middles, top + middles


def read_film(path: str | os.PathLike[str], size: int) -> Footage:
    """Read a film, cut to the square in its middle.

    At what rate it was shot does not matter to the video stages.

    Args:
        path: a sub-folder or a film file, laid out as above.
        size: height and width of the result; the pictures must not be smaller.

    Raises:
        FileNotFoundError: if there is no such film.
        ImportError: for a video without the extra `video`.
        ValueError: if it is not laid out as above, does not move, or `size` is too small.
    """
    if not isinstance(size, int) or size < SMALLEST:
        raise ValueError(f"size must be a whole number of pixels, {SMALLEST} or more, got {size!r}")
    film = Path(path)
    source, pictures = frames_of(film), []
    for picture in _alike(read_pictures(source), source):
        view = View(*picture.size, size)
        if view.side < size:
            raise ValueError(
                f"{source}: expected pictures of {size} x {size} pixels or more, got "
                f"{view.width} x {view.height}; give larger ones or train at a smaller size"
            )
        pictures.append(view.shrink(picture))
    if len(pictures) < SHORTEST:
        raise ValueError(
            f"{source}: expected {SHORTEST} pictures or more, got {len(pictures)}; give a longer "
            "film"
        )
    frames = np.stack(pictures)
    if (frames == frames[0]).all():
        raise ValueError(f"{source}: nothing moves in this film; leave it out")
    detected = film / "keypoints.npy"
    found = read_keypoints(detected, len(frames)) if detected.exists() else None
    boxes = {} if found is None else found.boxes
    hands, face = (
        _mask(film / part, view, len(frames), boxes.get(part)) for part in ("hands", "face")
    )
    return Footage(frames, hands, face, None if found is None else _keypoints(found, view))


def _alike(
    pictures: Iterator[Image.Image], path: Path, size: tuple[int, int] | None = None
) -> Iterator[Image.Image]:
    """The pictures, all of a size: the given one, or the first's."""
    for number, picture in enumerate(pictures):
        size = size or picture.size
        if picture.size != size:
            raise ValueError(
                f"{path}: expected pictures of {size[0]} x {size[1]} pixels, as the first frame "
                f"has, got {picture.width} x {picture.height} at number {number}; make them alike"
            )
        yield picture


def _mask(
    pictures: Path, view: View, frames: int, boxes: Float[np.ndarray, "t n 4"] | None
) -> Bool[np.ndarray, "t size size"] | None:
    """From pictures, else from the file of boxes, else from the boxes at hand."""
    file, picture = pictures.with_suffix(".npy"), (view.width, view.height)
    if pictures.exists() and file.exists():
        raise ValueError(f"{pictures} and {file.name} say the same thing twice; remove one of them")
    if file.exists():
        boxes = read_boxes(file, frames, picture)
    if not pictures.exists():
        return None if boxes is None else view.fill(boxes)
    masks = [
        view.pick(mask) for mask in _alike(read_pictures(pictures, [".png"]), pictures, picture)
    ]
    if len(masks) != frames:
        raise ValueError(
            f"{pictures}: expected {frames} masks (.png), one for each frame, got {len(masks)}; "
            "put in a black one where nothing is seen"
        )
    return np.stack(masks)


def _keypoints(found: Detections, view: View) -> Float32[np.ndarray, "t 55 2"]:
    points = np.concatenate([found.body, found.left_hand, found.right_hand], axis=1)
    seen = np.isfinite(points).all(axis=-1).astype(float)
    places = torch.from_numpy(view.place(points))
    middle = (0.0, 0.0)
    return upper_body_points(places, torch.from_numpy(seen), center=middle).float().numpy()
