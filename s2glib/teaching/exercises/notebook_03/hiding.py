"""Exercise 03-3: bend feature maps of every size, and hide what the source does not show.

Paper:    MDD B.5 (occlusion masks), Eq. B8
Notebook: -
"""

from collections.abc import Callable, Iterator

import numpy as np
import torch
from scipy.ndimage import map_coordinates
from torch import Tensor

from s2glib.papers.mddiffusion import Flow, warp_and_mask
from s2glib.teaching.exercises.exercise import Exercise, Mutant
from s2glib.warping import coordinate_grid, identity_flow, resize_flow, warp_features, warp_image


def map_inputs(rng: np.random.Generator) -> Iterator[tuple[list[Tensor], Flow]]:
    """One map that moves half a picture to the left, then maps of two sizes and any flow."""
    still = coordinate_grid(3, 3, dtype=torch.float64)
    aside = still + torch.tensor([1.0, 0.0], dtype=torch.float64)
    ramp = torch.arange(1.0, 10.0, dtype=torch.float64).view(1, 1, 3, 3)
    visible = torch.tensor([[1.0, 0.5, 0.0]], dtype=torch.float64).expand(1, 1, 3, 3)
    yield [ramp], _flow(aside[None], [visible])
    bend = identity_flow(torch.empty(5, 5, 2, dtype=torch.float64)) + torch.tensor(
        rng.normal(size=(2, 5, 5, 2)) / 3
    )
    shapes = ((2, 4, 4, 4), (2, 3, 8, 8))
    maps = [torch.tensor(rng.normal(size=shape)) for shape in shapes]
    masks = [torch.tensor(rng.uniform(size=(2, 1, *shape[2:]))) for shape in shapes]
    yield maps, _flow(bend, masks)


def _flow(grid: Tensor, masks: list[Tensor]) -> Flow:
    """A flow of which only the grid and the masks matter."""
    return Flow(grid, torch.ones_like(grid[:, None, ..., 0]), grid[:, None], masks)


def map_oracle(features: list[Tensor], flow: Flow) -> list[Tensor]:
    """SciPy looks up the grid between its points, then each channel between its pixels."""
    return [
        torch.tensor(np.stack([_look_up(f[n], flow.sampling_grid[n]) for n in range(len(f))])) * m
        for f, m in zip(features, flow.occlusion_masks, strict=True)
    ]


def _look_up(maps: Tensor, grid: Tensor) -> np.ndarray:
    """Channels at the places that a square grid of another size names."""
    height, width = maps.shape[-2:]
    rows, columns = np.linspace(0, len(grid) - 1, height), np.linspace(0, len(grid) - 1, width)
    at = np.meshgrid(rows, columns, indexing="ij")
    x, y = (map_coordinates(grid[..., k].numpy(), at, order=1) for k in (0, 1))
    places = [(y + 1) / 2 * (height - 1), (x + 1) / 2 * (width - 1)]
    return np.stack([map_coordinates(f, places, order=1, mode="grid-constant") for f in maps])


def each_level(one: Callable[[Tensor, Tensor, Tensor], Tensor]) -> Callable:
    """A way to treat all levels, from one to treat a map, the flow and a mask."""

    def levels(features: list[Tensor], flow: Flow) -> list[Tensor]:
        pairs = zip(features, flow.occlusion_masks, strict=True)
        return [one(f, flow.sampling_grid, m) for f, m in pairs]

    return levels


def inverted(f: Tensor, grid: Tensor, m: Tensor) -> Tensor:
    """The visible is hidden."""
    return warp_features(f, grid) * (1 - m)


def masked_first(f: Tensor, grid: Tensor, m: Tensor) -> Tensor:
    """The mask is laid over the source, and bent with it."""
    return warp_features(f * m, grid)


def unmasked(f: Tensor, grid: Tensor, m: Tensor) -> Tensor:
    """Nothing is hidden."""
    return warp_features(f, grid)


def not_bent(f: Tensor, grid: Tensor, m: Tensor) -> Tensor:
    """The source is masked where it is."""
    return f * m


def forward(f: Tensor, grid: Tensor, m: Tensor) -> Tensor:
    """The arrows of the flow are turned round."""
    return warp_features(f, 2 * identity_flow(grid) - grid) * m


def rescaled(f: Tensor, grid: Tensor, m: Tensor) -> Tensor:
    """The places are scaled with the size, as if they were pixels."""
    resized = resize_flow(grid, *f.shape[-2:])
    return warp_image(f, resized * (f.shape[-1] / grid.shape[-2])) * m


HIDE = Exercise(
    id="03-3",
    title="bend and hide",
    reference=warp_and_mask,
    inputs=map_inputs,
    oracle=map_oracle,
    minutes=10,
    difficulty=2,
    equation="MDD B.5",
    helpers=(warp_features,),
    mutants=(
        Mutant(
            each_level(inverted),
            "You hide what is visible: in these masks 1 means keep, 0 means paint anew.",
        ),
        Mutant(
            each_level(masked_first),
            "You mask the source and bend the result; the mask belongs to the driving picture, so "
            "bend first.",
        ),
        Mutant(each_level(unmasked), "You bend, but hide nothing: multiply by the masks."),
        Mutant(each_level(not_bent), "You hide, but do not bend: look up the maps by the flow."),
        Mutant(
            each_level(forward),
            "Your arrows are turned round: the flow says where to look already.",
        ),
        Mutant(
            each_level(rescaled),
            "You scale the flow's values with its size; they are image units, from -1 to 1 at any "
            "size.",
        ),
    ),
    hints=(
        "Go through `zip(features, flow.occlusion_masks)`: a map, and a mask of its size.",
        "The flow has another size. `resize_flow(flow.sampling_grid, height, width)` mends that, "
        "and `warp_image(maps, grid)` looks up.",
        "A map's size is `maps.shape[-2:]`. What you collect in a list is "
        "`warp_image(maps, resize_flow(flow.sampling_grid, *maps.shape[-2:])) * mask`.",
    ),
)
