import numpy as np
import pytest
import torch

from s2glib.corpus import Cell, split
from s2glib.papers.amuse import SpeechLatents, UpperBodyFeatures
from s2glib.recipes import MotionWindows, SpeechOfClips, speech_row
from s2glib.recipes.motion_data import EDITED_TAKES, edited_performances

LENGTHS = (50, 12, 30)
CELLS = [Cell(0, "voice_01", emotion, 10) for emotion in ("anger", "neutral", "fear")]


@pytest.fixture
def poses():
    draw = np.random.default_rng(1)
    return [draw.normal(0, 0.3, (length, 55, 3)).astype(np.float16) for length in LENGTHS]


@pytest.fixture
def windows(poses):
    return MotionWindows(CELLS, poses, UpperBodyFeatures(), frames=20)


def test_a_window_is_a_cut_of_the_clips_features(windows, poses):
    cut = windows.window(np.array([0, 2]), np.array([7, 0]))
    features = UpperBodyFeatures()
    for found, pose in zip(cut, (poses[0][7:27], poses[2][:20]), strict=True):
        expected = features.from_poses(torch.from_numpy(pose).float())
        torch.testing.assert_close(found, expected, atol=2e-3, rtol=0)


def test_after_a_clips_end_its_last_frame_is_held(windows):
    cut = windows.window(np.array([1, 0]), np.array([0, 45]))
    assert (cut[0, 12:] == cut[0, 11]).all()
    assert (cut[1, 5:] == cut[1, 4]).all()
    assert (cut[0, 11] != cut[0, 10]).any()


def test_offsets_fit_the_window_into_the_clip(windows, rng):
    clips = rng.integers(3, size=3000)
    offsets = windows.any_offset(clips, rng)
    room = np.maximum(np.array(LENGTHS)[clips] - 20, 0)
    assert (offsets >= 0).all()
    assert (offsets <= room).all()
    assert set(offsets[clips == 2]) == set(range(11))


def test_first_windows_begin_every_clip(windows):
    first = windows.first()
    assert first.shape == (3, 20, 90)
    assert torch.equal(first[1:2], windows.window(np.array([1]), np.array([0])))
    assert windows.emotion.tolist() == [2, 0, 6]


def test_a_motion_finds_the_row_of_its_speech():
    spoken = [Cell(0, "voice_01", "anger", take) for take in (0, 1)]
    moved = [
        Cell(0, "voice_01", "anger", 1),
        Cell(0, "voice_01", "anger", 12),
        Cell(0, "voice_01", "anger", 13),
        Cell(0, "voice_02", "anger", 0),
    ]
    assert speech_row(moved, spoken).tolist() == [1, 0, 1, -1]


def test_speech_of_some_clips_keeps_its_parts_together():
    speech = SpeechOfClips(
        SpeechLatents(*(torch.arange(4.0)[:, None] + n for n in range(3))),
        torch.arange(4.0)[:, None, None],
    )
    some = speech.take(torch.tensor([3, 1]))
    assert some.latents.style.flatten().tolist() == [5, 3]
    assert some.rhythm.flatten().tolist() == [3, 1]


def test_an_edited_performance_is_of_two_training_clips_that_differ_in_emotion():
    train, edits = set(split("train")), edited_performances()
    assert len(edits) > 8000
    for cell, clock in edits:
        heard = cell._replace(take=cell.take % 2)
        assert cell.take in EDITED_TAKES
        assert clock != cell.emotion
        assert {heard, heard._replace(emotion=clock)} <= train
