"""Linear paths beside the PQ-VAE's networks, which start from principal components.

Deep networks take a thousand steps to leave the mean pose. With these paths the first step already
sees a motion go through, and the networks learn what is not linear.

Paper:    - (PT A.1 has the networks alone)
Notebook: notebooks/05_product_codes.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.papers.probtalk.config import PQVAEConfig


class StraightEncoder(nn.Module):
    """Frames to components, windows of these to components, and those into the latent."""

    def __init__(self, config: PQVAEConfig):
        super().__init__()
        n, window = config.straight, config.window
        self.mean = nn.Parameter(torch.zeros(config.size, 1))
        self.frame = nn.Conv1d(config.size, n, 1, bias=False)
        self.window = nn.Conv1d(n, n, window, stride=window, bias=False)
        self.latent = nn.Conv1d(n, config.latent, 1, bias=False)

    def forward(self, motion: Float[Tensor, "b size frames"]) -> Float[Tensor, "b latent tokens"]:
        """The latent's straight part."""
        return self.latent(self.window(self.frame(motion - self.mean)))


class StraightDecoder(nn.Module):
    """The way back: components of windows, of frames, and frames."""

    def __init__(self, config: PQVAEConfig):
        super().__init__()
        n, window = config.straight, config.window
        self.latent = nn.Conv1d(config.latent, n, 1, bias=False)
        self.window = nn.ConvTranspose1d(n, n, window, stride=window, bias=False)
        self.frame = nn.Conv1d(n, config.size, 1, bias=False)
        self.mean = nn.Parameter(torch.zeros(config.size, 1))

    def forward(self, latent: Float[Tensor, "b latent tokens"]) -> Float[Tensor, "b size frames"]:
        """The motion's straight part."""
        return self.frame(self.window(self.latent(latent))) + self.mean


@torch.no_grad()
def start_from_components(
    encoder: StraightEncoder,
    decoder: StraightDecoder,
    motion: Float[Tensor, "n frames size"],
    *,
    groups: int,
) -> None:
    """Make the two paths project on principal components; each group gets its share of them.

    Latents are scaled to a mean square of one where they are not zero.

    Args:
        encoder: the path to the latent.
        decoder: the path back.
        motion: many windows.
        groups: of the quantiser.
    """
    n, _, window = encoder.window.weight.shape
    frames = motion.flatten(0, 1)
    mean = frames.mean(0)
    F = _components(frames - mean, n)  # (size, n)
    windows = (motion - mean).matmul(F).unflatten(1, (-1, window)).flatten(0, 1).mT  # (., n, w)
    W = _components(windows.flatten(1), n)  # (n * w, n)
    scale = (windows.flatten(1) @ W).square().mean().sqrt()
    P = _dealt(n, len(encoder.latent.weight), groups)  # (latent, n)
    W = W.T.unflatten(1, (n, window))  # (n, n, w)
    encoder.frame.weight.copy_(F.T[..., None])
    encoder.mean.copy_(mean[:, None])
    encoder.window.weight.copy_(W)
    encoder.latent.weight.copy_(P[..., None] / scale)
    decoder.latent.weight.copy_(P.T[..., None] * scale)
    decoder.window.weight.copy_(W)
    decoder.frame.weight.copy_(F[..., None])
    decoder.mean.copy_(mean[:, None])


def _components(x: Float[Tensor, "n size"], count: int) -> Float[Tensor, "size count"]:
    """The strongest directions of centred rows."""
    return torch.linalg.eigh(x.mT @ x).eigenvectors.flip(-1)[:, :count]


def _dealt(count: int, latent: int, groups: int) -> Float[Tensor, "latent count"]:
    """Each component to a place of its own, dealt to the groups to and fro: 0 1 2 3 3 2 1 0."""
    turns = [*range(groups), *reversed(range(groups))]
    P = torch.zeros(latent, count)
    for number in range(count):
        group = turns[number % len(turns)]
        P[group * latent // groups + number // groups, number] = 1
    return P
