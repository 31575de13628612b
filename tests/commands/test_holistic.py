"""`generate --system probtalk`: what stands in the folder, and what was kept of another motion."""

import json
import re

import numpy as np
import pytest
import torch
from stand_in import waving_motion

from s2glib.__main__ import main
from s2glib.audio import load
from s2glib.body import mannequin, read_bvh, read_npz, write_npz
from s2glib.commands import arguments
from s2glib.papers.probtalk import JOINTS_OF, PARTS, ProbTalk

FILES = {"motion.npz", "motion.glb", "motion.bvh", "gesture.html", "report.json"}


@pytest.fixture
def generate(here):
    """Run `generate` into the folder `out`, and read what it delivers."""

    def run(*words, out="out"):
        assert main(["generate", *words, "--system", "probtalk", "--out", out]) == 0
        report = json.loads((here / out / "report.json").read_text("utf-8"))
        return read_npz(here / out / "motion.npz"), report

    return run


@pytest.fixture
def kept(here):
    """A motion file to keep something of, and its motion."""
    write_npz(here / "kept.npz", waving_motion(40))
    return read_npz(here / "kept.npz")


def test_the_motion_is_the_pipelines(record, generate, data, here):
    motion, report = generate(record(seconds=1.5), "--seed", "3", "--speaker", "5")
    noise = torch.Generator().manual_seed(3)
    expected = ProbTalk.load(data / "checkpoints").generate(
        load("speech.wav"), speaker=5, generator=noise
    )
    torch.testing.assert_close(motion.poses, expected.poses, rtol=1e-4, atol=1e-4)
    assert motion.frames == 45
    assert {path.name for path in (here / "out").iterdir()} == FILES
    assert (report["system"], report["seed"], report["speaker"]) == ("probtalk", 3, 5)
    assert report["kept"] is None


def test_hands_of_some_frames_are_kept_exactly(record, generate, kept):
    motion, report = generate(
        record(), "--keep", "kept.npz", "--frames", "5:12,20:", "--parts", "hands"
    )
    rows = [*range(5, 12), *range(20, 30)]
    for part in PARTS:
        joints = list(JOINTS_OF[part])
        same = (motion.poses[:, joints] == kept.poses[:30, joints]).all((1, 2)).nonzero()[:, 0]
        assert same.tolist() == (rows if part.endswith("hand") else [])
    assert report["kept"] == {
        "file": "kept.npz",
        "frames": ["5:12", "20:"],
        "parts": ["left_hand", "right_hand"],
    }


def test_without_frames_and_parts_all_is_kept_and_continued(record, generate, kept):
    motion, report = generate(record(seconds=2.0), "--keep", "kept.npz")
    assert torch.equal(motion.poses[:40], kept.poses)
    assert torch.equal(motion.trans[:40], kept.trans)
    assert torch.equal(motion.expression[:40], kept.expression)
    assert motion.frames == 60
    assert report["kept"]["parts"] == list(PARTS)


def test_it_says_everywhere_what_was_kept(record, generate, kept, here, capsys):
    _, report = generate(
        record(), "--keep", "kept.npz", "--frames", ":9", "--parts", "face", "--speaker", "2"
    )
    page, printed = (here / "out" / "gesture.html").read_text("utf-8"), capsys.readouterr().out
    for told in (report["told"], printed, page):
        assert "speaker 2. Kept from kept.npz: face; frames :9." in told
    assert not re.search(r"https?://", page)


def test_glb_and_bvh_hold_the_same_frames(record, generate, here):
    motion, _ = generate(record())
    glb = (here / "out" / "motion.glb").read_bytes()
    scene = json.loads(glb[20 : 20 + int.from_bytes(glb[12:16], "little")])
    assert len(scene["skins"][0]["joints"]) == len(mannequin().joints)
    assert len(read_bvh(here / "out" / "motion.bvh").rotations) == motion.frames


def test_the_report_has_the_speed_and_the_time(record, generate):
    _, report = generate(record())
    assert report["wrist_speed"].keys() == {"generated"}
    assert list(report["seconds"]) == ["read", "load the networks", "gesture", "write"]
    assert (report["frames"], report["fps"]) == (30, 30)


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--keep", "none.npz"), "no motion file at none.npz"),
        (("--keep", "speech.wav"), "no npz"),
        (("--frames", ":5"), "give a motion with --keep"),
        (("--parts", "hands"), "give a motion with --keep"),
        (("--keep", "kept.npz", "--frames", "20:35"), "goes beyond frame 30"),
        (("--keep", "kept.npz", "--frames", "31:"), "goes beyond frame 30"),
        (("--speaker", "24"), "numbered 0 to 23, got 24"),
    ],
)
def test_refusals(record, kept, here, capsys, words, reason):
    assert main(["generate", record(), "--system", "probtalk", "--out", "out", *words]) == 2
    (sentence,) = capsys.readouterr().err.splitlines()
    assert reason in sentence
    assert not (here / "out").exists()


@pytest.mark.parametrize("text", ["a:b", "9:5", "5:5", "-3:5", "30", "1:2:3", ":5,", ""])
def test_frames_that_cannot_be_read_are_refused_with_an_example(record, capsys, text):
    with pytest.raises(SystemExit):
        main(["generate", record(), "--system", "probtalk", "--out", "out", f"--frames={text}"])
    said = capsys.readouterr().err.splitlines()[-1]
    assert "argument --frames: expected frames as a:b with a below b" in said
    assert f"such as 0:60 or :30,90:; got {text!r}" in said


@pytest.mark.parametrize("text", ["legs", "face,", "face body", ""])
def test_parts_that_do_not_exist_are_refused_with_those_that_do(record, capsys, text):
    with pytest.raises(SystemExit):
        main(["generate", record(), "--system", "probtalk", "--out", "out", f"--parts={text}"])
    said = capsys.readouterr().err.splitlines()[-1]
    assert "argument --parts: expected one or several of face, body, left_hand" in said
    assert f"hands, all, with commas; got {text!r}" in said


def test_keeping_is_for_probtalk_only(record, kept, capsys):
    words = ["--system", "amuse", "--out", "out", "--keep", "kept.npz"]
    assert main(["generate", record(), *words]) == 2
    assert "--keep is for --system probtalk only" in capsys.readouterr().err


def test_the_parts_have_the_order_of_the_masks():
    assert arguments.PARTS == PARTS
    assert arguments.part_names("right_hand, face") == ["face", "right_hand"]
    assert arguments.part_names("all") == list(PARTS)


def test_frames_are_read_as_slices():
    spans = arguments.frame_spans(":30, 60:90,120:")
    assert spans == [slice(None, 30), slice(60, 90), slice(120, None)]
    assert np.arange(200)[spans[1]].tolist() == [*range(60, 90)]
