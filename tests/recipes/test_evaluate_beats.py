import numpy as np
import pytest

from s2glib.recipes.evaluate_beats import beat_rows


@pytest.fixture
def moving(rng):
    """Six arm points that stop dead at moments of their own in every clip; the rest stand still."""
    stops = [np.sort(rng.choice(np.arange(10, 110, 12), 5, replace=False)) for _ in range(12)]
    speed = np.ones((12, 119))
    for clip, at in enumerate(stops):
        for shift in (-1, 0, 1):
            speed[clip, at + shift] = 0.1 + 0.4 * abs(shift)
    path = np.concatenate([np.zeros((12, 1)), np.cumsum(speed, axis=1)], axis=1) / 30
    places = np.zeros((12, 120, 9, 3))
    places[:, :, 1:7, 0] = path[:, :, None]
    return places, [(at + 0.5) / 30 for at in stops]


def figures(rows):
    return {row.name: row.value for row in rows}


@pytest.mark.parametrize("way", ["motion to audio", "audio to motion"])
def test_a_body_that_stops_on_every_beat_is_aligned_and_beats_chance(moving, way):
    got = figures(beat_rows(*(moving[0], moving[0], moving[1]), "onsets"))
    assert got[f"beat alignment of real motion, {way}, onsets"] == pytest.approx(1)
    assert got[f"beat margin of real motion, {way}, onsets"] > 0.2
    assert got[f"beat margin / real, {way}, onsets"] == 1


def test_a_body_that_never_stops_has_no_margin(moving):
    steady = np.zeros_like(moving[0])
    steady[:, :, 1:7, 0] = np.arange(120)[:, None] / 30
    got = figures(beat_rows(moving[0], steady, moving[1], "onsets"))
    assert got["beat margin / real, motion to audio, onsets"] == 0
    assert got["beat margin / real, audio to motion, onsets"] == 0


def test_beats_after_the_end_of_the_motion_do_not_count(moving):
    places, beats = moving
    later = [np.append(b, [4.2, 5.0]) for b in beats]
    assert beat_rows(places, places, later, "x") == beat_rows(places, places, beats, "x")


def test_a_short_clip_ends_where_its_motion_does(moving):
    places, beats = moving
    lengths = np.where(np.arange(12) < 6, 60, 120)
    cut = [b[b < n / 30] for b, n in zip(beats, lengths, strict=True)]
    short = figures(beat_rows(places, places, beats, "x", lengths))
    assert short == figures(beat_rows(places, places, cut, "x", lengths))
    assert short != figures(beat_rows(places, places, cut, "x"))  # chance knows of the ends
    assert figures(beat_rows(places, places, beats, "x", np.full(12, 120))) == figures(
        beat_rows(places, places, beats, "x")
    )
