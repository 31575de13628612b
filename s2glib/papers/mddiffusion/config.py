"""MDD's sizes: what the paper prints, and the small models that train on a laptop.

Every number says where it comes from: a section, the authors' code, or ours.

Paper:    MDD B.1, B.3, B.5
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from dataclasses import dataclass, replace
from typing import Literal


@dataclass(frozen=True)
class DecouplingConfig:
    """Motion decoupling: two pictures in; keypoints, a flow and the second picture out."""

    size: int = 256  # pixels  [MDD B.5]
    transforms: int = 20  # K  [MDD B.5]
    points: int = 5  # N, of each transform  [MDD B.5]
    warp: Literal["tps", "affine"] = "tps"  # "affine": MRAA's regions  [MDD E]
    ridge: float = 0.01  # authors' code; [MDD Eq. A5] has 0, which coinciding points break
    rests: bool = False  # equal keypoints bend nothing, whatever the ridge: ours
    region_floor: float = 0.05  # blur of the regions of "affine"; ours: MRAA has none, and fails
    background: Literal["still", "affine"] = "still"  # authors' code; TPSMM has "affine"

    keypoint_size: int | None = None  # pixels that keypoints are found on; None: all, [MDD B.5]
    keypoint_widths: tuple[int, int, int, int] = (64, 128, 256, 512)  # ResNet-18  [MDD B.5]
    keypoint_blocks: tuple[int, int, int, int] = (2, 2, 2, 2)  # ResNet-18  [MDD B.5]
    keypoint_early_pool: bool = True  # ResNet-18; without: ours, for small pictures
    keypoint_grid: int = 1  # places of the last pooling: ResNet-18; more: ours
    keypoint_gain: float = 1.0  # of the outputs; below 1 keypoints wander less: ours
    keypoint_reach: float = 1.0  # image units; more: ours, for hands outside the picture

    flow_size: int = 64  # pixels of the weight maps  [MDD B.5]
    heatmap_variance: float = 0.01  # of a keypoint's blob; authors' code
    nearness: float = 0.0  # how much more a warp counts at its own points at first: ours
    flow_width: int = 64  # authors' code
    flow_widest: int = 1024  # authors' code
    flow_blocks: int = 5  # authors' code
    head_kernel: int = 7  # of the convolutions that make weight maps and masks; authors' code
    mask_narrowing: int = 2  # of channels, at each step to a finer mask; authors' code
    visible_at_start: float = 0.5  # value of untrained occlusion masks; another: ours

    synthesis_width: int = 64  # authors' code
    synthesis_blocks: int = 3  # steps down: masks of 32, 64, 128, 256  [MDD B.5]
    residual_blocks: int = 2  # after the bottom and after each join; authors' code

    def __post_init__(self):
        if self.keypoint_size is not None and self.size % self.keypoint_size:
            raise ValueError(
                f"pictures of {self.size} pixels cannot be shrunk to keypoint_size="
                f"{self.keypoint_size}; take a divisor, or None"
            )
        coarsest = self.flow_size // 2 ** (self.flow_blocks - 1)  # where the hourglass turns up
        if (
            self.size % 2**self.synthesis_blocks
            or self.flow_size % 2**self.flow_blocks
            or self.flow_size not in self.mask_sizes
            or self.mask_sizes[0] < coarsest
        ):
            raise ValueError(
                f"weight maps of {self.flow_size} pixels, halved {self.flow_blocks} times, give no "
                f"occlusion masks of {self.mask_sizes} pixels; change size, flow_size, flow_blocks "
                "or synthesis_blocks"
            )

    @property
    def keypoint_shrinking(self) -> int:
        """How many times smaller a picture is made before keypoints are looked for."""
        return self.size // (self.keypoint_size or self.size)

    @property
    def mask_sizes(self) -> tuple[int, ...]:
        """Pixels of the occlusion masks, coarse to fine."""
        return tuple(self.size // 2**k for k in reversed(range(self.synthesis_blocks + 1)))


@dataclass(frozen=True)
class RefinementConfig:
    """Refinement: a synthesised picture and what was occluded in it; a repaired picture out."""

    widths: tuple[int, ...] = (64, 128, 256, 512, 512, 512, 512, 512)  # eight steps [MDD B.3]
    residual_blocks: int = 2  # at half and at full size  [MDD B.3]
    adds: bool = False  # predict what to add to the input; True: ours
    patch_widths: tuple[int, ...] = (64, 128, 256, 512)  # of the discriminator; authors' code


PAPER_DECOUPLING = DecouplingConfig()
PAPER_REFINEMENT = RefinementConfig()

TEACHING_DECOUPLING = replace(
    PAPER_DECOUPLING,
    size=64,
    transforms=8,
    ridge=0.001,
    rests=True,
    keypoint_widths=(16, 32, 64, 96),
    keypoint_blocks=(1, 1, 1, 1),
    keypoint_early_pool=False,
    keypoint_grid=4,
    keypoint_gain=0.1,
    keypoint_reach=1.25,
    flow_size=32,
    nearness=6.0,
    flow_width=16,
    flow_widest=64,
    flow_blocks=3,
    head_kernel=3,
    mask_narrowing=5,
    visible_at_start=0.88,
    synthesis_width=8,
)
TEACHING_DECOUPLING_128 = replace(TEACHING_DECOUPLING, size=128, keypoint_size=64)
TEACHING_REFINEMENT = replace(
    PAPER_REFINEMENT,
    widths=(16, 32, 48, 64, 64),
    adds=True,
    patch_widths=(24, 48, 64),
)

DECOUPLING_PRESETS = {"paper": PAPER_DECOUPLING, "teaching": TEACHING_DECOUPLING}
REFINEMENT_PRESETS = {"paper": PAPER_REFINEMENT, "teaching": TEACHING_REFINEMENT}
