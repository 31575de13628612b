"""The mask mixer: turn the decoupler's warps up and down, and see the picture that they make.

The page mixes the warps itself, so that the picture follows at once; Python hears where the
sliders stand and mixes the same.

Paper:    MDD 3.2, B.5
Notebook: notebooks/03_motion_decoupling.ipynb
"""

import anywidget
import numpy as np
import torch
import traitlets
from jaxtyping import Float
from matplotlib.axes import Axes
from torch import Tensor
from torch.nn.functional import interpolate

from s2glib.papers.mddiffusion import Reconstruction
from s2glib.warping import combine_flows, warp_features, weight_maps
from s2glib.widgets.packing import pack
from s2glib.widgets.parts import read_parts

PARTS = ("entry.js", "pose.js", "mixing.js", "mask_mixer.js")  # of pose.js: `unpack`
LIMIT = 8.0  # gains go from -8, which means off, to 8; mixing.js has both numbers too
OFF = -100.0  # what being off adds to a logit: no share is left, unless all are off
FAINTEST = 1e-30  # share that a warp has at least, so that it has a logarithm
TINT = np.array([0.835, 0.369, 0.0])[:, None, None]  # Okabe and Ito's vermilion

Pictures = Float[Tensor, "1 3 size size"]


class MaskMixer(anywidget.AnyWidget):
    """Mix the background and the K warps of a flow by hand, and try to beat the network.

    A warp's gain is added to its logit: 0 leaves it as the network chose, -8 turns it off. Only
    differences count: to turn all warps off is the same as to leave all as they are.

    Python and the page never write the same trait: orders go out in `order`, what happened comes
    back in `heard`. Each order has a number, so that news from before an order is not believed.

    Args:
        source: the source picture, as the decoupler saw it: a batch of one, in 0 .. 1.
        driving: the driving picture, likewise.
        reconstruction: what `MotionDecoupler` made of the two.
        width: of the mixer, in pixels of the page.

    Attributes:
        gains: of the background, then of warps 1 to K; can be observed, as can the others.
        alone: the one warp that counts (0 is the background); None: all do.
        painted: whether the occlusion mask hides the bent source, and the network's paint fills in.
        error: mean absolute difference between `picture` and the driving picture.

    Raises:
        TypeError: if something else than two float32 tensors and a reconstruction comes.
        ValueError: if it is not a batch of one pair, or was not made of this source picture.
    """

    _esm = read_parts(*PARTS)
    _css = read_parts("mask_mixer.css")
    scene = traitlets.Bytes().tag(sync=True)
    width = traitlets.Int(740).tag(sync=True)
    order: traitlets.Dict = traitlets.Dict().tag(sync=True)
    heard: traitlets.Dict = traitlets.Dict().tag(sync=True)
    gains: traitlets.List = traitlets.List(read_only=True)
    alone: traitlets.Int = traitlets.Int(None, allow_none=True, read_only=True)
    painted = traitlets.Bool(False, read_only=True)
    error = traitlets.Float(read_only=True)

    def __init__(
        self,
        source: Pictures,
        driving: Pictures,
        reconstruction: Reconstruction,
        *,
        width: int = 740,
    ) -> None:
        check_pictures(source, driving)
        check_reconstruction(source, reconstruction)
        flow, made = reconstruction.flow, reconstruction.synthesis
        self._source, self._driving = source.detach(), driving.detach()
        self._warped, self._image = made.warped.detach(), made.image.detach()
        self._warps, self._visible = flow.warps.detach(), flow.occlusion_masks[-1].detach()
        self._paint = self._image - self._visible * self._warped  # what the network put on top
        self._shares = flow.contributions[0].detach().clamp_min(FAINTEST)
        start = {"gains": [0.0] * len(self._shares), "alone": None, "painted": False}
        numbered = {"number": 0, **start}
        super().__init__(scene=self._pack(), width=width, order=numbered, heard=numbered)
        self._adopt(start)

    def set(self, index: int, gain: float | int) -> None:
        """Give the background (0) or a warp (1 to K) a gain; -8 and below is off, 8 the most."""
        if not gain == gain:
            raise ValueError("a gain must be a number, got NaN; 0 is as the network chose")
        gains = list(self.gains)
        gains[self._known(index)] = min(max(float(gain), -LIMIT), LIMIT)
        self._tell(gains=gains)

    def solo(self, index: int | None) -> None:
        """Let one warp count alone, whatever its gain; None: all of them again."""
        self._tell(alone=None if index is None else self._known(index))

    def paint(self, on: bool) -> None:
        """Whether to mask the bent source and fill in the network's paint, or only to bend."""
        self._tell(painted=on)

    def reset(self) -> None:
        """Let every gain be 0 and all warps count; whether there is paint stays as it is."""
        self._tell(gains=[0.0] * len(self.gains), alone=None)

    @property
    def contributions(self) -> Float[Tensor, "k_plus_1 h w"]:
        """The weight maps as they are now."""
        if self.alone is None:
            gains = [gain if gain > -LIMIT else OFF for gain in self.gains]
        else:
            gains = [0.0 if k == self.alone else OFF for k in range(len(self.gains))]
        return weight_maps(self._shares.log() + torch.tensor(gains)[:, None, None])

    @property
    def picture(self) -> Float[Tensor, "3 size size"]:
        """What the mixture makes of the source; the paint is always the one the network made."""
        bent = warp_features(self._source, combine_flows(self._warps, self.contributions))
        return (self._visible * bent + self._paint if self.painted else bent)[0]

    @property
    def network_error(self) -> float:
        """The error of the network's own mixture, which is to be beaten; with paint or without."""
        return self._difference(self._image if self.painted else self._warped)

    @property
    def copying_error(self) -> float:
        """The error of leaving the source picture as it is."""
        return self._difference(self._source)

    def draw(self, axes: Axes) -> Axes:
        """Draw the mixer as it is now, all in one axes: what is seen where no kernel runs."""
        count = len(self.gains)
        side = count / 3
        mix = f"mix (error {self.error:.3f})"
        above = {"source": self._source, "driving (truth)": self._driving, mix: self.picture[None]}
        for k, (name, picture) in enumerate(above.items()):
            _place(axes, picture[0].numpy(), k * side, 0.0, side, name)
        for k, thumbnail in enumerate(self._thumbnails()):
            _place(axes, thumbnail, k + 0.0, side + 0.5, 1.0, f"warp {k}" if k else "background")
        axes.set(xlim=(0, count), ylim=(side + 1.5, -0.35), aspect="equal")
        axes.set_axis_off()
        return axes

    def _thumbnails(self) -> list[np.ndarray]:
        """The source bent by each warp alone, in grey, tinted where the warp has a say."""
        grey = self._source.mean(1, keepdim=True)
        bent = [warp_features(grey, warp[None])[0].numpy() for warp in self._warps[0]]
        size = grey.shape[-2:]
        shares = interpolate(self.contributions[:, None], size, mode="bilinear", align_corners=True)
        tints = 0.75 * shares.numpy()
        return [
            (1 - tint) * picture + tint * TINT for tint, picture in zip(tints, bent, strict=True)
        ]

    def _difference(self, picture: Tensor) -> float:
        return float((picture - self._driving).abs().mean())

    def _known(self, index: int) -> int:
        if index not in range(len(self.gains)):
            raise ValueError(
                f"no warp is called {index!r}: 0 is the background, 1 to {len(self.gains) - 1} "
                "are the warps"
            )
        return index

    def _tell(self, **change: object) -> None:
        mix = {"gains": self.gains, "alone": self.alone, "painted": self.painted, **change}
        self._adopt(mix)
        self.order = {"number": self.order["number"] + 1, **mix}

    @traitlets.observe("heard")
    def _listen(self, change) -> None:
        if change["new"]["number"] == self.order["number"]:
            self._adopt(change["new"])

    def _adopt(self, mix: dict) -> None:
        for name in ("gains", "alone", "painted"):
            self.set_trait(name, mix[name])
        self.set_trait("error", self._difference(self.picture))

    def _pack(self) -> bytes:
        pictures = {"source": self._source, "driving": self._driving, "paint": self._paint}
        pictures["visible"] = self._visible
        arrays = {name: _in_steps(picture[0]) for name, picture in pictures.items()}
        arrays["warps"] = self._warps[0].movedim(-1, 1).numpy()
        return pack({**arrays, "shares": self._shares.numpy()}, {})

    def __repr__(self) -> str:
        return (
            "MaskMixer: warps that are mixed by hand. Needs a running kernel; without one, "
            ".draw(axes)"
        )


def check_pictures(source: Pictures, driving: Pictures) -> None:
    """Refuse what is not one pair of pictures."""
    for name, picture in (("source", source), ("driving", driving)):
        if not isinstance(picture, Tensor) or picture.dtype != torch.float32:
            kind = picture.dtype if isinstance(picture, Tensor) else type(picture).__name__
            raise TypeError(f"{name} must be a float32 tensor, as the decoupler takes; got {kind}")
        if picture.ndim != 4 or picture.shape[:2] != (1, 3) or picture.shape[2] != picture.shape[3]:
            raise ValueError(
                f"{name} must be a batch of one square picture, (1, 3, size, size); "
                f"got {tuple(picture.shape)}"
            )
        if not ((picture >= 0) & (picture <= 1)).all():
            raise ValueError(f"{name} must have values from 0 to 1; divide bytes by 255")
    if source.shape != driving.shape:
        raise ValueError(
            "source and driving must have one size, got "
            f"{source.shape[-1]} and {driving.shape[-1]} pixels"
        )


def check_reconstruction(source: Pictures, reconstruction: Reconstruction) -> None:
    """Refuse what the decoupler did not make of this very source picture."""
    if not isinstance(reconstruction, Reconstruction):
        raise TypeError(
            "reconstruction must be what MotionDecoupler returns, got "
            f"{type(reconstruction).__name__}"
        )
    grid, warped = reconstruction.flow.sampling_grid, reconstruction.synthesis.warped
    if warped.shape != source.shape:
        raise ValueError(
            f"the reconstruction's pictures are {tuple(warped.shape)}, the source is "
            f"{tuple(source.shape)}; give the decoupler this one pair"
        )
    if not torch.allclose(warp_features(source, grid), warped, atol=1e-3):
        raise ValueError("the reconstruction was made of another source picture than this one")


def _in_steps(picture: Float[Tensor, "channels size size"]) -> np.ndarray:
    """Values in 0 .. 1 as whole numbers up to 65535, which the page divides again."""
    return (65535 * picture.clamp(0, 1)).round().numpy().astype(np.uint16)


def _place(axes: Axes, picture: np.ndarray, left: float, top: float, side: float, name: str):
    """One picture of several in the same axes, its name above it."""
    extent = (left + 0.04, left + side - 0.04, top + side - 0.04, top + 0.04)
    axes.imshow(picture.transpose(1, 2, 0).clip(0, 1), extent=extent)
    axes.text(left + side / 2, top, name, ha="center", va="bottom", fontsize=9 if side > 1 else 7)
