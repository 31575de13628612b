"""A face for generated gestures: jaw and lips from the sound, the rest from the emotion.

AMUSE generates no face. A linear map from five frames of the filterbank to the mouth, and the
mean face of each emotion, keep the body from speaking with a still one.

Paper:    AM (expression is zero there), ours
Notebook: notebooks/00_start_here.ipynb
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

BLOCK = 2048  # frames whose mouth is found together: 41 s
MOUTH = ("jaw", "lip_round", "lip_wide", "lip_press")


@dataclass(frozen=True)
class FaceConfig:
    """Sizes of the map (ours)."""

    n_mels: int = 64
    context: int = 2  # frames seen before and after
    curves: int = 12
    emotions: int = 8
    widest_jaw: float = 0.30  # radians


class SpeechFace(nn.Module):
    """Ridge regression for the mouth; class means for the emotion's face."""

    config_class = FaceConfig
    mouth_weights: Tensor
    emotion_faces: Tensor

    def __init__(self, config: FaceConfig):
        super().__init__()
        self.config = config
        inputs = (2 * config.context + 1) * config.n_mels + 1
        self.register_buffer("mouth_weights", torch.zeros(inputs, len(MOUTH)))
        self.register_buffer("emotion_faces", torch.zeros(config.emotions, config.curves))

    def _windows(self, filterbank: Float[Tensor, "*b frames mels"]) -> Tensor:
        """Each frame with its neighbours, (*b, frames, mels, context); the ends are held."""
        c = self.config.context
        padded = torch.cat(
            [filterbank[..., :1, :].expand(*filterbank.shape[:-2], c, -1), filterbank]
            + [filterbank[..., -1:, :].expand(*filterbank.shape[:-2], c, -1)],
            dim=-2,
        )
        return padded.unfold(-2, 2 * c + 1, 1)

    def fit_mouth(
        self,
        filterbank: Float[Tensor, "n frames mels"],
        mouth: Float[Tensor, "n frames 4"],
        *,
        ridge: float = 1.0,
    ) -> None:
        """Least squares from sound to jaw opening and lips, each in [0, 1]."""
        X = _inputs(self._windows(filterbank)).flatten(0, 1).double()
        Y = mouth.flatten(0, 1).double()
        gram = X.T @ X + ridge * torch.eye(X.shape[1], dtype=X.dtype)
        self.mouth_weights.copy_(torch.linalg.solve(gram, X.T @ Y))

    def mouth(self, filterbank: Float[Tensor, "*b frames mels"]) -> Float[Tensor, "*b frames 4"]:
        """Jaw opening and lips in [0, 1], at the filterbank's rate."""
        blocks = self._windows(filterbank).split(BLOCK, dim=-3)
        return torch.cat([_inputs(block) @ self.mouth_weights for block in blocks], -2).clamp(0, 1)

    def forward(
        self,
        filterbank: Float[Tensor, "frames mels"],
        emotion: Float[Tensor, " emotions"],
    ) -> tuple[Float[Tensor, " frames"], Float[Tensor, "frames curves"]]:
        """Jaw angle in radians and face curves, for a window and the emotion's probabilities.

        The last three curves are the lips' (`lip_round`, `lip_wide`, `lip_press`).
        """
        mouth = self.mouth(filterbank)
        curves = (emotion @ self.emotion_faces).expand(len(mouth), -1).clone()
        curves[:, -3:] += 0.8 * mouth[:, 1:]
        return 0.02 + self.config.widest_jaw * mouth[:, 0], curves.clamp(0, 1)


def _inputs(windows: Tensor) -> Tensor:
    """What the linear map takes: the numbers of each window, and a one."""
    return F.pad(windows.flatten(-2), (0, 1), value=1.0)
