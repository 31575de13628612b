"""Motion that is smooth, and motion with a jolt wherever windows meet."""

from types import SimpleNamespace

import numpy as np
import pytest
import torch

from s2glib.body import Motion, joint
from s2glib.papers.amuse import TEACHING_PRIOR, Amuse, Sampling, UpperBodyFeatures
from s2glib.recipes.evaluate_seams import (
    LEADS,
    contrast,
    joined,
    near_seams,
    seam_frames,
    seam_rows,
    totals,
)
from s2glib.recipes.targets import AMUSE_SEAMS

CLIPS, FRAMES = 6, 165


def swaying(begin=0, frames=CLIPS * FRAMES, jolt=0.0):
    """Elbows that swing at a pace of their own, and jump in the first frame of each window."""
    poses = torch.zeros(frames, 55, 3)
    time = (torch.arange(frames) - begin) / 30
    starts = (torch.arange(frames) % 90 == 0).float()
    poses[:, joint("left_elbow"), 1] = (2.1 * time).sin() / 2 + jolt * starts
    poses[:, joint("right_elbow"), 1] = (2.9 * time).sin() / 2
    return poses


class Generator(Amuse):
    """Moves as the real clips do, but for the jolts."""

    def __init__(self, jolt=0.0):
        self.sampling = Sampling()
        self.prior = SimpleNamespace(features=UpperBodyFeatures(), config=TEACHING_PRIOR)
        self.jolt = jolt

    def generate(self, waveform, *, generator):
        frames = round(waveform.duration * 30)
        poses = swaying(frames - CLIPS * FRAMES, frames, self.jolt)
        return Motion(poses, torch.zeros(frames, 3), torch.zeros(frames, 100), 30)


@pytest.fixture
def recordings():
    sound = np.zeros(FRAMES * 16000 // 30, np.float32)
    return [joined([(sound, poses) for poses in swaying().split(FRAMES)]) for _ in range(2)]


def test_seams_are_where_a_cross_fade_begins_and_where_it_has_ended():
    assert seam_frames(300, 120, 30).tolist() == [90, 120, 180, 210]
    assert seam_frames(120, 120, 30).tolist() == []


@pytest.mark.parametrize(("order", "first"), [(1, 44), (3, 43)])
def test_differences_are_near_a_seam_within_five_frames_of_their_middle(order, first):
    near = near_seams(0, 80, order, np.array([50]))
    assert near.nonzero()[0].tolist() == list(range(first, first + 11))
    shifted = near_seams(7, 80, order, np.array([50]))
    assert shifted.nonzero()[0].tolist() == list(range(first - 7, first + 4))


def test_clips_are_joined_at_tenths_of_seconds(rng):
    sound = rng.normal(size=9000).astype(np.float32)
    recording = joined([(sound, torch.zeros(17, 55, 3)), (sound, torch.zeros(19, 55, 3))])
    assert [len(poses) for poses in recording.poses] == [15, 18]
    assert len(recording.waveform.samples) == 8000 + 9600
    assert np.array_equal(recording.waveform.samples[:8000], sound[:8000])
    assert np.array_equal(recording.waveform.samples[8000:17000], sound)
    assert not recording.waveform.samples[17000:].any()


def test_what_spans_two_clips_does_not_count():
    apart = [torch.zeros(60, 55, 3), swaying(frames=60)]
    found = totals(Generator(), apart, 3, 0)
    assert found[:, [1, 3]].sum(axis=1).tolist() == [57, 57]
    assert found[0, [0, 2]] == pytest.approx(0, abs=1e-2)


def test_means_of_equal_size_have_no_contrast():
    assert contrast(np.array([[2.0, 1, 6, 3], [4, 2, 2, 1]])) == 1
    assert contrast(np.array([[4.0, 1, 6, 3]])) == 2


def test_motion_without_seams_has_a_row_of_one_for_every_target(recordings):
    rows = seam_rows(Generator(), recordings)
    assert {row.name for row in rows} == set(AMUSE_SEAMS)
    assert all(row.value == pytest.approx(1, abs=1e-4) for row in rows)
    assert all((row.n, row.met) == (2 * CLIPS, True) for row in rows)


def test_a_jolt_at_every_window_is_found(recordings):
    speed, jerk = seam_rows(Generator(jolt=0.1), recordings)
    assert speed.value > 1.1
    assert jerk.value > 2
    assert not jerk.met


def test_seams_meet_other_words_after_more_silence():
    places = [set((np.arange(0, 90, 30)[:2] - lead) % 90) for lead in LEADS]
    assert len(set.union(*places)) == 2 * len(LEADS)
