"""From one picture of a person, and motion from anywhere, to a film of that person.

Paper:    MDD B.1 (animation), B.3 (refinement)
Notebook: notebooks/04_repairing_pixels.ipynb
"""

from functools import partial
from pathlib import Path
from typing import Literal, NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.checkpoint import load_checkpoint
from s2glib.layers import in_batches
from s2glib.papers.mddiffusion.decoupling import MotionDecoupler
from s2glib.papers.mddiffusion.refinement import RefinementNet

FPS = 25.0  # [MDD 4.1]
AT_ONCE = 16  # frames
BEYOND = 1e-3  # what rounding may add to a picture
FARTHEST = 3  # image units; keypoints of pictures lie within 1


class Video(NamedTuple):
    """A film, and the motion that it was made from.

    Attributes:
        frames: pictures in 0 .. 1.
        keypoints: of every frame, group after group.
        fps: frames per second.
    """

    frames: Float[Tensor, "frames 3 size size"]
    keypoints: Float[Tensor, "frames keypoints 2"]
    fps: float


class MDDiffusion:
    """The trained networks and how they work together.

    Args:
        decoupler: splits motion from looks.
        refiner: repairs what the decoupler painted; None leaves it as it is.
    """

    def __init__(self, decoupler: MotionDecoupler, refiner: RefinementNet | None = None):
        self.decoupler = decoupler.eval()
        self.refiner = None if refiner is None else refiner.eval()

    @classmethod
    def load(cls, folder: Path, *, size: Literal[64, 128] = 64) -> "MDDiffusion":
        """Read the checkpoints of a folder: those for pictures of so many pixels.

        Raises:
            FileNotFoundError: if one is missing.
            ValueError: if one is not what it should be, or there are none of that size.
        """
        if size not in (64, 128):
            raise ValueError(f"networks are for 64 or 128 pixels, got size={size!r}")
        which = "" if size == 64 else f"-{size}"
        return cls(
            load_checkpoint(folder / f"mddiffusion-decoupling{which}.safetensors", MotionDecoupler),
            load_checkpoint(folder / f"mddiffusion-refinement{which}.safetensors", RefinementNet),
        )

    @torch.no_grad()
    def keypoints(
        self, pictures: Float[Tensor, "frames 3 size size"]
    ) -> Float[Tensor, "frames keypoints 2"]:
        """The motion in a film: where the control points are in every picture.

        Raises:
            TypeError: if the pictures are not float32.
            ValueError: if they have another size than the networks, a value is not in 0 .. 1, or
                there is none.
        """
        self._check(pictures)
        return in_batches(self.decoupler.keypoints, pictures, size=AT_ONCE).flatten(1, 2)

    @torch.no_grad()
    def animate(
        self,
        picture: Float[Tensor, "3 size size"],
        keypoints: Float[Tensor, "frames keypoints 2"],
    ) -> Video:
        """Move a picture: one frame for each set of keypoints.

        Args:
            picture: of the person, in 0 .. 1.
            keypoints: the motion, as `keypoints` finds it in a film.

        Raises:
            TypeError: if the picture or the keypoints are not float32.
            ValueError: if a shape does not fit the networks, or a value is out of range.
        """
        _check_float32("the picture", picture)
        self._check(picture[None])
        self._check_keypoints(keypoints)
        config = self.decoupler.config
        groups = (config.transforms, config.points)
        here = self.decoupler.keypoints(picture[None])
        paint = partial(self._frames, picture, here)
        frames = in_batches(paint, keypoints.unflatten(1, groups), size=AT_ONCE)
        return Video(frames, keypoints, FPS)

    def reenact(
        self,
        picture: Float[Tensor, "3 size size"],
        driving: Float[Tensor, "frames 3 size size"],
    ) -> Video:
        """Let the person of one picture do what a film shows; errors as `animate`.

        If the film begins with that very picture, it is rebuilt from it (self-reenactment).
        """
        return self.animate(picture, self.keypoints(driving))

    def _frames(self, picture: Tensor, here: Tensor, there: Tensor) -> Tensor:
        source = picture.expand(len(there), -1, -1, -1)
        synthesis, flow = self.decoupler.animate(source, here.expand_as(there), there)
        if self.refiner is None:
            return synthesis.image
        return self.refiner(synthesis.image, flow.occlusion_masks[-1]).clamp(0, 1)

    def _check(self, pictures: Tensor) -> None:
        size = self.decoupler.config.size
        _check_float32("pictures", pictures)
        if pictures.ndim != 4 or pictures.shape[1:] != (3, size, size) or not len(pictures):
            raise ValueError(
                f"expected pictures of shape (3, {size}, {size}), got {tuple(pictures.shape[1:])} "
                f"and {len(pictures)} of them; film or shrink them to {size} pixels"
            )
        if not ((pictures >= -BEYOND) & (pictures <= 1 + BEYOND)).all():
            raise ValueError("pictures must have values from 0 to 1; divide bytes by 255")

    def _check_keypoints(self, keypoints: Tensor) -> None:
        _check_float32("keypoints", keypoints)
        shape = (self.decoupler.config.transforms * self.decoupler.config.points, 2)
        if keypoints.shape[1:] != shape or not len(keypoints):
            raise ValueError(
                f"expected keypoints of shape (frames, {shape[0]}, 2), got "
                f"{tuple(keypoints.shape)}; take those that this model finds in a film"
            )
        if not (keypoints.abs() <= FARTHEST).all():
            raise ValueError(
                f"keypoints must be finite and within {FARTHEST} image units of the middle; -1 and "
                "1 are the edges of the picture"
            )


def _check_float32(name: str, values: Tensor) -> None:
    if not isinstance(values, Tensor) or values.dtype != torch.float32:
        kind = values.dtype if isinstance(values, Tensor) else type(values).__name__
        raise TypeError(f"{name} must be a float32 tensor, got {kind}")
