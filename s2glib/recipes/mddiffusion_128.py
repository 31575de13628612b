"""The video model at 128 pixels, begun with the networks of 64: hands have nine pixels, not four.

Keypoints and flow look at as small pictures as before, so what they know stays true. The finest
mask is new, and those who paint learn finer detail.

Paper:    MDD B.1, B.3, B.5
Notebook: notebooks/04_repairing_pixels.ipynb
"""

from dataclasses import replace

from s2glib.checkpoint import load_checkpoint
from s2glib.papers.mddiffusion import (
    TEACHING_DECOUPLING_128,
    DecouplingConfig,
    MotionDecoupler,
    RefinementNet,
)
from s2glib.recipes import mddiffusion_decoupling as decoupling
from s2glib.recipes import mddiffusion_refinement as refinement
from s2glib.recipes.footage import train_and_test
from s2glib.recipes.stage import Stage

CONFIG = TEACHING_DECOUPLING_128
DECOUPLING = replace(
    decoupling.LESSONS["teaching"],
    course=replace(decoupling.LESSONS["teaching"].course, steps=2000, learning_rate=5e-4),
    near=None,
    labelled=None,
)
REFINEMENT = replace(
    refinement.LESSONS["teaching"],
    course=replace(refinement.LESSONS["teaching"].course, steps=1500),
)


def enlarged(small: MotionDecoupler, config: DecouplingConfig) -> MotionDecoupler:
    """A decoupler for larger pictures that begins as a smaller one.

    A mask keeps its size in pixels; those that only the larger one has are new.
    """
    model = MotionDecoupler(config)
    known = small.state_dict()
    same = {name: known[name] for name in known if not name.startswith("flow.masks")}
    model.load_state_dict(same, strict=False)
    masks = dict(zip(small.config.mask_sizes, small.flow.masks, strict=True))
    for size, mask in zip(config.mask_sizes, model.flow.masks, strict=True):
        if size in masks:
            mask.load_state_dict(masks[size].state_dict())
    return model


def train(stage: Stage) -> None:
    """The stage `mddiffusion-128`; the networks of 64 pixels must be there."""
    checkpoints = stage.folder / "checkpoints"
    small = load_checkpoint(checkpoints / "mddiffusion-decoupling.safetensors", MotionDecoupler)
    begun = load_checkpoint(checkpoints / "mddiffusion-refinement.safetensors", RefinementNet)
    video, test = train_and_test(stage.data, CONFIG.size)
    labelled = decoupling.has_labels(video, CONFIG)

    part, model = "mddiffusion-decoupling-128", enlarged(small, CONFIG)
    model, record = decoupling.teach(stage, part, model, DECOUPLING, video, labelled=labelled)
    stage.publish(part, model, record, decoupling.decoupler_figures(model, video, test))

    part = "mddiffusion-refinement-128"
    refiner, record = refinement.fit_refiner(stage, part, model, REFINEMENT, video, begun=begun)
    stage.publish(part, refiner, record, refinement.refiner_figures(model, refiner, test))
