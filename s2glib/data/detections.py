"""What detectors saw in a film: boxes and keypoints, in pixels, read from .npy files and checked.

Paper:    MDD B.3 (the authors' code keeps boxes of hands), C (13 + 2 x 21 keypoints)
Notebook: notebooks/22_capstone.ipynb
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from s2glib.body.keypoints2d import BODY_POINTS, HAND_POINTS

SEEN = 0.3  # mean confidence from which a part counts as seen, as in `upper_body_points`
PADDING = 0.2  # of a box's longer side; on films of the corpus the most like boxes of true masks

_HANDS = len(BODY_POINTS)
_ORDERS = {
    55: {
        "body": slice(_HANDS),
        "left_hand": slice(_HANDS, _HANDS + HAND_POINTS),
        "right_hand": slice(_HANDS + HAND_POINTS, 55),
        "face": slice(5),  # nose, eyes, ears
    },
    133: {  # COCO-WholeBody: 17 of the body, 6 of the feet, 68 of the face, 2 x 21 of the hands
        "body": slice(_HANDS),
        "left_hand": slice(91, 112),
        "right_hand": slice(112, 133),
        "face": slice(23, 91),
    },
}


class Detections(NamedTuple):
    """Keypoints of parts, x then y in pixels; NaN in frames where the part is not seen."""

    body: Float64[np.ndarray, "t 13 2"]
    left_hand: Float64[np.ndarray, "t 21 2"]
    right_hand: Float64[np.ndarray, "t 21 2"]
    face: Float64[np.ndarray, "t _ 2"]

    @property
    def boxes(self) -> dict[str, Float64[np.ndarray, "t n 4"]]:
        """Padded boxes around the keypoints of the hands, and of the face, there a square."""
        hands = [_box(self.left_hand), _box(self.right_hand)]
        return {"hands": np.stack(hands, axis=1), "face": _box(self.face, square=True)[:, None]}


def _box(points: Float64[np.ndarray, "t k 2"], *, square: bool = False) -> np.ndarray:
    low, high = points.min(axis=1), points.max(axis=1)
    reach = (high - low) / 2
    longer = reach.max(axis=-1, keepdims=True)
    reach = (longer if square else reach) + 2 * PADDING * longer
    return np.concatenate([(low + high) / 2 - reach, (low + high) / 2 + reach], axis=-1)


def read_boxes(
    path: Path, frames: int, picture: tuple[int, int]
) -> Float64[np.ndarray, "frames n 4"]:
    """Read boxes of hands or faces: x0, y0, x1, y1; four NaN where there is none.

    Args:
        path: a .npy file.
        frames: how many the film has.
        picture: its width and height.

    Raises:
        ValueError: if the file holds something else, or a box that cannot be.
    """
    boxes = _read_numbers(path, frames, "(t, n, 4)")
    if boxes.ndim != 3 or boxes.shape[2] != 4:
        raise ValueError(f"{path}: expected boxes (t, n, 4), x0, y0, x1, y1; got {boxes.shape}")
    there = boxes[~np.isnan(boxes).all(axis=-1)]
    (low, high), last = (there[:, :2], there[:, 2:]), np.array(picture) - 1
    fits = (low <= high) & (high >= 0) & (low <= last) & np.isfinite(low) & np.isfinite(high)
    if not fits.all():
        raise ValueError(
            f"{path}: expected x0 <= x1 and y0 <= y1 inside a picture of {picture[0]} x "
            f"{picture[1]} pixels, got {there[~fits.all(axis=-1)][0].tolist()}; put four NaN where "
            "none is seen"
        )
    _check_pixels(path, boxes)
    return boxes


def read_keypoints(path: Path, frames: int) -> Detections:
    """Read the keypoints that a detector found in every frame.

    Args:
        path: a .npy file (t, 55, 2) or (t, 133, 2 or 3), see `s2glib.data.films`.
        frames: how many the film has.

    Raises:
        ValueError: if the file holds something else, or NaN in a part that is seen.
    """
    numbers = _read_numbers(path, frames, "(t, 55, 2) or (t, 133, 2 or 3)")
    if numbers.shape[1:] not in ((55, 2), (133, 2), (133, 3)):
        raise ValueError(
            f"{path}: expected keypoints (t, 55, 2) as in [MDD C] or (t, 133, 2 or 3) as in "
            f"COCO-WholeBody, got {numbers.shape}; bring them into one of these orders"
        )
    points, confidence = numbers[..., :2], numbers[..., 2:]
    if not confidence.size:
        confidence = (~np.isnan(points)).all(axis=-1, keepdims=True).astype(float)
    _check_pixels(path, points)
    places = _ORDERS[points.shape[1]]
    return Detections(
        **{
            name: _where_seen(path, name, points[:, place], confidence[:, place])
            for name, place in places.items()
        }
    )


def _where_seen(
    path: Path,
    name: str,
    points: Float64[np.ndarray, "t k 2"],
    confidence: Float64[np.ndarray, "t k 1"],
) -> np.ndarray:
    seen: Bool[np.ndarray, "t 1 1"] = confidence.mean(axis=1, keepdims=True) > SEEN
    broken = seen[:, 0, 0] & ~np.isfinite(points).all(axis=(1, 2))
    if broken.any():
        raise ValueError(
            f"{path}: the {name.replace('_', ' ')} is seen in frame {broken.argmax()}, but some of "
            "its points are NaN or infinite; give all of them, or set all to NaN"
        )
    return np.where(seen, points, np.nan)


def _read_numbers(path: Path, frames: int, shape: str) -> Float64[np.ndarray, "..."]:
    try:
        with path.open("rb") as file:
            numbers = np.lib.format.read_array(file, allow_pickle=False)
    except ValueError as error:
        raise ValueError(f"{path} is no array of numbers; save it anew with numpy.save") from error
    if numbers.dtype.kind not in "fiu":
        raise ValueError(f"{path} is no array of numbers; save it anew with numpy.save")
    if numbers.ndim == 0 or len(numbers) != frames:
        raise ValueError(
            f"{path}: expected {shape} with t = {frames}, as many as there are frames, got "
            f"{numbers.shape}; detect every frame, and put NaN where nothing is seen"
        )
    return numbers.astype(np.float64)


def _check_pixels(path: Path, places: Float64[np.ndarray, "..."]) -> None:
    finite = places[np.isfinite(places)]
    if finite.size and np.abs(finite).max() <= 1:
        raise ValueError(
            f"{path}: expected places in pixels of the picture, got numbers within -1 .. 1; "
            "multiply them by its width and height"
        )
