import numpy as np
import pytest
import torch

from s2glib.corpus import (
    Cell,
    Request,
    build,
    motion_set,
    render_clip,
    render_motion,
    speech_set,
    timing_of,
)
from s2glib.data import noise_floor, spoken_frames

CELL = Cell(1, "voice_01", "anger", 2)


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty cache, filled in this process."""
    monkeypatch.setenv("S2G_CACHE", str(tmp_path))
    monkeypatch.setattr(
        build, "_render_all", lambda _, jobs, __: [build._render_group(*job) for job in jobs]
    )
    return tmp_path


def test_a_clip_is_what_its_cell_and_clock_say(spoken):
    clip = spoken["voice_01", "surprise"]
    assert clip.id == "s01-voice_01-surprise-t2@neutral"
    clock = timing_of(Cell(1, "voice_01", "neutral", 2))
    assert [p.start for p in clip.phonemes] == clock.boundaries[:-1].tolist()
    assert [w.name for w in clip.words] == list(clock.words)
    assert np.array_equal(clip.stress_times, clock.stress_times)


def test_sound_and_motion_are_equally_long(spoken):
    for clip in spoken.values():
        assert clip.motion.duration == pytest.approx(clip.waveform.duration, abs=1 / 30)


def test_a_motion_without_sound_is_the_motion_of_the_clip(spoken):
    clip = spoken["voice_05", "sadness"]
    silent = render_motion(Cell(1, "voice_05", "sadness", 2), clock_of="neutral")
    assert silent.waveform is None
    assert torch.equal(silent.motion.poses, clip.motion.poses)


def test_a_motion_take_shares_sound_and_clock_with_its_speech_take():
    speech, performance = (render_clip(1, "voice_01", "fear", take) for take in (0, 10))
    assert np.array_equal(speech.waveform.samples, performance.waveform.samples)
    assert speech.phonemes == performance.phonemes
    assert speech.intensity == performance.intensity
    assert not torch.equal(speech.motion.poses, performance.motion.poses)


@pytest.mark.parametrize(
    ("cell", "reason"),
    [
        ((16, "voice_01", "anger", 2), "sentences"),
        ((1, "voice_00", "anger", 2), "speakers"),
        ((1, "voice_01", "joy", 2), "emotions"),
        ((1, "voice_01", "anger", -1), "takes"),
    ],
)
def test_what_the_script_lacks_is_refused(cell, reason):
    with pytest.raises(ValueError, match=reason):
        render_clip(*cell)
    with pytest.raises(ValueError, match="emotions"):
        render_motion(CELL, clock_of="joy")


def test_cached_poses_are_the_rendered_ones_in_the_order_asked_for(cache):
    cells = [Cell(s, "voice_02", e, 10) for s in (3, 0) for e in ("fear", "anger")]
    found = motion_set(cells)
    assert found.fps == 30
    for cell, poses in zip(cells, found.poses, strict=True):
        expected = render_motion(cell).motion.poses.numpy().astype(np.float16)
        assert np.array_equal(poses, expected)
    assert len(list(cache.rglob("*.npz"))) == 2  # one file a sentence and speaker


def test_motion_on_another_emotions_clock_is_a_clip_of_its_own(cache):
    own, slow = motion_set([CELL, Request(CELL, "sadness")]).poses
    expected = render_motion(CELL, clock_of="sadness").motion.poses.numpy().astype(np.float16)
    assert np.array_equal(slow, expected)
    assert len(own) != len(slow)


def test_what_the_cache_holds_is_not_rendered_again(cache, monkeypatch):
    first = motion_set([CELL]).poses[0]
    motion_set([CELL, CELL._replace(take=1)])  # joins the same file
    monkeypatch.setattr(build, "_render_group", None)
    assert np.array_equal(motion_set([CELL._replace(take=1), CELL]).poses[1], first)


def test_speech_windows_end_in_the_constant_noise_floor(cache):
    requests = [Request(CELL), Request(CELL, "sadness")]
    found = speech_set(requests)
    assert found.windows.shape == (2, build.WINDOW["frames"], build.WINDOW["n_mels"])
    floor = noise_floor(build.WINDOW["n_mels"]).astype(np.float16)
    for request, window, seconds in zip(requests, *found, strict=True):
        assert seconds == timing_of(*request).duration
        spoken = spoken_frames(float(seconds), frames=352, pool=2)
        assert window[spoken + 1 :] == pytest.approx(np.broadcast_to(floor, (351 - spoken, 64)))
        assert window[: spoken - 10].astype(np.float32).std() > 1


def test_windows_of_another_size_are_cached_apart(cache):
    usual = speech_set([Request(CELL)]).windows
    folder = cache / f"speech-v{build.VERSION}"
    before = (folder / "s01-voice_01.npz").read_bytes()
    papers = speech_set([Request(CELL)], {"n_mels": 128, "frames": 1024, "pool": 1}).windows
    assert papers.shape == (1, 1024, 128)
    assert (cache / f"speech-1024x128x1-v{build.VERSION}" / "s01-voice_01.npz").exists()
    assert (folder / "s01-voice_01.npz").read_bytes() == before
    assert np.array_equal(speech_set([Request(CELL)]).windows, usual)


def test_several_processes_render_what_one_would(tmp_path, monkeypatch):
    monkeypatch.setenv("S2G_CACHE", str(tmp_path))
    found = motion_set([CELL], processes=1)
    expected = render_motion(CELL).motion.poses.numpy().astype(np.float16)
    assert np.array_equal(found.poses[0], expected)
    assert not list(tmp_path.rglob("*.tmp*"))
