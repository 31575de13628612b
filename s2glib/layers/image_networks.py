"""Networks that look at whole pictures: ResNet, VGG, and a pyramid that was never trained.

ResNet and VGG name their parameters as torchvision's public files do.

Paper:    MDD B.5 (ResNet-18), B.1 (VGG-19), B.3 (VGG-16); the pyramid: ours
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import os
import pickle
from collections.abc import Sequence
from typing import Literal

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional as F

from s2glib.layers.image_blocks import shrink

IMAGENET_MEAN, IMAGENET_STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)
VGG_BLOCKS = {16: (2, 2, 3, 3, 3), 19: (2, 2, 4, 4, 4)}  # convolutions before each pooling


class BasicBlock(nn.Module):
    """Two convolutions with batch norm, added to the input or to its 1 x 1 projection."""

    def __init__(self, inputs: int, outputs: int, stride: int):
        super().__init__()
        self.conv1 = nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False)
        self.bn1 = nn.BatchNorm2d(outputs)
        self.conv2 = nn.Conv2d(outputs, outputs, 3, 1, 1, bias=False)
        self.bn2 = nn.BatchNorm2d(outputs)
        self.downsample = None
        if stride > 1 or inputs != outputs:
            projection = nn.Conv2d(inputs, outputs, 1, stride, bias=False)
            self.downsample = nn.Sequential(projection, nn.BatchNorm2d(outputs))

    def forward(self, x: Float[Tensor, "batch inputs h w"]) -> Tensor:
        """Refine a feature map."""
        shortcut = x if self.downsample is None else self.downsample(x)
        h = F.relu(self.bn1(self.conv1(x)))
        return F.relu(self.bn2(self.conv2(h)) + shortcut)


class ResNet(nn.Module):
    """A picture to a vector; with the defaults and 1000 outputs, torchvision's ResNet-18.

    Args:
        outputs: numbers per picture.
        inputs: channels per pixel.
        widths: channels of the four stages.
        blocks: `BasicBlock`s of the four stages.
        early_pool: halve once more before the first stage.
        pooled: the last feature map is averaged to pooled x pooled places, not 1 x 1.
    """

    def __init__(
        self,
        outputs: int,
        *,
        inputs: int = 3,
        widths: tuple[int, int, int, int] = (64, 128, 256, 512),
        blocks: tuple[int, int, int, int] = (2, 2, 2, 2),
        early_pool: bool = True,
        pooled: int = 1,
    ):
        super().__init__()
        self.conv1 = nn.Conv2d(inputs, widths[0], 7, 2, 3, bias=False)
        self.bn1 = nn.BatchNorm2d(widths[0])
        self.maxpool = nn.MaxPool2d(3, 2, 1) if early_pool else nn.Identity()
        self.layer1 = _stage(widths[0], widths[0], 1, blocks[0])
        self.layer2 = _stage(widths[0], widths[1], 2, blocks[1])
        self.layer3 = _stage(widths[1], widths[2], 2, blocks[2])
        self.layer4 = _stage(widths[2], widths[3], 2, blocks[3])
        self.avgpool = nn.AdaptiveAvgPool2d(pooled)
        self.fc = nn.Linear(widths[3] * pooled**2, outputs)

    def forward(self, image: Float[Tensor, "batch inputs h w"]) -> Float[Tensor, "batch outputs"]:
        """Describe pictures."""
        h = self.maxpool(F.relu(self.bn1(self.conv1(image))))
        h = self.layer4(self.layer3(self.layer2(self.layer1(h))))
        return self.fc(self.avgpool(h).flatten(1))


def _stage(inputs: int, outputs: int, stride: int, blocks: int) -> nn.Sequential:
    rest = (BasicBlock(outputs, outputs, 1) for _ in range(blocks - 1))
    return nn.Sequential(BasicBlock(inputs, outputs, stride), *rest)


class VGGFeatures(nn.Module):
    """Feature maps of a frozen VGG, of the picture and of smaller copies of it.

    Args:
        depth: 16 or 19.
        taps: a map is taken after each of these entries of `features`.
        factors: how many times smaller each copy is.
        standardize: subtract ImageNet's mean and divide by its deviation first.
    """

    mean: Tensor
    std: Tensor

    def __init__(
        self,
        depth: Literal[16, 19],
        taps: Sequence[int],
        *,
        factors: Sequence[int] = (1,),
        standardize: bool,
    ):
        super().__init__()
        self.taps, self.factors = tuple(taps), tuple(factors)
        self.features = nn.Sequential(*_vgg_layers(VGG_BLOCKS[depth])[: max(taps) + 1])
        mean, std = (IMAGENET_MEAN, IMAGENET_STD) if standardize else ((0.0,) * 3, (1.0,) * 3)
        self.register_buffer("mean", torch.tensor(mean).view(3, 1, 1), persistent=False)
        self.register_buffer("std", torch.tensor(std).view(3, 1, 1), persistent=False)
        self.requires_grad_(False).eval()

    def forward(self, image: Float[Tensor, "batch 3 h w"]) -> list[Tensor]:
        """Maps in the order of `factors`, then of `taps`."""
        return [tapped for factor in self.factors for tapped in self._taps(shrink(image, factor))]

    def _taps(self, image: Tensor) -> list[Tensor]:
        h, maps = (image - self.mean) / self.std, []
        for number, layer in enumerate(self.features):
            h = layer(h)
            if number in self.taps:
                maps.append(h)
        return maps


def vgg19_features() -> VGGFeatures:
    """What the motion decoupler is trained to match: relu1_1 .. relu5_1 at four sizes.

    [MDD Eq. B6]; layers, sizes and ImageNet's mean: authors' code.
    """
    return VGGFeatures(19, (1, 6, 11, 20, 29), factors=(1, 2, 4, 8), standardize=True)


def vgg16_features() -> VGGFeatures:
    """What the refinement is trained to match: i = 5, 10, 17  [MDD Eqs. B18-B19].

    Counted from one, these are the first three poolings; no mean is subtracted: authors' code.
    """
    return VGGFeatures(16, (4, 9, 16), standardize=False)


def _vgg_layers(blocks: Sequence[int]) -> list[nn.Module]:
    layers: list[nn.Module] = []
    inputs = 3
    for width, convolutions in zip((64, 128, 256, 512, 512), blocks, strict=True):
        for _ in range(convolutions):
            layers += [nn.Conv2d(inputs, width, 3, padding=1), nn.ReLU()]
            inputs = width
        layers.append(nn.MaxPool2d(2))
    return layers


class PyramidFeatures(nn.Module):
    """What to compare where there is no VGG: colours and edges, at several sizes.

    Random networks are no substitute for trained ones; this does not pretend to be one. The small
    copies pull a misplaced hand from far away, the edges keep it sharp.

    Args:
        levels: the picture, and smaller copies, each half as large as the one before.
        edge: how much edges count beside colours.
    """

    def __init__(self, levels: int = 4, *, edge: float = 1.0):
        super().__init__()
        self.levels, self.edge = levels, edge

    def forward(self, image: Float[Tensor, "batch channels h w"]) -> list[Tensor]:
        """For each level: colours, and their differences to the right and below."""
        maps: list[Tensor] = []
        for level in range(self.levels):
            image = shrink(image, 2) if level else image
            right = F.pad(image, (0, 1, 0, 0), mode="replicate").diff(dim=-1)
            below = F.pad(image, (0, 0, 0, 1), mode="replicate").diff(dim=-2)
            maps += [image, self.edge * torch.cat([right, below], dim=1)]
        return maps


def load_public(model: nn.Module, path: str | os.PathLike[str]) -> None:
    """Fill a model from a public weights file, such as `vgg19-dcbb9e9d.pth`; nothing is fetched.

    Entries that the model lacks (classifiers, deeper layers) are passed over.

    Raises:
        ValueError: if the file cannot be read, or lacks a tensor of the model in its shape.
    """
    try:
        stored = torch.load(path, map_location="cpu", weights_only=True)
    except (OSError, RuntimeError, pickle.UnpicklingError, EOFError) as error:
        raise ValueError(f"{path} cannot be read as weights ({error}); copy it again") from error
    wanted = {name: tensor.shape for name, tensor in model.state_dict().items()}
    for name, shape in wanted.items():
        found = stored.get(name) if isinstance(stored, dict) else None
        if not isinstance(found, Tensor) or found.shape != shape:
            raise ValueError(
                f"{path} has no {name} of shape {tuple(shape)}, which {type(model).__name__} "
                "needs; give the file of this network"
            )
    model.load_state_dict({name: stored[name] for name in wanted})
