"""The loss mixer: gradient descent changes the pixels of a picture, and shows what each term wants.

Paper:    MDD B.3, Eqs. B17-B20
Notebook: notebooks/04_repairing_pixels.ipynb
"""

import base64
import io
from collections.abc import Mapping, Sequence
from typing import ClassVar

import torch
from jaxtyping import Float
from matplotlib.image import imsave
from torch import Tensor

from s2glib.layers import PyramidFeatures
from s2glib.losses import masked_l1, perceptual_loss, style_loss, total_variation
from s2glib.papers.mddiffusion import Masks
from s2glib.widgets.demo import Demo, Panel, Slider

STEPS, RATE = 24, 0.06  # of Adam; the rate falls to 0, so that the last steps are small
LEVELS = 1  # of the features: more would take too long for a slider
KNOWN, SEVERAL = "known", "one of several"
_PICTURE = """<figure style="margin:0"><figcaption>{name}</figcaption>
<img alt="" src="data:image/png;base64,{data}" style="width:192px;image-rendering:pixelated">
</figure>"""
_ROW = '<tr><th scope="row">{name}</th><td>{before:.1f}</td><td>{after:.1f}</td></tr>'
_PAGE = """<div style="display:flex;gap:12px;flex-wrap:wrap;font-size:16px">{pictures}
<table><caption>mean error (% of white)</caption>
<tr><td></td><th scope="col">before</th><th scope="col">after</th></tr>{rows}</table></div>"""

Poses = Float[Tensor, "poses 3 h w"]


class LossMixer(Demo):
    """Start from the decoupler's picture, take some steps downhill, and look where they lead.

    The terms are those of `refinement_losses`, of which the critic is left out. There is no
    network: every pixel goes its own way.

    Args:
        start: the picture to begin with, in 0 .. 1.
        truths: what it should be; first the truth, then others that it might be, for all that the
            network can know. The control `pose` says whether these count.
        masks: of the truths.

    Raises:
        TypeError: if the pictures are no tensors, or the masks no `Masks`.
        ValueError: if the sizes differ, or there is no truth.
    """

    controls: ClassVar[Mapping[str, Slider | Sequence]] = {
        "valid": Slider(0.0, 3.0, 1.0, 0.5),
        "occluded": Slider(0.0, 6.0, 3.0, 0.5),
        "hand": Slider(0.0, 10.0, 5.0, 0.5),
        "face": Slider(0.0, 10.0, 5.0, 0.5),
        "perceptual": Slider(0.0, 4.0, 1.0, 0.25),
        "style": Slider(0.0, 240.0, 20.0, 20.0),
        "total_variation": Slider(0.0, 3.0, 0.1, 0.1),
        "pose": (KNOWN, SEVERAL),
    }
    grid: ClassVar[Sequence[Mapping[str, object]]] = (
        {},
        {"pose": SEVERAL},
        {"hand": 0.0, "face": 0.0},
        {"perceptual": 0.0, "style": 0.0, "total_variation": 0.0},
        {"total_variation": 3.0},
        {"valid": 3.0, "occluded": 6.0, "hand": 10.0, "face": 10.0, "style": 240.0},
    )

    def __init__(self, start: Float[Tensor, "3 h w"], truths: Poses, masks: Masks) -> None:
        if not isinstance(masks, Masks) or not all(isinstance(x, Tensor) for x in (start, truths)):
            kinds = ", ".join(type(each).__name__ for each in (start, truths, masks))
            raise TypeError(f"expected a picture, its truths and their Masks, got {kinds}")
        shapes = {tuple(truths.shape), *((len(mask), 3, *mask.shape[2:]) for mask in masks)}
        if len(shapes) > 1 or not len(truths) or truths.shape[1:] != start.shape:
            raise ValueError(
                "a picture, its truths and their masks must have one size, got "
                f"{tuple(start.shape)}, {tuple(truths.shape)} and "
                f"{', '.join(str(tuple(mask.shape)) for mask in masks)}"
            )
        self._start, self._truths = start[None], truths
        self._regions = {
            "valid": masks.visible,
            "occluded": 1 - masks.visible,
            "hand": masks.hand,
            "face": masks.face,
        }
        self._features = PyramidFeatures(LEVELS)
        self._wanted = self._features(truths)
        super().__init__()

    def render(self, pose: str, **weights: float) -> Panel:
        """Draw the start, where descent leads, and the truth; and the error in each region."""
        result = self.repaint(pose, **weights)
        before, after = (self._errors(picture) for picture in (self._start[0], result))
        shown = {"start": self._start[0], "result": result, "truth": self._truths[0]}
        page = _PAGE.format(
            pictures="".join(
                _PICTURE.format(name=name, data=_png(picture)) for name, picture in shown.items()
            ),
            rows="".join(
                _ROW.format(name=name, before=before[name], after=after[name]) for name in after
            ),
        )
        said = (f"{name} {before[name]:.1f} to {after[name]:.1f}" for name in after)
        return Panel(page, f"Errors in % of white, before and after: {', '.join(said)}.", after)

    def repaint(self, pose: str = KNOWN, **weights: float) -> Float[Tensor, "3 h w"]:
        """The picture after some steps; a weight that is not named is 0.

        Raises:
            ValueError: if there is no such term.
        """
        if unknown := weights.keys() - self.controls.keys():
            raise ValueError(f"no term is called {', '.join(unknown)}; see LossMixer.controls")
        count = 1 if pose == KNOWN else len(self._truths)
        closeness = pixel_weights(
            {name: region[:count] for name, region in self._regions.items()}, weights
        )
        picture = self._start.clone().requires_grad_(True)
        adam = torch.optim.Adam([picture], lr=RATE)
        for step in range(STEPS):
            adam.param_groups[0]["lr"] = RATE * (1 - step / STEPS)
            adam.zero_grad()
            self._loss(picture, closeness, weights).backward()
            adam.step()
        return picture.detach()[0].clamp(0, 1)

    def _loss(self, picture: Tensor, closeness: Tensor, weights: Mapping[str, float]) -> Tensor:
        count = len(closeness)
        loss = (closeness * (picture - self._truths[:count]).abs()).sum()
        perceptual, style, variation = (
            weights.get(name, 0.0) for name in ("perceptual", "style", "total_variation")
        )
        if perceptual or style:
            wanted = [f[:count] for f in self._wanted]
            pairs = zip(self._features(picture), wanted, strict=True)
            made = [f.expand_as(w) for f, w in pairs]
            loss = loss + perceptual * perceptual_loss(wanted, made)
            loss = loss + style * style_loss(wanted, made)
        return loss + variation * total_variation(picture)

    def _errors(self, picture: Tensor) -> dict[str, float]:
        """By region, in % of white, against the truth."""
        pair = self._truths[:1], picture[None]
        return {
            name: 100 * float(masked_l1(*pair, region[:1]))
            for name, region in self._regions.items()
        }


def pixel_weights(
    regions: Mapping[str, Float[Tensor, "batch 1 h w"]], weights: Mapping[str, float]
) -> Float[Tensor, "batch 1 h w"]:
    """What a unit of error costs at every pixel, in each colour: all L1 terms of Eq. B17 in one.

    Args:
        regions: masks by name.
        weights: of each region's `masked_l1`; one that is not named is 0.
    """
    maps = [
        weights.get(name, 0.0) * mask / (3 * mask.sum(dim=(1, 2, 3), keepdim=True).clamp_min(1e-6))
        for name, mask in regions.items()
    ]
    return torch.stack(maps).sum(dim=0) / len(maps[0])


def _png(picture: Float[Tensor, "3 h w"]) -> str:
    file = io.BytesIO()
    imsave(file, picture.movedim(0, -1).numpy(), format="png")
    return base64.b64encode(file.getvalue()).decode()
