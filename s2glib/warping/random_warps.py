"""Random deformations: what a keypoint predictor must follow to be believed (equivariance).

Warp an image by `tps_grid(warp, ...)`, padded by reflection, and predict its keypoints. A
keypoint of the warped image shows the original at `apply_tps(warp, keypoint)`: there the original's
keypoint should be.

Paper:    MDD Sup. B.1, Eq. B7; sizes as in the authors' code
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.warping.grids import coordinate_grid
from s2glib.warping.tps import ThinPlateSpline, apply_tps


def random_affine(
    batch: int,
    *,
    sigma: float | int = 0.05,
    generator: torch.Generator | None = None,
    dtype: torch.dtype | None = None,
    device: torch.device | str | None = None,
) -> Float[Tensor, "batch 3 2"]:
    """Draw affine maps near the identity: each of the six numbers is off by `sigma`.

    The default of sigma is the authors'. Wherever the result lives, the draws are the generator's.
    """
    noise = _normal(batch, 3, 2, generator=generator).to(device=device, dtype=dtype)
    return sigma * noise + noise.new_tensor([[0, 0], [1, 0], [0, 1]])


def random_tps(
    batch: int,
    *,
    sigma_affine: float | int = 0.05,
    sigma_weights: float | int = 0.005,
    points: int = 5,
    generator: torch.Generator | None = None,
    dtype: torch.dtype | None = None,
    device: torch.device | str | None = None,
) -> ThinPlateSpline:
    """Draw smooth warps near the identity, with the authors' sizes as defaults.

    As in their code the weights themselves are drawn, one for x and y together, on a square grid
    of points x points centers. So the side conditions do not hold, every bend goes along the
    diagonal, and far outside the image the warp runs away; inside it is harmless.
    """
    affine = random_affine(
        batch, sigma=sigma_affine, generator=generator, dtype=dtype, device=device
    )
    weights = sigma_weights * _normal(batch, points**2, 1, generator=generator).to(affine)
    grid = coordinate_grid(points, points, dtype=affine.dtype, device=affine.device)
    both = (batch, points**2, 2)
    return ThinPlateSpline(grid.flatten(0, 1).expand(both), weights.expand(both), affine)


def undo_tps(
    spline: ThinPlateSpline, points: Float[Tensor, "*#b m 2"], *, steps: int = 50
) -> Float[Tensor, "*b m 2"]:
    """Find the points that a gentle warp takes to these: where they are in the warped image.

    Starts at the answer of the identity and repeats p <- p + (wanted - T(p)), which closes in as
    long as the warp stretches or turns by less than its whole; every random warp here does.
    """
    found = points
    for _ in range(steps):
        found = found + points - apply_tps(spline, found)
    return found


def _normal(*shape: int, generator: torch.Generator | None) -> Tensor:
    place = "cpu" if generator is None else generator.device
    return torch.randn(shape, generator=generator, device=place)
