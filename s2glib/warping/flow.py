"""Flows: many backward warps combined by weight maps, composed, resized, and checked.

A flow is a sampling grid (height, width, 2): for every pixel of the driving image, the point of
the source image that it shows. The first of several is the identity, which keeps the background.

Paper:    MDD Sup. B.1, B.5 (weight maps, optical flow)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn.functional import interpolate

from s2glib.warping.grids import coordinate_grid, warp_image


def with_identity(
    flows: Float[Tensor, "*b k height width 2"],
) -> Float[Tensor, "*b k+1 height width 2"]:
    """Put the flow that moves nothing before the others."""
    identity = torch.zeros_like(flows[..., :1, :, :, :]) + identity_flow(flows)
    return torch.cat([identity, flows], dim=-4)


def weight_maps(
    logits: Float[Tensor, "*b k height width"],
    *,
    dropout: float | int = 0.0,
    generator: torch.Generator | None = None,
) -> Float[Tensor, "*b k height width"]:
    """How much each of k flows counts at every pixel: a softmax over them.

    Args:
        logits: the network's scores.
        dropout: probability that a flow is left out for a whole image, so that others learn its
            part. The first, the identity, never is.
        generator: draws what is left out; needed for `dropout` only.

    Raises:
        ValueError: if `dropout` is not in [0, 1).
    """
    if not 0 <= dropout < 1:
        raise ValueError(f"dropout must be at least 0 and below 1, got {dropout}")
    if dropout:
        place = logits.device if generator is None else generator.device
        draws = torch.rand(logits.shape[:-2], generator=generator, device=place)
        left_out = (draws < dropout).to(logits.device)
        left_out[..., 0] = False
        logits = logits.masked_fill(left_out[..., None, None], -torch.inf)
    return logits.softmax(dim=-3)


def combine_flows(
    flows: Float[Tensor, "*#b k height width 2"], weights: Float[Tensor, "*#b k height width"]
) -> Float[Tensor, "*b height width 2"]:
    """The weighted mean of k flows at every pixel: where the source is looked up."""
    return (weights[..., None] * flows).sum(-4)


def warp_with_each(
    image: Float[Tensor, "batch channels height width"],
    flows: Float[Tensor, "batch k new_height new_width 2"],
) -> Float[Tensor, "batch k channels new_height new_width"]:
    """One image as each of its k flows shows it."""
    k = flows.shape[1]
    below_each_other = warp_image(image, flows.flatten(1, 2))  # (batch, channels, k height, width)
    return below_each_other.unflatten(-2, (k, -1)).movedim(2, 1)


def resize_flow(
    flow: Float[Tensor, "batch height width 2"], new_height: int, new_width: int
) -> Float[Tensor, "batch new_height new_width 2"]:
    """The same flow on more or fewer pixels; its values, image points, need no scaling."""
    size = (new_height, new_width)
    channels = interpolate(flow.movedim(-1, 1), size, mode="bilinear", align_corners=True)
    return channels.movedim(1, -1)


def warp_features(
    features: Float[Tensor, "batch channels height width"],
    flow: Float[Tensor, "batch flow_height flow_width 2"],
) -> Float[Tensor, "batch channels height width"]:
    """Warp feature maps of any size by a flow of another size."""
    return warp_image(features, resize_flow(flow, *features.shape[-2:]))


def compose_flows(
    outer: Float[Tensor, "batch height width 2"],
    inner: Float[Tensor, "batch new_height new_width 2"],
) -> Float[Tensor, "batch new_height new_width 2"]:
    """The flow p -> outer(inner(p)): that of warping an image by `outer`, then by `inner`.

    Between pixels and outside the image `outer` moves a point as far as the nearest ones it knows.
    """
    moved_by = (outer - identity_flow(outer)).movedim(-1, 1)
    return inner + warp_image(moved_by, inner, padding="border").movedim(1, -1)


def cycle_error(
    forward: Float[Tensor, "batch height width 2"], backward: Float[Tensor, "batch height width 2"]
) -> Float[Tensor, "batch height width"]:
    """How far from its start each pixel lands after both flows; 0 if one undoes the other."""
    return (compose_flows(forward, backward) - identity_flow(backward)).norm(dim=-1)


def identity_flow(like: Float[Tensor, "*b height width 2"]) -> Float[Tensor, "height width 2"]:
    """The flow that moves nothing, of the size and type of another one."""
    height, width = like.shape[-3:-1]
    return coordinate_grid(height, width, dtype=like.dtype, device=like.device)
