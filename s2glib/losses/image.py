"""Image losses: compare pictures by pixels, by features and by how features go together.

Printed with |.| and sums; here every sum over pixels and channels is a mean, as in the authors'
code, with which the printed weights were used.

Paper:    MDD Sup. B.1, Eqs. B6-B8; B.3, Eqs. B17-B20
Notebook: notebooks/04_repairing_pixels.ipynb
"""

from collections.abc import Sequence

import torch
from einops import rearrange
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional as F

Maps = Sequence[Float[Tensor, "batch _ _ _"]]


def perceptual_loss(
    features: Maps,
    features_hat: Maps,
    *,
    weight: Float[Tensor, "batch 1 h w"] | None = None,
) -> Float[Tensor, ""]:
    """Mean absolute difference of each pair of feature maps, summed over the maps.

    [MDD Eqs. B6, B18]

    Args:
        features: maps of the true pictures, from any network or none.
        features_hat: maps of the reconstructed pictures.
        weight: how much each place counts, shrunk to each map; everywhere 1 where None (ours).

    Raises:
        ValueError: if the lists do not hold maps of the same shapes, or none.
    """
    _check_pairs(features, features_hat)
    total = features[0].new_zeros(())
    for f, f_hat in zip(features, features_hat, strict=True):
        difference = (f - f_hat).abs()
        if weight is not None:
            difference = difference * F.adaptive_avg_pool2d(weight, (f.shape[-2], f.shape[-1]))
        total = total + difference.mean()
    return total


def style_loss(features: Maps, features_hat: Maps) -> Float[Tensor, ""]:
    """Mean absolute difference of each pair of Gram matrices, summed over the maps.

    [MDD Eq. B19] prints F F^T; here it is divided by channels x height x width: authors' code.

    Raises:
        ValueError: if the lists do not hold maps of the same shapes, or none.
    """
    _check_pairs(features, features_hat)
    pairs = zip(features, features_hat, strict=True)
    return torch.stack([(gram(f) - gram(f_hat)).abs().mean() for f, f_hat in pairs]).sum()


def gram(features: Float[Tensor, "batch c h w"]) -> Float[Tensor, "batch c c"]:
    """F F^T / (c h w): which channels are high together, wherever that is."""
    flat = rearrange(features, "b c h w -> b c (h w)")
    return flat @ flat.mT / flat[0].numel()


def total_variation(
    image: Float[Tensor, "batch c h w"], mask: Float[Tensor, "batch 1 h w"] | None = None
) -> Float[Tensor, ""]:
    """Mean absolute difference of vertical plus of horizontal neighbours  [MDD Eq. B20].

    Args:
        image: at least 2 x 2 pixels.
        mask: a pair counts as much as both its pixels do.

    Raises:
        ValueError: if there are no neighbours.
    """
    if min(image.shape) < 1 or min(image.shape[-2:]) < 2:
        raise ValueError(f"expected pictures of at least 2 x 2 pixels, got {tuple(image.shape)}")
    total = image.new_zeros(())
    for axis in (-2, -1):
        difference = image.diff(dim=axis).abs()
        if mask is None:
            total = total + difference.mean()
        else:
            ahead, behind = mask.narrow(axis, 1, difference.shape[axis]), mask
            both = ahead * behind.narrow(axis, 0, difference.shape[axis])
            total = total + (difference * both).sum() / _area(both, image.shape[1])
    return total


def masked_l1(
    image: Float[Tensor, "batch c h w"],
    image_hat: Float[Tensor, "batch c h w"],
    mask: Float[Tensor, "batch 1 h w"],
) -> Float[Tensor, ""]:
    """Mean absolute difference inside each picture's mask, averaged over the pictures.

    [MDD Eq. B17]; divided by the mask's area: authors' code. Where a mask is empty, 0.

    Raises:
        ValueError: if there is no picture.
    """
    if not image.numel():
        raise ValueError(f"expected at least one picture, got the shape {tuple(image.shape)}")
    inside = ((image - image_hat).abs() * mask).sum(dim=(1, 2, 3))
    return (inside / _area(mask, image.shape[1], per_image=True)).mean()


def _area(mask: Tensor, channels: int, *, per_image: bool = False) -> Tensor:
    area = mask.sum(dim=(1, 2, 3)) if per_image else mask.sum()
    return (area * channels).clamp_min(torch.finfo(mask.dtype).eps)


def equivariance_loss(
    keypoints: Float[Tensor, "*b 2"], keypoints_back: Float[Tensor, "*b 2"]
) -> Float[Tensor, ""]:
    """Mean distance, in x and y, of keypoints from those found in a bent picture and bent back.

    [MDD Eq. B7] bends the keypoints forth; bending back is the same demand and needs no inverse of
    the bend: authors' code.

    Raises:
        ValueError: if the shapes differ or there is no keypoint.
    """
    _check_pairs([keypoints], [keypoints_back])
    return (keypoints - keypoints_back).abs().mean()


def warp_loss(features: Maps, warped: Maps) -> Float[Tensor, ""]:
    """Driving features against warped source features  [MDD Eq. B8].

    Mean absolute difference of each pair of maps, summed over the maps. Detach what shall not be
    trained by it.

    Raises:
        ValueError: if the lists do not hold maps of the same shapes, or none.
    """
    return perceptual_loss(features, warped)


def _check_pairs(these: Sequence[Tensor], those: Sequence[Tensor]) -> None:
    shapes, shapes_hat = ([tuple(x.shape) for x in xs] for xs in (these, those))
    if shapes != shapes_hat or not shapes or not all(x.numel() for x in these):
        raise ValueError(
            f"expected two equally long lists of tensors of the same shapes, none empty; got "
            f"{shapes} and {shapes_hat}"
        )
