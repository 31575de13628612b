"""The optical-flow predictor: K warps from keypoints, mixed pixel by pixel, and what they hide.

Paper:    MDD 3.2, B.5 (K = 20 warps, 64 x 64 weight maps, four masks), E (MRAA's affine regions)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import math
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers import Hourglass, UpBlock, shrink
from s2glib.papers.mddiffusion.config import DecouplingConfig
from s2glib.warping import (
    apply_affine,
    apply_tps,
    combine_flows,
    coordinate_grid,
    fit_region_affine,
    fit_tps,
    gaussian_heatmap,
    region_heatmap,
    region_of_points,
    warp_with_each,
    weight_maps,
)

Keypoints = Float[Tensor, "batch k n 2"]


class Flow(NamedTuple):
    """Where every driving pixel comes from in the source, and whether it is to be seen there.

    Attributes:
        sampling_grid: the mixture of `warps`, x then y.
        contributions: weight maps of the background (first) and of the K warps; they sum to 1.
        warps: the background's grid and the K warps'.
        occlusion_masks: 1 = visible, keep the warped source; 0 = paint anew. Coarse to fine.
    """

    sampling_grid: Float[Tensor, "batch h w 2"]
    contributions: Float[Tensor, "batch k_plus_1 h w"]
    warps: Float[Tensor, "batch k_plus_1 h w 2"]
    occlusion_masks: list[Float[Tensor, "batch 1 _ _"]]


class FlowPredictor(nn.Module):
    """Weighs the warps at every place, having seen the source under each of them."""

    config_class = DecouplingConfig

    def __init__(self, config: DecouplingConfig):
        super().__init__()
        self.config = config
        blobs = config.transforms * (config.points if config.warp == "tps" else 1)
        inputs = 3 * (config.transforms + 1) + blobs + 1  # 164 in the paper's size
        shape = (config.flow_width, config.flow_widest, config.flow_blocks)
        self.hourglass = Hourglass(inputs, *shape)
        widths = list(self.hourglass.channels)
        self.weights = _head(widths[-1], config.transforms + 1, config.head_kernel)
        self.enlarge = nn.ModuleList()
        for _ in range(round(math.log2(config.size / config.flow_size))):
            widths.append(widths[-1] // config.mask_narrowing)
            self.enlarge.append(UpBlock(*widths[-2:]))
        seen = widths[-len(config.mask_sizes) :]
        self.masks = nn.ModuleList(_head(width, 1, config.head_kernel) for width in seen)
        for name, parameter in self.masks.named_parameters():
            if name.endswith("bias"):
                nn.init.constant_(parameter, -math.log(1 / config.visible_at_start - 1))

    def forward(
        self,
        source: Float[Tensor, "batch 3 size size"],
        source_keypoints: Keypoints,
        driving_keypoints: Keypoints,
        *,
        background: Float[Tensor, "batch 3 2"] | None = None,
        dropout: float = 0.0,
        generator: torch.Generator | None = None,
    ) -> Flow:
        """The flow from the driving picture back to the source.

        Args:
            source: the picture that is bent.
            source_keypoints: as predicted on it.
            driving_keypoints: where they shall be.
            background: affine map of the background, rows 1, x, y; None: it stands still.
            dropout: share of the warps that may not contribute (TPS dropout); the background may.
            generator: draws which these are.
        """
        size = self.config.flow_size
        grid = coordinate_grid(size, size).to(source)
        behind = grid.expand(len(source), 1, size, size, 2)
        if background is not None:
            behind = _on_grid(apply_affine(background, grid.flatten(0, 1))[:, None], size)
        moved = group_warps(driving_keypoints, source_keypoints, grid, self.config)
        warps = torch.cat([behind, moved], dim=1)
        copies = warp_with_each(shrink(source, source.shape[-1] // size), warps).flatten(1, 2)
        there = group_blobs(driving_keypoints, self.config)
        blobs = there - group_blobs(source_keypoints, self.config)
        nothing = torch.zeros_like(blobs[:, :1])
        maps = self.hourglass(torch.cat([copies, nothing, blobs], dim=1))
        near = there.unflatten(1, (self.config.transforms, -1)).amax(dim=2)
        logits = self.weights(maps[-1]) + self.config.nearness * torch.cat([nothing, near], dim=1)
        contributions = weight_maps(logits, dropout=dropout, generator=generator)
        for block in self.enlarge:
            maps.append(block(maps[-1]))
        seen = zip(self.masks, maps[-len(self.masks) :], strict=True)
        return Flow(
            sampling_grid=combine_flows(warps, contributions),
            contributions=contributions,
            warps=warps,
            occlusion_masks=[torch.sigmoid(mask(h)) for mask, h in seen],
        )


def group_warps(
    driving: Keypoints,
    source: Keypoints,
    grid: Float[Tensor, "size size 2"],
    config: DecouplingConfig,
) -> Float[Tensor, "batch k size size 2"]:
    """Each group's backward warp: a spline through its points, or the affine map of its ellipse.

    The second is MRAA's, which sums a group up by mean and covariance  [MDD E]. A ridge pulls a
    spline to the middle of the picture, the more the closer its points are; where the network
    `rests`, the spline says how far places move, and the ridge pulls it to no motion at all (ours).
    """
    places = grid.flatten(0, 1)
    if config.warp == "tps" and config.rests:
        moved = places + apply_tps(fit_tps(driving, source - driving, ridge=config.ridge), places)
    elif config.warp == "tps":
        moved = apply_tps(fit_tps(driving, source, ridge=config.ridge), places)
    else:
        regions = region_of_points(driving), region_of_points(source)
        moved = apply_affine(fit_region_affine(*regions, floor=config.region_floor), places)
    return _on_grid(moved, len(grid))


def group_blobs(keypoints: Keypoints, config: DecouplingConfig) -> Float[Tensor, "batch _ _ _"]:
    """A picture of every keypoint, or of every group's ellipse: what the network knows of them."""
    size = config.flow_size
    if config.warp == "tps":
        points = keypoints.flatten(1, 2)
        return gaussian_heatmap(points, size, size, variance=config.heatmap_variance)
    return region_heatmap(region_of_points(keypoints), size, size, floor=config.region_floor)


def _head(inputs: int, outputs: int, kernel: int) -> nn.Conv2d:
    return nn.Conv2d(inputs, outputs, kernel, padding=kernel // 2)


def _on_grid(points: Float[Tensor, "batch k m 2"], size: int) -> Tensor:
    return points.unflatten(2, (size, size))
