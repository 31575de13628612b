"""How good a film is where something moves, and whether keypoints know where the wrists are.

Paper:    - (MDD shows pictures; here truth is known)
Notebook: notebooks/03_motion_decoupling.ipynb
"""

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from torch import nn

from s2glib.losses import masked_l1
from s2glib.papers.mddiffusion import MotionDecoupler, RefinementNet
from s2glib.recipes.video_data import WRISTS, VideoFrames

EVERY = 5  # of the frames of a film, one is scored
RIDGE = 1e-2  # of the number of frames
FLAT = 1e-6  # image units; what varies less does not vary


class Errors(NamedTuple):
    """Mean absolute errors in one region of each film, one entry a film.

    Attributes:
        made: of the decoupler's picture.
        refined: of the refined picture; the decoupler's again where there is no refinement.
        warped: of the source picture merely bent.
        copied: of the source picture as it is.
        mean: of the film's mean picture.
    """

    made: Float[np.ndarray, " films"]
    refined: Float[np.ndarray, " films"]
    warped: Float[np.ndarray, " films"]
    copied: Float[np.ndarray, " films"]
    mean: Float[np.ndarray, " films"]

    def shares(self) -> dict[str, float]:
        """Each error over that of copying the source; none where that is 0.

        It is 0 where no film shows the region, or nothing moves in it.
        """
        copied = float(self.copied.mean())
        if not copied:
            return {}
        return {name: float(error.mean()) / copied for name, error in self._asdict().items()}


class RegionErrors(NamedTuple):
    """Errors where to look: in the moving quarter of a film, on its hands, on its face."""

    moving: Errors
    hand: Errors
    face: Errors


@torch.no_grad()
def film_errors(
    decoupler: MotionDecoupler, video: VideoFrames, refiner: RefinementNet | None = None
) -> RegionErrors:
    """Rebuild every film from its first frame, and compare region by region."""
    errors = []
    for clip, (start, length) in enumerate(zip(video.starts, video.lengths, strict=True)):
        rows = np.arange(start, start + length)
        scored = rows[::EVERY]
        driving, source = video.images(scored), video.images(rows[:1])
        source = source.expand_as(driving)
        made = decoupler.eval()(source, driving)
        image, warped = made.synthesis.image, made.synthesis.warped
        refined = refiner.eval()(image, made.flow.occlusion_masks[-1]) if refiner else image
        mean = video.images(rows).mean(dim=0, keepdim=True).expand_as(driving)
        moving = video.moving(np.array([clip])).expand(len(driving), -1, -1, -1)
        regions = (moving, video.hands(scored), video.faces(scored))
        guesses = (image, refined, warped, source, mean)
        errors.append([[float(masked_l1(driving, g, mask)) for mask in regions] for g in guesses])
    by_region = np.array(errors).transpose(2, 1, 0)  # (regions, guesses, films)
    return RegionErrors(*(Errors(*region) for region in by_region))


@torch.no_grad()
def keypoint_tracks(
    predictor: nn.Module, video: VideoFrames, every: int = EVERY
) -> tuple[Float[np.ndarray, "n numbers"], Float[np.ndarray, "n 4"]]:
    """Predicted keypoints of every few frames, and where the wrists truly are."""
    rows = torch.arange(0, len(video.frames), every)
    parts = [predictor.eval()(video.images(some)).flatten(1) for some in rows.split(128)]
    return torch.cat(parts).numpy(), video.keypoints[rows][:, WRISTS].flatten(1).numpy()


def wrists_explained(
    predictor: nn.Module, train: VideoFrames, test: VideoFrames
) -> Float[np.ndarray, " 4"]:
    """R^2 of left x, left y, right x, right y: ridge regression on keypoints, on other films.

    Keypoints are divided by their spread, so that ones that hardly move are heard as well.
    """
    x, y = keypoint_tracks(predictor, train)
    x_new, y_new = keypoint_tracks(predictor, test)
    mean_x, mean_y, spread = x.mean(axis=0), y.mean(axis=0), x.std(axis=0) + FLAT
    x, x_new = (x - mean_x) / spread, (x_new - mean_x) / spread
    penalty = RIDGE * len(x) * np.eye(x.shape[1])
    slope = np.linalg.solve(x.T @ x + penalty, x.T @ (y - mean_y))
    error = np.square(y_new - mean_y - x_new @ slope).sum(axis=0)
    return 1 - error / np.square(y_new - y_new.mean(axis=0)).sum(axis=0)
