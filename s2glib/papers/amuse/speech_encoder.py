"""The speech encoder of the paper: a DeiT over overlapping patches of a filterbank.

Paper:    AM B.2, Fig. A.3
Notebook: notebooks/08_speech_patches.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers import TransformerLayer
from s2glib.papers.amuse.config import SpeechConfig

PATCH, STRIDE = 16, 10  # 16 x 16 patches that overlap by 6  [AM Fig. A.3]


def patch_grid(n_mels: int, frames: int) -> tuple[int, int]:
    """Patches in frequency and in time.

    1024 x 128 gives 12 x 101 = 1212; Fig. A.3 prints 1209.

    Raises:
        ValueError: if the filterbank is smaller than one patch.
    """
    if min(n_mels, frames) < PATCH:
        raise ValueError(f"a patch is {PATCH} x {PATCH}; a {frames} x {n_mels} filterbank has none")
    return (n_mels - PATCH) // STRIDE + 1, (frames - PATCH) // STRIDE + 1


class PatchEncoder(nn.Module):
    """E_c, E_s or E_e: patches, [CLS] and [DIST], a DeiT, and a projection to the latent.

    Args:
        config: sizes.
        latent_dim: numbers in the latent.
    """

    def __init__(self, config: SpeechConfig, latent_dim: int):
        super().__init__()
        rows, columns = patch_grid(config.n_mels, config.frames)
        width = config.width
        self.patches = nn.Conv2d(1, width, PATCH, STRIDE)
        self.cls = nn.Parameter(torch.zeros(1, 1, width))
        self.distillation = nn.Parameter(torch.zeros(1, 1, width))
        self.positions = nn.Parameter(0.02 * torch.randn(1, rows * columns + 2, width))
        self.layers = nn.ModuleList(
            TransformerLayer(width, config.heads, 4 * width, eps=1e-6) for _ in range(config.layers)
        )
        self.norm = nn.LayerNorm(width, eps=1e-6)
        self.project = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, latent_dim))

    def forward(
        self, filterbank: Float[Tensor, "batch frames mels"]
    ) -> Float[Tensor, "batch latent"]:
        """Encode; the latent is read off the mean patch token."""
        image = filterbank.mT[:, None]  # (batch, 1, mels, frames)
        patches = self.patches(image).flatten(2).mT  # (batch, 1212, 768)
        first = torch.cat([self.cls, self.distillation], dim=1).expand(len(patches), -1, -1)
        tokens = torch.cat([first, patches], dim=1) + self.positions
        for layer in self.layers:
            tokens = layer(tokens)
        return self.project(self.norm(tokens)[:, 2:].mean(dim=1))
