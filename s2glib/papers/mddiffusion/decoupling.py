"""Motion decoupling: from two pictures of one person to keypoints, a flow, and back to a picture.

What moves goes through K x N points; how it looks comes from the source picture alone. Nothing is
labelled: the driving picture has to be made from the source picture.

Paper:    MDD 3.2, B.1 (Eqs. B6-B9), B.5
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from typing import NamedTuple

import torch
from einops import rearrange
from jaxtyping import Float
from torch import Tensor, nn

from s2glib.layers import ResNet
from s2glib.losses import equivariance_loss, perceptual_loss, warp_loss
from s2glib.papers.mddiffusion.config import DecouplingConfig
from s2glib.papers.mddiffusion.flow_predictor import Flow, FlowPredictor
from s2glib.papers.mddiffusion.image_synthesis import (
    ImageSynthesizer,
    Synthesis,
    warp_and_mask,
)
from s2glib.papers.mddiffusion.keypoint_predictor import KeypointPredictor
from s2glib.warping import ThinPlateSpline, apply_affine, apply_tps, tps_grid, warp_image

Images = Float[Tensor, "batch 3 size size"]
Keypoints = Float[Tensor, "batch k n 2"]


class Reconstruction(NamedTuple):
    """Everything between two pictures."""

    source_keypoints: Keypoints
    driving_keypoints: Keypoints
    flow: Flow
    synthesis: Synthesis


class BackgroundPredictor(nn.Module):
    """An affine map of the background between two pictures; it starts as the identity (TPSMM)."""

    def __init__(self, config: DecouplingConfig):
        super().__init__()
        self.encoder = ResNet(
            6, inputs=6, widths=config.keypoint_widths, blocks=config.keypoint_blocks
        )
        nn.init.zeros_(self.encoder.fc.weight)
        self.encoder.fc.bias.data = torch.eye(3)[:, 1:].flatten()

    def forward(self, source: Images, driving: Images) -> Float[Tensor, "batch 3 2"]:
        """From driving to source places; rows 1, x, y."""
        both = torch.cat([source, driving], dim=1)
        return rearrange(self.encoder(both), "b (rows xy) -> b rows xy", xy=2)


class MotionDecoupler(nn.Module):
    """Keypoint predictor, optical-flow predictor and image synthesis network, end to end."""

    config_class = DecouplingConfig

    def __init__(self, config: DecouplingConfig):
        super().__init__()
        self.config = config
        self.keypoints = KeypointPredictor(config)
        self.flow = FlowPredictor(config)
        self.synthesizer = ImageSynthesizer(config)
        self.background = BackgroundPredictor(config) if config.background == "affine" else None

    def forward(
        self,
        source: Images,
        driving: Images,
        *,
        dropout: float = 0.0,
        generator: torch.Generator | None = None,
    ) -> Reconstruction:
        """Rebuild the driving picture from the source picture and the driving keypoints.

        Args:
            source: any picture of the person, in 0 .. 1.
            driving: another one; only its keypoints (and its background's motion) are used.
            dropout: share of the warps to leave out, see `FlowPredictor`.
            generator: draws which these are.
        """
        background = None if self.background is None else self.background(source, driving)
        source_keypoints, driving_keypoints = self.keypoints(source), self.keypoints(driving)
        flow = self.flow(
            source,
            source_keypoints,
            driving_keypoints,
            background=background,
            dropout=dropout,
            generator=generator,
        )
        synthesis = self.synthesizer(source, flow)
        return Reconstruction(source_keypoints, driving_keypoints, flow, synthesis)

    def animate(
        self, source: Images, source_keypoints: Keypoints, driving_keypoints: Keypoints
    ) -> tuple[Synthesis, Flow]:
        """Move a picture to keypoints from anywhere, such as the motion diffusion model."""
        flow = self.flow(source, source_keypoints, driving_keypoints)
        return self.synthesizer(source, flow), flow


class DecouplingLosses(NamedTuple):
    """The terms of Eq. B9, and three more that are off in the paper."""

    perceptual: Float[Tensor, ""]
    equivariance: Float[Tensor, ""]
    warp: Float[Tensor, ""]
    background: Float[Tensor, ""]
    warped: Float[Tensor, ""]
    labelled: Float[Tensor, ""]

    def total(
        self,
        *,
        perceptual: float = 1.0,
        equivariance: float = 1.0,
        warp: float = 1.0,
        background: float = 0.0,
        warped: float = 0.0,
        labelled: float = 0.0,
    ) -> Float[Tensor, ""]:
        """The weighted sum  [MDD Eq. B9]; authors' code weighs the first three by 10.

        Args:
            perceptual: of L_per, on the synthesised picture.
            equivariance: of L_eq.
            warp: of L_warp.
            background: that the background's map forth and back is no map at all (TPSMM: 10).
            warped: of L_per on the merely bent source, so that the flow cannot leave the work to
                the painter (ours).
            labelled: that keypoints lie where somebody put them (ours).
        """
        return (
            perceptual * self.perceptual
            + equivariance * self.equivariance
            + warp * self.warp
            + background * self.background
            + warped * self.warped
            + labelled * self.labelled
        )


def decoupling_losses(
    model: MotionDecoupler,
    source: Images,
    driving: Images,
    features: nn.Module,
    bend: ThinPlateSpline,
    *,
    dropout: float = 0.0,
    generator: torch.Generator | None = None,
    weight: Float[Tensor, "batch 1 size size"] | None = None,
    match_warped: bool = False,
    labels: Keypoints | None = None,
) -> DecouplingLosses:
    """The terms for a batch of picture pairs.

    Args:
        model: in training mode.
        source: pictures.
        driving: other pictures of the same clips.
        features: picture to feature maps: `vgg19_features` with the public weights, or
            `PyramidFeatures` where there are none.
        bend: a random geometric transformation for each pair (A~ in Eq. B7).
        dropout: of warps, see `FlowPredictor`.
        generator: draws which these are.
        weight: how much each place counts in the perceptual terms (ours).
        match_warped: whether to work out the term `warped`; it is 0 otherwise.
        labels: where the driving picture's keypoints should be, NaN where nobody knows; without
            them the term `labelled` is 0.
    """
    made = model(source, driving, dropout=dropout, generator=generator)
    wanted = features(driving)
    warped = features(made.synthesis.warped) if match_warped else wanted
    return DecouplingLosses(
        perceptual=perceptual_loss(wanted, features(made.synthesis.image), weight=weight),
        equivariance=equivariance(model.keypoints, driving, made.driving_keypoints, bend),
        warp=_warp(model.synthesizer, driving, made),
        background=_background_cycle(model.background, source, driving),
        warped=perceptual_loss(wanted, warped, weight=weight),
        labelled=label_error(made.driving_keypoints, labels),
    )


def label_error(keypoints: Keypoints, labels: Keypoints | None) -> Float[Tensor, ""]:
    """Mean absolute distance to the labels, where there are any."""
    if labels is None or not labels.isfinite().any():
        return keypoints.new_zeros(())
    return (keypoints - labels)[labels.isfinite()].abs().mean()


def equivariance(
    predictor: nn.Module, image: Images, keypoints: Keypoints, bend: ThinPlateSpline
) -> Float[Tensor, ""]:
    """Keypoints of the bent picture, bent back, should be the keypoints  [MDD Eq. B7].

    A pixel of the bent picture shows what was at `bend` of its place: the bend leads back.

    Args:
        predictor: pictures to keypoints.
        image: pictures.
        keypoints: as predicted on them.
        bend: a random geometric transformation for each picture.
    """
    places = tps_grid(bend, *image.shape[-2:])
    bent = predictor(warp_image(image, places, padding="reflection"))
    back = apply_tps(bend, bent.flatten(1, 2))
    return equivariance_loss(keypoints.flatten(1, 2), back)


def _warp(synthesizer: ImageSynthesizer, driving: Images, made: Reconstruction) -> Tensor:
    """Warped source features against driving features  [MDD Eq. B8].

    Only the flow learns from it; features and masks are held: authors' code.
    """
    held = made.flow._replace(occlusion_masks=[m.detach() for m in made.flow.occlusion_masks])
    features = [f.detach() for f in made.synthesis.features]
    return warp_loss(synthesizer.masked_features(driving, held), warp_and_mask(features, held))


def _background_cycle(
    predictor: BackgroundPredictor | None, source: Images, driving: Images
) -> Tensor:
    """How far the background's maps forth and back, one after the other, move the corners."""
    if predictor is None:
        return driving.new_zeros(())
    forth, back = predictor(source, driving), predictor(driving, source)
    corners = torch.tensor([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]).to(driving)
    returned = apply_affine(back, apply_affine(forth, corners))
    return (returned - corners).abs().mean()
