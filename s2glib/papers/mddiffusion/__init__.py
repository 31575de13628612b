"""S2G-MDDiffusion: motion decoupled from looks by thin-plate splines; gesture video."""

from s2glib.papers.mddiffusion.config import (
    DECOUPLING_PRESETS,
    PAPER_DECOUPLING,
    PAPER_REFINEMENT,
    REFINEMENT_PRESETS,
    TEACHING_DECOUPLING,
    TEACHING_DECOUPLING_128,
    TEACHING_REFINEMENT,
    DecouplingConfig,
    RefinementConfig,
)
from s2glib.papers.mddiffusion.decoupling import (
    BackgroundPredictor,
    DecouplingLosses,
    MotionDecoupler,
    Reconstruction,
    decoupling_losses,
    equivariance,
    label_error,
)
from s2glib.papers.mddiffusion.flow_predictor import (
    Flow,
    FlowPredictor,
    group_blobs,
    group_warps,
)
from s2glib.papers.mddiffusion.image_synthesis import ImageSynthesizer, Synthesis, warp_and_mask
from s2glib.papers.mddiffusion.keypoint_predictor import KeypointPredictor
from s2glib.papers.mddiffusion.pipeline import MDDiffusion, Video
from s2glib.papers.mddiffusion.refinement import (
    Masks,
    PatchDiscriminator,
    RefinementLosses,
    RefinementNet,
    merge,
    refinement_losses,
)

__all__ = [
    "DECOUPLING_PRESETS",
    "PAPER_DECOUPLING",
    "PAPER_REFINEMENT",
    "REFINEMENT_PRESETS",
    "TEACHING_DECOUPLING",
    "TEACHING_DECOUPLING_128",
    "TEACHING_REFINEMENT",
    "BackgroundPredictor",
    "DecouplingConfig",
    "DecouplingLosses",
    "Flow",
    "FlowPredictor",
    "ImageSynthesizer",
    "KeypointPredictor",
    "MDDiffusion",
    "Masks",
    "MotionDecoupler",
    "PatchDiscriminator",
    "Reconstruction",
    "RefinementConfig",
    "RefinementLosses",
    "RefinementNet",
    "Synthesis",
    "Video",
    "decoupling_losses",
    "equivariance",
    "group_blobs",
    "group_warps",
    "label_error",
    "merge",
    "refinement_losses",
    "warp_and_mask",
]
