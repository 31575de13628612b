import base64
import json
import re
import subprocess
import sys

import numpy as np
import pytest
import torch

from s2glib.__main__ import main
from s2glib.audio import load
from s2glib.body import FACE_CURVES, mannequin, read_bvh
from s2glib.corpus.script import EMOTIONS
from s2glib.papers.amuse.pipeline import Amuse

FILES = {"motion.npz", "motion.glb", "motion.bvh", "gesture.html", "report.json"}


def test_the_files_stand_in_a_new_folder(record, swap, here):
    swap(record(), "--emotion", "anger", out="new/folder")
    assert {path.name for path in (here / "new" / "folder").iterdir()} == FILES
    assert {path.name for path in here.iterdir()} == {"new", "speech.wav"}


def test_the_npz_has_the_names_and_shapes_of_smplx_files(record, swap):
    motion, _ = swap(record(seconds=1.0), "--emotion", "fear")
    curves = len(FACE_CURVES)
    assert {name: value.shape for name, value in motion.items()} == {
        "poses": (30, 165),
        "trans": (30, 3),
        "mocap_frame_rate": (),
        "betas": (300,),
        "gender": (),
        "expressions": (30, 100),
        "s2g_expressions": (30, curves),
        "s2g_expression_names": (curves,),
    }
    assert motion["mocap_frame_rate"] == 30
    assert not motion["betas"].any()
    assert not motion["expressions"].any()
    assert motion["s2g_expressions"].any()


def test_the_motion_is_what_the_pipeline_edits(record, swap, data):
    motion, _ = swap(record(), "--emotion", "sadness", "--seed", "3")
    amuse = Amuse.load(data / "checkpoints")
    noise = torch.Generator().manual_seed(3)
    edited = amuse.edit(load("speech.wav"), emotion=EMOTIONS.index("sadness"), generator=noise)
    np.testing.assert_allclose(motion["poses"], edited.poses.flatten(1), atol=1e-5)
    np.testing.assert_allclose(motion["trans"], edited.trans, atol=1e-6)


def test_donors_lend_emotion_and_style(record, swap, data):
    donors = record("e.wav", 1.5, gain=3.0), record("s.wav", 0.8, rate=22050)
    motion, report = swap(record(), "--emotion-from", donors[0], "--style-from", donors[1])
    edited = Amuse.load(data / "checkpoints").edit(
        load("speech.wav"),
        emotion=load(donors[0]),
        style=load(donors[1]),
        generator=torch.Generator().manual_seed(0),
    )
    np.testing.assert_allclose(motion["poses"], edited.poses.flatten(1), atol=1e-5)
    assert report["swapped"] == {"emotion": "e.wav", "style": "s.wav"}
    assert report["kept"] == ["content"]


def test_emotion_and_seed_change_the_motion_and_nothing_else_does(record, swap):
    def poses(*arguments):
        return swap(record(), *arguments)[0]["poses"]

    anger = poses("--emotion", "anger")
    assert np.array_equal(anger, poses("--emotion", "anger"))
    assert np.abs(anger - poses("--emotion", "sadness")).max() > 0.001
    assert np.abs(anger - poses("--emotion", "anger", "--seed", "1")).max() > 0.001


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("a.wav", {"subtype": "PCM_16"}),
        ("a.wav", {"subtype": "FLOAT"}),
        ("a.wav", {"subtype": "PCM_24"}),
        ("a.flac", {}),
        ("a.ogg", {}),
        ("a.mp3", {}),
        ("a.wav", {"rate": 44100, "channels": 2}),
    ],
)
def test_any_sound_file_will_do(record, swap, name, options):
    motion, _ = swap(record(name, 0.7, **options), "--emotion", "happiness")
    assert len(motion["poses"]) in (20, 21, 22)  # mp3 pads
    assert np.isfinite(motion["poses"]).all()


def test_a_long_file_is_heard_in_windows_and_moves_to_its_end(record, swap):
    motion, report = swap(record(seconds=30), "--emotion", "anger")
    assert (len(motion["poses"]), report["windows"]) == (900, 10)
    assert np.isfinite(motion["poses"]).all()
    assert np.abs(np.diff(motion["poses"][-30:], axis=0)).max() > 0.001


def test_the_report_tells_the_job(record, swap, data):
    motion, report = swap(record(seconds=1.2), "--emotion", "disgust", "--seed", "5")
    assert report["inputs"] == {"speech": {"file": "speech.wav", "seconds": 1.2}}
    assert report["options"] == {"emotion": "disgust", "checkpoints": str(data / "checkpoints")}
    assert (report["seed"], report["windows"]) == (5, 1)
    assert (report["frames"], report["fps"]) == (len(motion["poses"]), 30)
    assert list(report["seconds"]) == [
        *("read the sound", "load the networks", "hear", "gesture", "write"),
    ]
    assert report["versions"]["torch"] == torch.__version__
    assert set(report["wrist_speed"]) == {"source", "edited"}


def test_the_report_says_what_the_speech_sounds_of(record, swap):
    _, report = swap(record(), "--emotion", "disgust")
    assert set(report["recognised_emotion"]) == set(EMOTIONS)
    assert sum(report["recognised_emotion"].values()) == pytest.approx(1)


def test_it_says_everywhere_that_the_sound_stays(record, swap, here, capsys):
    _, report = swap(record(), "--emotion", "surprise")
    page, printed = (here / "out" / "gesture.html").read_text("utf-8"), capsys.readouterr().out
    for told in (report["told"], printed):
        assert "emotion (the mean of surprise). Kept: content and style" in told
        assert "The sound stays the source's" in told
    assert "The sound stays the source&#x27;s" in page


def test_the_page_holds_both_motions_and_asks_nobody(record, swap, here):
    swap(record(), "--emotion", "surprise")
    page = (here / "out" / "gesture.html").read_text("utf-8")
    content = json.loads(re.search(r'id="content">(.*?)</script>', page, re.DOTALL)[1])
    assert content["view"] == "edited"
    assert b'["source", "edited"]' in base64.b64decode(content["motion"])
    assert not re.search(r"https?://", page)


def test_glb_and_bvh_hold_the_same_frames(record, swap, here):
    motion, _ = swap(record(), "--emotion", "anger")
    glb = (here / "out" / "motion.glb").read_bytes()
    scene = json.loads(glb[20 : 20 + int.from_bytes(glb[12:16], "little")])
    assert len(scene["skins"][0]["joints"]) == len(mannequin().joints)
    times = scene["accessors"][scene["animations"][0]["samplers"][0]["input"]]
    assert times["count"] == len(motion["poses"])
    bvh = read_bvh(here / "out" / "motion.bvh")
    assert len(bvh.rotations) == len(motion["poses"])


def test_other_files_are_kept_and_ours_replaced(record, swap, here):
    (here / "out").mkdir()
    (here / "out" / "notes.txt").write_text("mine")
    (here / "out" / "motion.npz").write_text("old")
    motion, _ = swap(record(), "--emotion", "anger")
    assert (here / "out" / "notes.txt").read_text() == "mine"
    assert len(motion["poses"]) == 30


def test_a_clipped_file_is_warned_about_in_one_line_and_used(record, swap, capsys):
    _, report = swap(record(gain=20.0), "--emotion", "anger")
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("warning: speech.wav is clipped")
    assert report["warnings"] == [line.removeprefix("warning: ")]


def test_a_very_long_file_is_warned_about_and_used(record, swap, capsys, monkeypatch):
    monkeypatch.setattr("s2glib.audio.io.LONGEST", 1.0)
    swap(record(seconds=1.5), "--emotion", "anger")
    assert "longer than 30 minutes" in capsys.readouterr().err


def test_generate_gives_the_motion_that_swap_starts_from(record, swap, here, capsys):
    _, swapped = swap(record(), "--emotion", "anger")
    assert main(["generate", "speech.wav", "--system", "amuse", "--out", "plain"]) == 0
    assert {path.name for path in (here / "plain").iterdir()} == FILES
    plain = json.loads((here / "plain" / "report.json").read_text("utf-8"))
    assert plain["wrist_speed"] == {"source": swapped["wrist_speed"]["source"]}
    assert plain["swapped"] == {}


def test_it_runs_as_a_module(record, here):
    words = [sys.executable, "-m", "s2glib", "swap", record(), "--emotion", "anger", "--out", "out"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Wrote motion.npz" in done.stdout
    assert {path.name for path in (here / "out").iterdir()} == FILES


def test_of_very_long_speech_the_page_shows_the_beginning(record, swap, here, capsys, monkeypatch):
    monkeypatch.setattr("s2glib.commands.studio.SHOWN", 1)
    motion, report = swap(record(seconds=1.5), "--emotion", "anger")
    (line,) = capsys.readouterr().err.splitlines()
    assert "gesture.html shows the first 0.0166667 minutes" in line
    assert report["warnings"] == [line.removeprefix("warning: ")]
    page = (here / "out" / "gesture.html").read_text("utf-8")
    content = json.loads(re.search(r'id="content">(.*?)</script>', page, re.DOTALL)[1])
    assert b'"shape": [2, 30, 55, 4]' in base64.b64decode(content["motion"])
    assert len(base64.b64decode(content["sound"])) == 44 + 2 * 16000
    assert "Here gesture.html shows the first" in page
    assert len(motion["poses"]) == 45
