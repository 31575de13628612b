"""PQ-VAE: eight frames of holistic motion as four codes of four small codebooks, and back.

Paper:    PT A.1
Notebook: notebooks/05_product_codes.ipynb
"""

import hashlib
from itertools import pairwise
from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.papers.probtalk.config import PQVAEConfig
from s2glib.papers.probtalk.motion_features import HolisticFeatures
from s2glib.papers.probtalk.straight_path import (
    StraightDecoder,
    StraightEncoder,
    start_from_components,
)
from s2glib.quantization import MovingAverage, ProductQuantizer, Quantized, ResidualQuantizer

_SLOPE = 0.2  # of the leaky ReLUs; authors' code
_TINY = 1e-6  # square metres: below a millimetre, distances are smooth
_STILL = 1e-8  # the same of what moves from frame to frame
_BETA = 0.01  # where SmoothL1 turns from square to straight; authors' code


class ResidualStack(nn.Module):
    """Three convolutions over time, each normalised, added to their input  [PT A.1].

    A leaky ReLU stands between them and a plain one at the end (authors' code).
    """

    def __init__(self, width: int, convolutions: int):
        super().__init__()
        layers: list[nn.Module] = []
        for _ in range(convolutions):
            conv = nn.Conv1d(width, width, 3, stride=1, padding=1)
            layers += [conv, nn.BatchNorm1d(width), nn.LeakyReLU(_SLOPE)]
        self.layers = nn.Sequential(*layers[:-1])

    def forward(self, x: Float[Tensor, "batch width time"]) -> Float[Tensor, "batch width time"]:
        """Refine."""
        return F.relu(x + self.layers(x))


class Resample(nn.Module):
    """Half or double the time steps by a convolution of kernel 4, stride 2, padding 1  [PT A.1].

    A second, bare one runs beside it (authors' code).
    """

    def __init__(self, convolution: type[nn.Conv1d] | type[nn.ConvTranspose1d], n: int, out: int):
        super().__init__()
        self.main = nn.Sequential(convolution(n, out, 4, stride=2, padding=1), nn.BatchNorm1d(out))
        self.beside = convolution(n, out, 4, stride=2, padding=1)

    def forward(self, x: Float[Tensor, "batch width time"]) -> Float[Tensor, "batch out time2"]:
        """To the other rate."""
        return F.leaky_relu(self.main(x) + self.beside(x), _SLOPE)


def motion_encoder(config: PQVAEConfig) -> nn.Sequential:
    """(batch, size, frames) to (batch, latent, frames / 8)."""
    first, *_, last = widths = config.widths
    layers: list[nn.Module] = [
        nn.Conv1d(config.size, first, 3, padding=1),
        nn.BatchNorm1d(first),
        nn.LeakyReLU(_SLOPE),
        ResidualStack(first, config.convolutions),
    ]
    for n, out in pairwise(widths):
        layers += [Resample(nn.Conv1d, n, out), ResidualStack(out, config.convolutions)]
    return nn.Sequential(*layers, nn.Conv1d(last, config.latent, 1))  # "fully connected" [PT A.1]


def motion_decoder(config: PQVAEConfig) -> nn.Sequential:
    """(batch, latent, frames / 8) to (batch, size, frames): the encoder mirrored  [PT A.1]."""
    first, *_, last = config.widths
    widths = config.widths[::-1]
    layers: list[nn.Module] = [
        nn.Conv1d(config.latent, last, 1),
        ResidualStack(last, config.convolutions),
    ]
    for n, out in pairwise(widths):
        layers += [Resample(nn.ConvTranspose1d, n, out), ResidualStack(out, config.convolutions)]
    return nn.Sequential(*layers, nn.Conv1d(first, config.size, 1))


def token_quantizer(config: PQVAEConfig) -> ProductQuantizer | ResidualQuantizer:
    """What the config names, its codes following their latents; a plain codebook is one group."""
    ema = MovingAverage(config.decay, revive_below=config.revive_below)
    kind = ResidualQuantizer if config.quantizer == "residual" else ProductQuantizer
    return kind(config.groups, config.codes, config.latent, ema=ema)


class PQReconstruction(NamedTuple):
    """Motion that went through the codes, and what happened there."""

    motion: Float[Tensor, "batch frames size"]
    quantized: Quantized


class PQVAE(nn.Module):
    """`encode` motion to codes, `decode` codes to motion; `features` turn poses into motion.

    Motion is standardised features; its frames are a multiple of `config.window`.
    """

    config_class = PQVAEConfig

    def __init__(self, config: PQVAEConfig):
        super().__init__()
        self.config = config
        self.features = HolisticFeatures(config.expression, config.statistics)
        self.encoder = motion_encoder(config)
        self.quantizer = token_quantizer(config)
        self.decoder = motion_decoder(config)
        self.straight_encoder = StraightEncoder(config) if config.straight else None
        self.straight_decoder = StraightDecoder(config) if config.straight else None

    def latents(
        self, motion: Float[Tensor, "batch frames size"]
    ) -> Float[Tensor, "batch tokens latent"]:
        """What is quantised: one vector per eight frames.

        Raises:
            ValueError: if the frames are no multiple of `config.window`.
        """
        frames, window = motion.shape[-2], self.config.window
        if frames == 0 or frames % window:
            raise ValueError(
                f"a code stands for {window} frames, and {frames} are no multiple of that; cut the "
                "motion, or hold its last frame"
            )
        latents = self.encoder(motion.mT)
        if self.straight_encoder is not None:
            latents = latents + self.straight_encoder(motion.mT)
        return latents.mT

    def from_latents(
        self, latents: Float[Tensor, "batch tokens latent"]
    ) -> Float[Tensor, "batch frames size"]:
        """Motion from quantised vectors."""
        motion = self.decoder(latents.mT)
        if self.straight_decoder is not None:
            motion = motion + self.straight_decoder(latents.mT)
        return motion.mT

    @torch.no_grad()
    def start_straight(self, motion: Float[Tensor, "n frames size"]) -> None:
        """Begin as a projection on principal components, the networks adding nothing yet (ours).

        Without straight paths nothing happens.
        """
        if self.straight_encoder is None or self.straight_decoder is None:
            return
        groups = self.config.groups
        start_from_components(self.straight_encoder, self.straight_decoder, motion, groups=groups)
        for network in (self.encoder, self.decoder):
            for parameter in network[-1].parameters():
                nn.init.zeros_(parameter)

    def encode(
        self, motion: Float[Tensor, "batch frames size"]
    ) -> Int[Tensor, "batch tokens groups"]:
        """The nearest codes, of each token one a group.

        Raises:
            ValueError: if the frames are no multiple of `config.window`.
        """
        return self.quantizer.encode(self.latents(motion))

    def fingerprint(self) -> str:
        """Tells its codebooks from others: what is said of codes holds for one training only."""
        kept = self.quantizer.codebooks.detach().cpu().half()
        return hashlib.sha256(kept.numpy().tobytes()).hexdigest()[:16]

    def decode(
        self, codes: Int[Tensor, "batch tokens groups"]
    ) -> Float[Tensor, "batch frames size"]:
        """The motion that codes stand for."""
        return self.from_latents(self.quantizer.decode(codes))

    def forward(self, motion: Float[Tensor, "batch frames size"]) -> PQReconstruction:
        """Through the codes and back; gradients pass the quantiser straight.

        Raises:
            ValueError: if the frames are no multiple of `config.window`.
        """
        quantized = self.quantizer(self.latents(motion))
        return PQReconstruction(self.from_latents(quantized.vectors), quantized)


class PQVAELosses(NamedTuple):
    """Part by part SmoothL1; how the velocity differs; how far latents are from their codes.

    And, which the authors do not ask for, by how many metres the wrists are off in the chest's
    frame, and by how many metres a frame head, arms and hands move differently.
    """

    jaw: Tensor
    body: Tensor
    hands: Tensor
    expression: Tensor
    velocity: Tensor
    commitment: Tensor
    wrists: Tensor
    movement: Tensor

    def total(
        self, *, commitment: float = 0.25, wrists: float = 0.0, movement: float = 0.0
    ) -> Float[Tensor, ""]:
        """Weighted sum; weights by the authors' code."""
        face, rest = self.jaw + self.expression, self.body + self.hands
        authors = 0.1 * face + 0.4 * rest + self.velocity + commitment * self.commitment
        return authors + wrists * self.wrists + movement * self.movement


def pqvae_losses(model: PQVAE, motion: Float[Tensor, "batch frames size"]) -> PQVAELosses:
    """Compare what comes back with what went in; the velocity leaves the expression out.

    The codebooks have no loss of their own: they follow their latents by moving averages.
    """
    made, quantized = model(motion)
    spans = model.features.parts
    off = F.smooth_l1_loss(made, motion, reduction="none", beta=_BETA)
    parts = {name: off[..., spans[name]].mean() for name in ("jaw", "body", "hands", "expression")}
    moving = (made - motion)[..., : spans["expression"].start]
    velocity = moving.diff(dim=-2).abs().mean()
    off_wrists = model.features.wrists(made) - model.features.wrists(motion)
    off_points = model.features.points(made) - model.features.points(motion)
    return PQVAELosses(
        **parts,
        velocity=velocity,
        commitment=quantized.commitment_loss,
        wrists=_length(off_wrists, _TINY),
        movement=_length(off_points.diff(dim=1), _STILL),
    )


def _length(vectors: Float[Tensor, "*b 3"], tiny: float) -> Float[Tensor, ""]:
    """Mean length, with a slope at zero."""
    return (vectors.square().sum(-1) + tiny).sqrt().mean()
