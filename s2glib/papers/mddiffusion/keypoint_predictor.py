"""The keypoint predictor: a picture to K groups of N points, learned without any labels.

Paper:    MDD B.5 (ResNet-18 with 20 x 5 x 2 outputs)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import torch
from einops import rearrange
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers import ResNet, shrink
from s2glib.papers.mddiffusion.config import DecouplingConfig


class KeypointPredictor(nn.Module):
    """E_kp: where the control points of every transform are."""

    config_class = DecouplingConfig

    def __init__(self, config: DecouplingConfig):
        super().__init__()
        self.config = config
        self.encoder = ResNet(
            config.transforms * config.points * 2,
            widths=config.keypoint_widths,
            blocks=config.keypoint_blocks,
            early_pool=config.keypoint_early_pool,
            pooled=config.keypoint_grid,
        )

    def forward(self, image: Float[Tensor, "batch 3 h w"]) -> Float[Tensor, "batch k n 2"]:
        """Keypoints, x then y: a sigmoid keeps them in the picture, or within `keypoint_reach`."""
        seen = self.encoder(shrink(image, self.config.keypoint_shrinking))
        flat = torch.sigmoid(self.config.keypoint_gain * seen) * 2 - 1
        points = rearrange(flat, "b (k n d) -> b k n d", k=self.config.transforms, d=2)
        return self.config.keypoint_reach * points

    @torch.no_grad()
    def start_at(self, points: Float[Tensor, "k n 2"]) -> None:
        """Begin with keypoints about given places, whatever the picture shows (ours)."""
        inside = points.flatten() / self.config.keypoint_reach
        logits = torch.logit((inside + 1) / 2, eps=0.01)
        self.encoder.fc.bias.copy_(logits / self.config.keypoint_gain)
