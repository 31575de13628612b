"""The shipped corpus: complete, unchanged, small, and equal to what the generator makes."""

import shutil

import numpy as np
import pytest
import torch

from s2glib.corpus.build import render_clip, render_motion
from s2glib.corpus.script import EMOTIONS, parse_id, split
from s2glib.corpus.ship import write_windows
from s2glib.data import clips, load_clip, speech_windows
from s2glib.folders import data_folder


@pytest.fixture(scope="module")
def clip():
    return load_clip("s04-voice_01-anger-t2")


def test_the_shipped_clips_are_a_full_factorial():
    cells = [parse_id(name) for name in clips()]
    sentences, speakers = ({getattr(c, f) for c in cells} for f in ("sentence", "speaker"))
    assert len(set(cells)) == len(sentences) * len(speakers) * len(EMOTIONS) == 128
    assert {cell.take for cell in cells} == {2}


def test_no_shipped_clip_is_trained_on():
    assert not set(clips()) & {*clips("train"), *clips("validation")}


def test_the_manifest_lists_the_scripts_splits():
    for name in ("train", "validation", "test", "unseen-sentences", "unseen-speakers"):
        assert clips(name) == [cell.id for cell in split(name)]


def test_the_shipped_data_stay_below_forty_megabytes():
    files = [path for path in data_folder().rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < 40e6


def test_a_clips_tracks_fit_each_other(clip):
    assert len(clip.semantic) == len(clip.gesture_type) == clip.motion.frames
    assert clip.waveform.duration == pytest.approx(clip.motion.duration, abs=1 / 30)
    assert clip.words[-1].end < clip.motion.duration
    assert [word.name for word in clip.words][:3] == ["I", "told", "you"]


@pytest.mark.parametrize("name", ["s04-voice_01-anger-t2", "s10-voice_13-sadness-t2"])
def test_shipped_motion_regenerates_within_the_promised_bounds(name):
    shipped, made = load_clip(name).motion, render_motion(parse_id(name)).motion
    assert (shipped.poses - made.poses).abs().max() < 1e-3  # radians; float16 below 4
    assert (shipped.trans - made.trans).abs().max() < 1e-4  # metres


def test_shipped_sound_regenerates_below_minus_sixty_decibels(clip):
    made = render_clip(*parse_id(clip.id)).waveform
    difference = clip.waveform.samples - made.samples
    assert 20 * np.log10(np.abs(difference).max()) < -60


def test_live_training_windows_belong_to_take_zero_of_the_shipped_cells():
    names, windows = speech_windows()
    assert windows.shape == (128, 352, 64)
    assert np.isfinite(windows).all()
    assert (windows * 8 == np.round(windows * 8)).all()
    assert {parse_id(n)._replace(take=2).id for n in names} == set(clips())


def test_windows_are_kept_to_an_eighth(tmp_path):
    rng = np.random.default_rng(0)
    windows = rng.normal(-6, 3.4, (2, 5, 3)).astype(np.float16)
    write_windows(tmp_path / "windows.npz", ["one", "other"], windows)
    with np.load(tmp_path / "windows.npz") as stored:
        assert stored["id"].tolist() == ["one", "other"]
        assert stored["window"].dtype == np.float16
        assert np.abs(stored["window"].astype(float) - windows).max() <= 1 / 16


def test_an_unknown_clip_is_refused_with_a_way_out():
    with pytest.raises(ValueError, match="render_motion"):
        load_clip("s00-voice_30-anger-t2")


def test_an_unknown_split_is_refused_by_name():
    with pytest.raises(ValueError, match="shipped, train"):
        clips("tests")


def test_a_changed_file_is_refused(tmp_path, monkeypatch):
    shutil.copy(data_folder() / "manifest.json", tmp_path)
    (tmp_path / "clips").mkdir()
    for ending in ("flac", "npz"):
        (tmp_path / "clips" / f"s04-voice_01-anger-t2.{ending}").write_bytes(b"else")
    monkeypatch.setenv("S2G_DATA", str(tmp_path))
    with pytest.raises(ValueError, match="not the file that was shipped"):
        load_clip("s04-voice_01-anger-t2")


def test_a_folder_without_a_corpus_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("S2G_DATA", str(tmp_path))
    with pytest.raises(FileNotFoundError, match="S2G_DATA"):
        clips()


def test_motions_are_single_precision(clip):
    assert clip.motion.poses.dtype == torch.float32
