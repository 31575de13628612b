from collections import Counter

import numpy as np
import pytest
import torch

from s2glib.corpus import HELD_OUT, Part, split
from s2glib.recipes import video_data
from s2glib.recipes.video_data import (
    TEST_CLIPS,
    TRAIN_CLIPS,
    Film,
    VideoFrames,
    films,
    moving_quarter,
    pixel_motion,
    scenes,
    starting_keypoints,
)


def film(frames, rng, size=32):
    """Noise on the right half only; a hand and a face in two rows."""
    pictures = np.full((frames, size, size, 3), 128, np.uint8)
    pictures[:, :, size // 2 :] = rng.integers(256, size=(frames, size, size // 2, 3))
    parts = np.zeros((frames, size, size), np.uint8)
    parts[:, 0], parts[:, 1], parts[:, 2] = Part.FACE, Part.LEFT_HAND, Part.RIGHT_HAND
    keypoints = rng.normal(size=(frames, 55, 2)).astype(np.float16)
    return Film(pictures, parts, keypoints)


@pytest.fixture
def video(rng):
    return VideoFrames([film(n, rng) for n in (7, 12, 20)])


def test_pairs_come_from_one_clip_and_not_too_far_apart(video, rng):
    pairs = video.pairs(500, rng, furthest=4)
    for rows in (pairs.source, pairs.driving):
        assert (np.searchsorted(video.starts, rows, side="right") - 1 == pairs.clips).all()
    distance = np.abs(pairs.source - pairs.driving)
    assert distance.max() == 4
    assert set(pairs.clips) == {0, 1, 2}


def test_any_two_frames_can_meet(video, rng):
    pairs = video.pairs(4000, rng, furthest=100)
    assert set(np.unique(pairs.source)) == set(range(39))
    assert np.abs(pairs.source - pairs.driving).max() == 19


def test_pictures_are_the_films_in_zero_to_one(rng):
    clips = [film(3, rng), film(4, rng)]
    images = VideoFrames(clips).images(np.array([5]))
    assert images.shape == (1, 3, 32, 32)
    expected = torch.from_numpy(clips[1].frames[2] / 255).permute(2, 0, 1).float()
    torch.testing.assert_close(images[0], expected)


def test_masks_are_those_of_the_renderer(video):
    rows = np.array([0, 30])
    assert video.hands(rows)[:, 0, :, 5].nonzero()[:, 1].tolist() == [1, 2, 1, 2]
    assert video.faces(rows)[:, 0, :, 5].nonzero()[:, 1].tolist() == [0, 0]


def test_motion_is_the_deviation_over_the_clip(rng):
    frames = rng.integers(256, size=(9, 4, 4, 3)).astype(np.uint8)
    colours = torch.from_numpy(frames).double() / 255
    expected = colours.var(dim=0, correction=0).mean(dim=-1).sqrt().float()
    torch.testing.assert_close(pixel_motion(frames)[0], expected)


def test_a_quarter_of_the_pixels_moves(video):
    assert moving_quarter(torch.rand(2, 1, 8, 8)).sum(dim=(1, 2, 3)).tolist() == [16, 16]
    moving = video.moving(np.array([0, 2]))
    assert moving.shape == (2, 1, 32, 32)
    assert (moving[..., :16] == 0).all()


def test_keypoints_start_where_it_moves(video, rng):
    starts = starting_keypoints(video, 4, 5, rng)
    assert starts.shape == (4, 5, 2)
    assert (starts[..., 0] > -0.05).all()
    assert starts.abs().max() <= 0.98
    within, between = starts.std(dim=1).mean(), starts.mean(dim=1).std(dim=0).mean()
    assert within < between * 2  # groups are clusters


def test_the_same_few_clips_of_each_speaker_are_filmed_in_both_looks():
    train, test = scenes("train", TRAIN_CLIPS), scenes("test", TEST_CLIPS)
    assert train == scenes("train", TRAIN_CLIPS)
    assert len({scene.cell for scene in train}) == 4 * TRAIN_CLIPS
    assert len({scene.cell.speaker for scene in test}) == 4
    assert {scene.cell for scene in train} <= set(split("train"))
    assert not {scene.cell for scene in train} & {scene.cell for scene in test}
    for some in (train, test):
        looks = Counter(scene.appearance.name for scene in some)
        assert len(looks) == 8
        assert len(set(looks.values())) == 1


def test_a_film_is_shot_once_for_each_look(tmp_path, monkeypatch):
    monkeypatch.setenv("S2G_CACHE", str(tmp_path))
    cells = scenes("test", 1)[:1]
    (shot,) = films(cells, 32, processes=1)
    monkeypatch.setattr(video_data, "ProcessPoolExecutor", None)  # a second shooting would fail
    (again,) = films(cells, 32)
    with pytest.raises(TypeError):
        films([cells[0]._replace(appearance=HELD_OUT)], 32)
    assert all(np.array_equal(a, b) for a, b in zip(shot, again, strict=True))
    assert shot.frames.shape[1:] == (32, 32, 3)
    assert shot.parts.shape == shot.frames.shape[:3]
    assert shot.keypoints.shape == (len(shot.frames), 55, 2)
