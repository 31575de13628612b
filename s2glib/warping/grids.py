"""Image coordinates: the grid of pixel places, warping an image by a grid, and keypoint heatmaps.

Image points are x then y in [-1, 1], y down, corner aligned: -1 and 1 are the centres of the
outermost pixels. Every warp is backward: a sampling grid says, for each pixel of the new image,
which point of the old one it shows.

Paper:    MDD Sup. A (backward flow), B.1; heatmaps as in the authors' code
Notebook: notebooks/02_thin_plate_splines.ipynb
"""

from typing import Literal

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn.functional import grid_sample


def coordinate_grid(
    height: int,
    width: int,
    *,
    dtype: torch.dtype | None = None,
    device: torch.device | str | None = None,
) -> Float[Tensor, "height width 2"]:
    """Where every pixel lies: x from -1 at the left to 1 at the right, y from the top down.

    It is the sampling grid that leaves an image as it is.

    Raises:
        ValueError: if there is no pixel.
    """
    if height < 1 or width < 1:
        raise ValueError(f"a grid needs at least 1 x 1 pixels, got {height} x {width}")
    x = torch.linspace(-1, 1, width, dtype=dtype, device=device)
    y = torch.linspace(-1, 1, height, dtype=dtype, device=device)
    return torch.stack(torch.meshgrid(x, y, indexing="xy"), dim=-1)


def check_points(name: str, points: Tensor) -> None:
    """Refuse what is not a tensor of image points.

    Raises:
        TypeError: if it is no tensor of a floating type.
        ValueError: if it is not (..., n, 2).
    """
    if not isinstance(points, Tensor) or not points.is_floating_point():
        kind = points.dtype if isinstance(points, Tensor) else type(points).__name__
        raise TypeError(f"{name} must be a tensor of floating points, got {kind}")
    if points.ndim < 2 or points.shape[-1] != 2:
        raise ValueError(f"{name} must be (..., n, 2), got {tuple(points.shape)}")


def warp_image(
    image: Float[Tensor, "batch channels height width"],
    sampling_grid: Float[Tensor, "batch new_height new_width 2"],
    *,
    padding: Literal["zeros", "border", "reflection"] = "zeros",
) -> Float[Tensor, "batch channels new_height new_width"]:
    """Look up, bilinearly, the point of the image that each pixel of the grid names.

    Args:
        image: pictures or feature maps.
        sampling_grid: a point of the image for every new pixel.
        padding: what lies outside the image. The authors' code has zeros around warped sources and
            reflections around randomly warped training images.

    Raises:
        TypeError: if the two are not tensors of one floating type.
        ValueError: if the shapes do not fit.
    """
    check_points("sampling_grid", sampling_grid)
    if not isinstance(image, Tensor) or image.dtype != sampling_grid.dtype:
        kind = image.dtype if isinstance(image, Tensor) else type(image).__name__
        raise TypeError(f"image must be a tensor of {sampling_grid.dtype}, as the grid; got {kind}")
    if image.ndim != 4 or sampling_grid.ndim != 4 or len(image) != len(sampling_grid):
        raise ValueError(
            "warp_image takes (batch, channels, height, width) and (batch, height, width, 2), got "
            f"{tuple(image.shape)} and {tuple(sampling_grid.shape)}; give one picture a batch axis"
        )
    return grid_sample(image, sampling_grid, padding_mode=padding, align_corners=True)


def gaussian_heatmap(
    keypoints: Float[Tensor, "*b k 2"], height: int, width: int, *, variance: float
) -> Float[Tensor, "*b k height width"]:
    """A bump of height 1 around every keypoint: exp(-|p - keypoint|^2 / (2 variance)).

    Args:
        keypoints: image points; they may lie outside the picture.
        height: of the map, in pixels.
        width: of the map, in pixels.
        variance: in image units squared; the authors' code takes 0.01.

    Raises:
        TypeError: if the keypoints are not a tensor of a floating type.
        ValueError: if they are not (..., k, 2), or `variance` is not positive.
    """
    check_points("keypoints", keypoints)
    if not variance > 0:
        raise ValueError(f"variance must be positive, got {variance}; 0.01 is usual")
    grid = coordinate_grid(height, width, dtype=keypoints.dtype, device=keypoints.device)
    dx = keypoints[..., :1] - grid[0, :, 0]  # (*b, k, width)
    dy = keypoints[..., 1:] - grid[:, 0, 1]  # (*b, k, height)
    across, down = (torch.exp(-d.square() / (2 * variance)) for d in (dx, dy))
    return down[..., :, None] * across[..., None, :]  # a round bump is a product of two
