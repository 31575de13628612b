from dataclasses import replace

import numpy as np
import pytest
import torch
from small_video import SMALL_DECOUPLING, noise_film
from torch import nn

from s2glib.papers.mddiffusion import TEACHING_REFINEMENT, MotionDecoupler, RefinementNet
from s2glib.recipes.video_data import WRISTS, Film, VideoFrames
from s2glib.recipes.video_scores import Errors, film_errors, wrists_explained


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.fixture
def video(rng):
    """A dot that walks along the diagonal, with both wrists on it."""
    frames = np.full((21, 32, 32, 3), 40, np.uint8)
    keypoints = np.zeros((21, 55, 2), np.float16)
    for t in range(21):
        frames[t, t : t + 10, t : t + 10] = 200
        keypoints[t, WRISTS] = (t + 4.5) / 31 * 2 - 1
    frames = frames + rng.integers(4, size=frames.shape).astype(np.uint8)
    return VideoFrames([Film(frames, np.zeros(frames.shape[:3], np.uint8), keypoints)])


class Corners(nn.Module):
    """Reads the dot's place off the picture, as two keypoints; or answers always the same."""

    def __init__(self, blind=False):
        super().__init__()
        self.blind = blind

    def forward(self, image):
        light = image.mean(dim=1) - 40 / 255
        line = torch.linspace(-1, 1, 32)
        x = (light.sum(dim=1) * line).sum(dim=1) / light.sum(dim=(1, 2))
        return (x * (0 if self.blind else 1))[:, None, None, None].expand(-1, 1, 2, 2)


def test_a_still_picture_scores_as_a_copy(video):
    model = MotionDecoupler(SMALL_DECOUPLING)
    for mask in model.flow.masks:
        nn.init.zeros_(mask.weight)
        nn.init.constant_(mask.bias, 20)  # everything visible
    nn.init.zeros_(model.flow.weights.weight)
    nn.init.zeros_(model.flow.weights.bias)
    model.flow.weights.bias.data[0] = 20  # and only the background counts
    shares = film_errors(model, video).moving.shares()
    assert shares["copied"] == 1
    assert [shares[name] for name in ("made", "warped", "refined")] == pytest.approx(
        [1] * 3, rel=1e-3
    )


def test_errors_are_means_over_what_moves(video):
    errors = film_errors(MotionDecoupler(SMALL_DECOUPLING), video).moving
    true = video.images(np.arange(21))
    moving = video.moving(np.array([0]))[0, 0].bool()
    copied = (true[::5] - true[0]).abs().mean(dim=1)[:, moving].mean()
    mean = (true[::5] - true.mean(dim=0)).abs().mean(dim=1)[:, moving].mean()
    assert errors.copied == pytest.approx([float(copied)], rel=1e-4)
    assert errors.mean == pytest.approx([float(mean)], rel=1e-4)


def test_refinement_is_scored_where_there_is_one(video):
    torch.manual_seed(0)
    refiner = RefinementNet(replace(TEACHING_REFINEMENT, widths=(4, 6, 8), adds=False)).eval()
    errors = film_errors(MotionDecoupler(SMALL_DECOUPLING), video, refiner).moving
    assert errors.refined != errors.made


def test_shares_are_of_the_copys_error():
    errors = Errors(*(np.array([k, 2.0 * k]) for k in (1.0, 2.0, 3.0, 4.0, 8.0)))
    expected = {"made": 0.25, "refined": 0.5, "warped": 0.75, "copied": 1.0, "mean": 2.0}
    assert errors.shares() == pytest.approx(expected)


def test_there_are_no_shares_where_copying_is_perfect():
    assert Errors(*(np.zeros(2) for _ in Errors._fields)).shares() == {}


def test_keypoints_on_the_wrist_explain_it_and_blind_ones_do_not(video):
    assert (wrists_explained(Corners(), video, video) > 0.98).all()
    assert wrists_explained(Corners(blind=True), video, video) == pytest.approx(
        np.zeros(4), abs=1e-3
    )


def test_hands_and_faces_are_scored_where_they_are(rng):
    video = VideoFrames([noise_film(rng)])
    errors = film_errors(MotionDecoupler(SMALL_DECOUPLING), video)
    scored = np.arange(0, 12, 5)
    true, mask = video.images(scored), video.hands(scored).bool()[:, 0]
    difference = (true - true[:1]).abs().mean(dim=1)
    by_frame = [float(one[where].mean()) for one, where in zip(difference, mask, strict=True)]
    assert errors.hand.copied == pytest.approx([np.mean(by_frame)], rel=1e-4)
    assert errors.face.copied != errors.hand.copied
