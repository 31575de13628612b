"""Refinement: a U-Net repairs what was occluded, the hands and the face; a critic looks at patches.

Paper:    MDD B.3, Eqs. B17-B21; weights: B.5
Notebook: notebooks/04_repairing_pixels.ipynb
"""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers import ResidualBlock
from s2glib.losses import (
    generator_loss,
    masked_l1,
    perceptual_loss,
    style_loss,
    total_variation,
)
from s2glib.papers.mddiffusion.config import RefinementConfig

Images = Float[Tensor, "batch 3 size size"]
Mask = Float[Tensor, "batch 1 size size"]


def _down(inputs: int, outputs: int, *, norm: bool) -> nn.Sequential:
    """Convolution, LeakyReLU, batch norm: half the size  [MDD B.3]."""
    layers = [nn.Conv2d(inputs, outputs, 4, 2, 1), nn.LeakyReLU(0.2)]
    return nn.Sequential(*layers, nn.BatchNorm2d(outputs) if norm else nn.Identity())


def _up(inputs: int, outputs: int) -> nn.Sequential:
    """Upsampling, convolution, LeakyReLU, batch norm: twice the size  [MDD B.3].

    The authors' code has ReLU and a transposed convolution instead.
    """
    return nn.Sequential(
        nn.Upsample(scale_factor=2),
        nn.Conv2d(inputs, outputs, 3, padding=1),
        nn.LeakyReLU(0.2),
        nn.BatchNorm2d(outputs),
    )


class RefinementNet(nn.Module):
    """A U-Net that sees all of the picture, with residual blocks at its end that see details.

    As many steps down as `widths`, as many up, long skips between them.
    """

    config_class = RefinementConfig

    def __init__(self, config: RefinementConfig):
        super().__init__()
        self.config = config
        widths, deepest = config.widths, len(config.widths) - 1
        inputs = (4, *widths[:-1])
        self.down = nn.ModuleList(  # the first and the last without norm: authors' code
            _down(inputs[k], widths[k], norm=0 < k < deepest) for k in range(len(widths))
        )
        joined = (widths[-1], *(2 * width for width in widths[-2::-1]))
        outputs = (*widths[-2::-1], widths[0])
        self.up = nn.ModuleList(_up(*pair) for pair in zip(joined, outputs, strict=True))
        self.small, self.large = (  # authors' code pads by reflection
            nn.Sequential(
                *(ResidualBlock(width, nn.BatchNorm2d) for _ in range(config.residual_blocks))
            )
            for width in outputs[-2:]
        )
        self.last = nn.Conv2d(widths[0], 3, 7, padding=3)
        if config.adds:  # nothing, at first
            for parameter in self.last.parameters():
                nn.init.zeros_(parameter)

    def forward(self, prediction: Images, visible: Mask) -> Images:
        """Repair pictures.

        Args:
            prediction: pictures from the motion decoupler, in 0 .. 1.
            visible: its finest occlusion mask; 1 where the warped source was kept.
        """
        h, kept = torch.cat([prediction, 1 - visible], dim=1), []
        for block in self.down:
            h = block(h)
            kept.append(h)
        kept.pop()
        for block in self.up[:-2]:
            h = torch.cat([block(h), kept.pop()], dim=1)
        h = torch.cat([self.small(self.up[-2](h)), kept.pop()], dim=1)
        h = self.large(self.up[-1](h))
        made = torch.tanh(self.last(h))  # authors' code
        return prediction + made if self.config.adds else made


class PatchDiscriminator(nn.Module):
    """Scores of overlapping patches: 1 for real, 0 for made. Spectral norms keep it tame."""

    config_class = RefinementConfig

    def __init__(self, config: RefinementConfig):
        super().__init__()
        self.config = config
        widths = (3, *config.patch_widths)
        layers: list[nn.Module] = []
        for k, width in enumerate(config.patch_widths):
            stride = 1 if k == len(config.patch_widths) - 1 else 2
            convolution = nn.Conv2d(widths[k], width, 5, stride, 1, bias=False)
            layers += [nn.utils.parametrizations.spectral_norm(convolution), nn.LeakyReLU(0.2)]
        score = nn.Conv2d(widths[-1], 1, 5, 1, 1, bias=False)
        self.layers = nn.Sequential(*layers, nn.utils.parametrizations.spectral_norm(score))

    def forward(self, image: Images) -> Float[Tensor, "batch 1 rows columns"]:
        """A map of scores: 27 x 27 for 256 x 256 pixels."""
        return self.layers(image)


class Masks(NamedTuple):
    """Where to look closely.

    Attributes:
        visible: 1 where the decoupler kept the warped source (the flow's finest occlusion mask).
        hand: 1 where a hand is, in the driving picture.
        face: 1 where the face is, in the driving picture.
    """

    visible: Mask
    hand: Mask
    face: Mask


class RefinementLosses(NamedTuple):
    """The terms of Eqs. B17 and B21."""

    valid: Float[Tensor, ""]
    occluded: Float[Tensor, ""]
    hand: Float[Tensor, ""]
    face: Float[Tensor, ""]
    perceptual: Float[Tensor, ""]
    style: Float[Tensor, ""]
    total_variation: Float[Tensor, ""]
    adversarial: Float[Tensor, ""]

    def reconstruction(
        self, *, occluded: float = 3.0, hand: float = 5.0, face: float = 5.0
    ) -> Float[Tensor, ""]:
        """L_rec  [MDD Eq. B17; weights B.5]. The authors' code has no face term."""
        return self.valid + occluded * self.occluded + hand * self.hand + face * self.face

    def total(
        self,
        *,
        perceptual: float = 0.05,
        style: float = 120.0,
        total_variation: float = 0.1,
        adversarial: float = 0.1,
    ) -> Float[Tensor, ""]:
        """L_ref  [MDD Eq. B21; weights B.5]."""
        return (
            self.reconstruction()
            + perceptual * self.perceptual
            + style * self.style
            + total_variation * self.total_variation
            + adversarial * self.adversarial
        )


def refinement_losses(
    refined: Images,
    driving: Images,
    masks: Masks,
    features: nn.Module,
    scores: Float[Tensor, "batch 1 _ _"],
) -> RefinementLosses:
    """The refinement network's terms for a batch of pictures.

    Args:
        refined: its output.
        driving: the true pictures.
        masks: see `Masks`. B.3 takes the complement of "the occlusion masks" for L_valid, which
            holds for masks that are 1 where occluded; these are 1 where visible.
        features: picture to feature maps: `vgg16_features` with the public weights, or
            `PyramidFeatures` where there are none.
        scores: the discriminator's, of `refined`.
    """
    wanted, made = features(driving), features(refined)
    return RefinementLosses(
        valid=masked_l1(driving, refined, masks.visible),
        occluded=masked_l1(driving, refined, 1 - masks.visible),
        hand=masked_l1(driving, refined, masks.hand),
        face=masked_l1(driving, refined, masks.face),
        perceptual=perceptual_loss(wanted, made),
        style=style_loss(wanted, made),
        total_variation=total_variation(refined),
        adversarial=generator_loss(scores),
    )


def merge(prediction: Images, refined: Images, visible: Mask) -> Images:
    """The prediction where the source was visible, the repair elsewhere.

    What the authors' code shows, and what its perceptual, style and adversarial terms see; by the
    text, the refined picture itself is the result.
    """
    return prediction * visible + refined * (1 - visible)
