"""Exercise 03-4: keypoints must move with the picture.

Paper:    MDD Eq. B7
Notebook: -
"""

from collections.abc import Iterator

import numpy as np
import torch
from scipy.ndimage import map_coordinates
from torch import Tensor, nn

from s2glib.losses import equivariance_loss
from s2glib.papers.mddiffusion import equivariance
from s2glib.teaching.exercises.exercise import Exercise, Mutant
from s2glib.teaching.exercises.notebook_02.applying import move_oracle
from s2glib.warping import (
    ThinPlateSpline,
    apply_tps,
    coordinate_grid,
    random_tps,
    tps_grid,
    warp_image,
)


class Centroids(nn.Module):
    """A keypoint predictor that needs no training: the mean place of each colour."""

    def forward(self, image: Tensor) -> Tensor:
        """(batch, 3, h, w) to (batch, 1, 3, 2)."""
        shares = image.flatten(2) / image.sum((2, 3))[..., None]
        places = coordinate_grid(*image.shape[-2:], dtype=image.dtype).flatten(0, 1)
        return (shares @ places)[:, None]


PREDICTOR = Centroids()
Case = tuple[nn.Module, Tensor, Tensor, ThinPlateSpline]


def bend_inputs(rng: np.random.Generator) -> Iterator[Case]:
    """A shift to the left, a picture half as large, and any gentle bends of two pictures."""
    for affine in ([[0.25, 0], [1, 0], [0, 1]], [[0, 0], [2, 0], [0, 2]]):
        flat = torch.zeros(1, 1, 2, dtype=torch.float64)
        bend = ThinPlateSpline(flat, flat, torch.tensor([affine], dtype=torch.float64))
        image = torch.tensor(rng.uniform(size=(1, 3, 9, 9)))
        yield PREDICTOR, image, PREDICTOR(image), bend
    generator = torch.Generator().manual_seed(int(rng.integers(1000)))
    gentle = random_tps(2, sigma_affine=0.2, generator=generator, dtype=torch.float64)
    image = torch.tensor(rng.uniform(size=(2, 3, 7, 7)))
    yield PREDICTOR, image, PREDICTOR(image), gentle


def bend_oracle(
    predictor: nn.Module, image: Tensor, keypoints: Tensor, bend: ThinPlateSpline
) -> Tensor:
    """Picture by picture: SciPy looks up every pixel, the spline is summed point by point."""
    away = []
    for n, picture in enumerate(image.numpy()):
        spline = ThinPlateSpline(*(part[n] for part in bend))
        size = picture.shape[-1]
        grid = coordinate_grid(size, size, dtype=torch.float64).flatten(0, 1)
        x, y = (move_oracle(spline, grid).numpy().T + 1) / 2 * (size - 1)
        seen = [map_coordinates(colour, [y, x], order=1, mode="mirror") for colour in picture]
        found = predictor(torch.tensor(np.array(seen)).view(1, *picture.shape))
        away.append(keypoints[n].flatten(0, 1) - move_oracle(spline, found.flatten(0, 2)))
    return torch.stack(away).abs().mean()


def _found(predictor: nn.Module, image: Tensor, bend: ThinPlateSpline) -> Tensor:
    """Keypoints of the bent picture."""
    places = tps_grid(bend, *image.shape[-2:])
    return predictor(warp_image(image, places, padding="reflection")).flatten(1, 2)


def not_back(
    predictor: nn.Module, image: Tensor, keypoints: Tensor, bend: ThinPlateSpline
) -> Tensor:
    """The keypoints of the bent picture are not bent back."""
    return equivariance_loss(keypoints.flatten(1, 2), _found(predictor, image, bend))


def as_printed(
    predictor: nn.Module, image: Tensor, keypoints: Tensor, bend: ThinPlateSpline
) -> Tensor:
    """The keypoints go where the spline takes them, as if it led forth."""
    forth = apply_tps(bend, keypoints.flatten(1, 2))
    return equivariance_loss(_found(predictor, image, bend), forth)


def same_picture(
    predictor: nn.Module, image: Tensor, keypoints: Tensor, bend: ThinPlateSpline
) -> Tensor:
    """The picture is not bent."""
    back = apply_tps(bend, predictor(image).flatten(1, 2))
    return equivariance_loss(keypoints.flatten(1, 2), back)


def black_edges(
    predictor: nn.Module, image: Tensor, keypoints: Tensor, bend: ThinPlateSpline
) -> Tensor:
    """Outside the picture it is black."""
    bent = warp_image(image, tps_grid(bend, *image.shape[-2:]))
    back = apply_tps(bend, predictor(bent).flatten(1, 2))
    return equivariance_loss(keypoints.flatten(1, 2), back)


def squared(
    predictor: nn.Module, image: Tensor, keypoints: Tensor, bend: ThinPlateSpline
) -> Tensor:
    """The distances are squared."""
    back = apply_tps(bend, _found(predictor, image, bend))
    return (keypoints.flatten(1, 2) - back).square().mean()


def summed(predictor: nn.Module, image: Tensor, keypoints: Tensor, bend: ThinPlateSpline) -> Tensor:
    """A sum instead of a mean."""
    return equivariance(predictor, image, keypoints, bend) * keypoints.numel()


EQUIVARIANCE = Exercise(
    id="03-4",
    title="keypoints that move with the picture",
    reference=equivariance,
    inputs=bend_inputs,
    oracle=bend_oracle,
    minutes=12,
    difficulty=3,
    equation="MDD Eq. B7",
    helpers=(equivariance_loss,),
    mutants=(
        Mutant(
            not_back,
            "You compare keypoints of the bent picture with those of the straight one; bend them "
            "back first.",
        ),
        Mutant(
            as_printed,
            "You send the old keypoints through the spline, as B7 prints it. But this spline leads "
            "back: send the new ones through it.",
        ),
        Mutant(
            same_picture,
            "You bend keypoints, but not the picture in which they are to be found.",
        ),
        Mutant(
            black_edges,
            'What lies outside the picture is black in yours; ask for padding="reflection".',
        ),
        Mutant(squared, "B7 has absolute values; yours are squared."),
        Mutant(summed, "Yours is a sum; take the mean, so that it does not grow with K and N."),
    ),
    hints=(
        "`tps_grid(bend, height, width)` says for every pixel where to look, and "
        '`warp_image(image, grid, padding="reflection")` looks there.',
        "The predictor gives (batch, k, n, 2), `apply_tps` takes (batch, points, 2): "
        "`.flatten(1, 2)`.",
        "Keypoints of the bent picture are sent through `bend`, which leads back: "
        "`(keypoints.flatten(1, 2) - apply_tps(bend, bent.flatten(1, 2))).abs().mean()`.",
    ),
)
