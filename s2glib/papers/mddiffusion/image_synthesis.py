"""Image synthesis: bend the source's features, hide what is occluded, and paint it anew.

Paper:    MDD B.5 (masks of 32, 64, 128, 256), B.1 (Eq. B8); form after TPSMM: authors' code
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers import DownBlock, ResidualBlock, SameBlock, UpBlock
from s2glib.papers.mddiffusion.config import DecouplingConfig
from s2glib.papers.mddiffusion.flow_predictor import Flow
from s2glib.warping import warp_features


class Synthesis(NamedTuple):
    """What was made of a source picture.

    Attributes:
        image: the driving picture.
        warped: the source picture merely bent.
        features: E_i of the source picture, not bent; coarse to fine.
    """

    image: Float[Tensor, "batch 3 h w"]
    warped: Float[Tensor, "batch 3 h w"]
    features: list[Tensor]


class ImageSynthesizer(nn.Module):
    """An encoder whose maps are warped and masked, and a decoder that joins them.

    Where an occlusion mask is 1 the warped source is kept; where it is 0 the network paints.
    """

    config_class = DecouplingConfig

    def __init__(self, config: DecouplingConfig):
        super().__init__()
        self.config = config
        widths = [config.synthesis_width * 2**k for k in range(config.synthesis_blocks + 1)]
        self.first = SameBlock(3, widths[0], kernel=7)
        self.down = nn.ModuleList(DownBlock(*widths[k : k + 2]) for k in range(len(widths) - 1))
        joined = [widths[-1], *(2 * width for width in widths[-2:0:-1])]  # bottom, then joins
        self.refine = nn.ModuleList(
            nn.Sequential(*(ResidualBlock(width) for _ in range(config.residual_blocks)))
            for width in joined
        )
        steps = zip(joined, widths[-2::-1], strict=True)
        self.up = nn.ModuleList(UpBlock(*step) for step in steps)
        self.last = nn.Conv2d(widths[0], 3, 7, padding=3)

    def encode(self, image: Float[Tensor, "batch 3 h w"]) -> list[Tensor]:
        """E_i: feature maps of a picture, coarse to fine."""
        maps = [self.first(image)]
        for block in self.down:
            maps.append(block(maps[-1]))
        return maps[::-1]

    def forward(self, source: Float[Tensor, "batch 3 h w"], flow: Flow) -> Synthesis:
        """Paint the driving picture."""
        features = self.encode(source)
        kept = warp_and_mask(features, flow)
        h = kept[0]
        for step, (refine, up) in enumerate(zip(self.refine, self.up, strict=True)):
            h = torch.cat([h, kept[step]], dim=1) if step else h
            h = up(refine(h))
        visible = flow.occlusion_masks[-1]
        painted = torch.sigmoid(self.last(h * (1 - visible) + kept[-1]))
        warped = warp_features(source, flow.sampling_grid)
        return Synthesis(painted * (1 - visible) + warped * visible, warped, features)

    @torch.no_grad()
    def masked_features(self, image: Float[Tensor, "batch 3 h w"], flow: Flow) -> list[Tensor]:
        """E_i of a driving picture, occluded places set to zero; held."""
        maps = self.encode(image)
        return [f * m for f, m in zip(maps, flow.occlusion_masks, strict=True)]


def warp_and_mask(features: list[Tensor], flow: Flow) -> list[Tensor]:
    """T^-1 of feature maps, and occluded places set to zero."""
    return [
        warp_features(f, flow.sampling_grid) * m
        for f, m in zip(features, flow.occlusion_masks, strict=True)
    ]
