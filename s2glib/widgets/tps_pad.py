"""The pad: control points to drag by mouse, finger or keys, and a picture that bends with them.

The page solves the spline itself, so that the picture follows at once; Python hears where the
points are and fits the same spline.

Paper:    MDD Sup. A, Eqs. A1-A5
Notebook: notebooks/02_thin_plate_splines.ipynb
"""

import io
from collections.abc import Sequence

import anywidget
import numpy as np
import torch
import traitlets
from jaxtyping import Float
from matplotlib.axes import Axes
from PIL import Image
from torch import Tensor

from s2glib.viz.warps import draw_carried_grid, draw_control_points, draw_picture
from s2glib.warping import ThinPlateSpline, fit_tps, tps_grid, warp_image
from s2glib.widgets.parts import read_parts

PARTS = ("entry.js", "tps.js", "sheet.js", "tps_pad.js")
MOST_POINTS = 30


class TPSPad(anywidget.AnyWidget):
    """Drag control points over a picture, and see the thin-plate spline through them.

    The blue rings are the points in the picture, the source; the numbered handles say where they
    are driven. Tab goes from handle to handle, the arrow keys move one.

    Python and the page never write the same trait: orders go out in `order`, what happened comes
    back in `heard`. Each order has a number, so that news from before an order is not believed.

    Args:
        points: the source points, (n, 2), x then y in [-1, 1].
        picture: (3, height, width) in [0, 1]; None is a test picture.
        ridge: of the spline, see `fit_tps`; may be set later.
        width: of the pad, in pixels of the page.

    Attributes:
        driving: where the points are now, a list of [x, y]; can be observed.

    Raises:
        ValueError: if the points hold no spline, lie outside the picture, or are more than 30; or
            if the picture is no picture.
    """

    _esm = read_parts(*PARTS)
    _css = read_parts("tps_pad.css")
    source: traitlets.List = traitlets.List().tag(sync=True)
    picture = traitlets.Bytes().tag(sync=True)
    ridge = traitlets.Float(0.0, min=0.0).tag(sync=True)
    width = traitlets.Int(480).tag(sync=True)
    order: traitlets.Dict = traitlets.Dict().tag(sync=True)
    heard: traitlets.Dict = traitlets.Dict().tag(sync=True)
    driving: traitlets.List = traitlets.List(read_only=True)

    def __init__(
        self,
        points: Sequence[Sequence[float]] | np.ndarray | Tensor,
        *,
        picture: Float[np.ndarray, "3 height width"]
        | Float[Tensor, "3 height width"]
        | None = None,
        ridge: float = 0.0,
        width: int = 480,
    ) -> None:
        source = check_points(points, ridge)
        shown = check_picture(sample_picture() if picture is None else picture)
        self._image = torch.from_numpy(shown)
        start = {"number": 0, "driving": source}
        super().__init__(
            source=source, picture=_png(shown), ridge=ridge, width=width, order=start, heard=start
        )
        self.set_trait("driving", source)

    def move(self, index: int, x: float, y: float) -> None:
        """Drive one point, counted from 0, to a place; outside the picture means on its edge."""
        places = [list(place) for place in self.driving]
        places[index] = [min(max(float(value), -1.0), 1.0) for value in (x, y)]
        self._tell(places)

    def reset(self) -> None:
        """Let all points go back to where they were."""
        self._tell(self.source)

    @property
    def spline(self) -> ThinPlateSpline:
        """The spline of the points as they are now, in float64; a ValueError if there is none."""
        pair = (torch.tensor(places, dtype=torch.float64) for places in (self.driving, self.source))
        return fit_tps(*pair, ridge=self.ridge)

    def draw(self, axes: Axes) -> Axes:
        """Draw the pad as it is now: what is seen where no kernel runs."""
        grid = tps_grid(self.spline, *self._image.shape[1:])
        draw_picture(axes, warp_image(self._image[None], grid[None])[0].numpy())
        draw_carried_grid(axes, grid.numpy())
        return draw_control_points(axes, np.array(self.driving), np.array(self.source))

    def _tell(self, driving: list[list[float]]) -> None:
        self.set_trait("driving", driving)
        self.order = {"number": self.order["number"] + 1, "driving": driving}

    @traitlets.observe("heard")
    def _listen(self, change) -> None:
        if change["new"]["number"] == self.order["number"]:
            self.set_trait("driving", change["new"]["driving"])

    def __repr__(self) -> str:
        return (
            "TPSPad: points that bend a picture. Needs a running kernel; without one, .draw(axes)"
        )


def check_points(points: Sequence | np.ndarray | Tensor, ridge: float) -> list[list[float]]:
    """Points as a list of [x, y], if a spline passes through them."""
    source = torch.from_numpy(_array(points))
    if source.ndim != 2 or source.shape[1] != 2 or not len(source) <= MOST_POINTS:
        raise ValueError(
            f"points must be (n, 2) with at most {MOST_POINTS} points, got {tuple(source.shape)}"
        )
    if not (source.abs() <= 1).all():
        raise ValueError("points must lie in the picture: x and y from -1 to 1")
    fit_tps(source, source, ridge=ridge)
    return source.tolist()


def check_picture(picture: np.ndarray | Tensor) -> np.ndarray:
    """A picture as float64, if it is one."""
    shown = _array(picture)
    if shown.ndim != 3 or len(shown) != 3 or min(shown.shape) < 2:
        raise ValueError(f"picture must be (3, height, width), got {shown.shape}")
    if not ((shown >= 0) & (shown <= 1)).all():
        raise ValueError("picture must have values from 0 to 1; divide bytes by 255")
    return shown


def sample_picture(size: int = 256) -> Float[np.ndarray, "3 size size"]:
    """A round, friendly face on chequered cloth: one sees at once what bends."""
    x, y = np.meshgrid(*2 * [np.linspace(-1, 1, size)])
    cloth = np.where((np.floor(4 * x) + np.floor(4 * y)) % 2, 0.0, 1.0)
    red, green, blue = 0.62 + 0.12 * cloth, 0.74 + 0.1 * cloth, 0.78 + 0.08 * cloth
    paint = np.stack([red, green, blue])
    smile = (np.hypot(x, y - 0.05) < 0.4) & (np.hypot(x, y - 0.05) > 0.33) & (y > 0.15)
    strokes = (
        (np.hypot(x, y) < 0.7, (0.96, 0.78, 0.6)),
        ((np.hypot(x, y) < 0.7) & (y < -0.42), (0.35, 0.22, 0.15)),
        (np.hypot(np.abs(x) - 0.25, (y + 0.12) / 1.3) < 0.09, (0.15, 0.12, 0.12)),
        (smile, (0.7, 0.2, 0.15)),
    )
    for where, colour in strokes:
        paint[:, where] = np.array(colour)[:, None]
    return paint


def _array(values: Sequence | np.ndarray | Tensor) -> np.ndarray:
    """A copy in float64."""
    return np.array(values.numpy() if isinstance(values, Tensor) else values, dtype=np.float64)


def _png(picture: np.ndarray) -> bytes:
    data = io.BytesIO()
    pixels = np.round(255 * picture).astype(np.uint8).transpose(1, 2, 0)
    Image.fromarray(pixels).save(data, "PNG")
    return data.getvalue()
