"""Keypoints as the paper learns them, without any labels: to see what that finds on a laptop.

Paper:    MDD B.1, B.5
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from dataclasses import replace

from s2glib.papers.mddiffusion import TEACHING_DECOUPLING
from s2glib.recipes.footage import train_and_test
from s2glib.recipes.mddiffusion_decoupling import LESSONS, fit_decoupler
from s2glib.recipes.stage import Stage
from s2glib.recipes.video_scores import film_errors, wrists_explained

STAGE = "mddiffusion-unlabelled"
CONFIG = replace(
    TEACHING_DECOUPLING, ridge=0.01, rests=False, nearness=0.0, keypoint_reach=1.0
)  # what belongs to limbs is off
LESSON = replace(
    LESSONS["teaching"], course=replace(LESSONS["teaching"].course, steps=9000), labelled=None
)


def train(stage: Stage) -> None:
    """The stage `mddiffusion-unlabelled`; only the keypoint predictor is kept."""
    video, test = train_and_test(None, CONFIG.size)
    model, record = fit_decoupler(stage, STAGE, CONFIG, LESSON, video)
    errors = film_errors(model, test)
    figures = {
        "made / copied": errors.moving.shares()["made"],
        "hand: made / copied": errors.hand.shares()["made"],
        "wrists R2": float(wrists_explained(model.keypoints, video, test).mean()),
    }
    stage.publish(STAGE, model.keypoints, record, figures)
