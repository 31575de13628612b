"""What the command line does not do: one sentence, exit code 2, nothing half-written."""

import contextlib
import errno
import io
import shutil
import subprocess
import sys
import tempfile
from dataclasses import replace

import numpy as np
import pytest
import soundfile
from hypothesis import given
from hypothesis import strategies as st
from safetensors import safe_open
from safetensors.torch import load_file, save_file

from s2glib.__main__ import main
from s2glib.checkpoint import save_checkpoint
from s2glib.papers.amuse.config import TEACHING_DENOISER
from s2glib.papers.amuse.latent_denoiser import LatentDenoiser


@pytest.fixture
def refused(here, capsys):
    """Run, and return the one sentence of a refusal that left the folder as it was."""

    def run(*arguments):
        before = sorted(here.rglob("*"))
        assert main(arguments) == 2
        (sentence,) = capsys.readouterr().err.splitlines()
        assert sorted(here.rglob("*")) == before
        return sentence

    return run


def with_nan(samples):
    samples[100] = np.nan
    return samples


SOUNDS = {
    "empty": (np.zeros(0), "is empty"),
    "short": (0.1 * np.ones(3200), "shorter than 0.5 s"),
    "silent": (0.0009 * np.sin(np.arange(16000)), "is silent"),
    "NaN": (with_nan(0.1 * np.ones(16000)), "NaN or Inf"),
}


@pytest.mark.parametrize("kind", SOUNDS)
@pytest.mark.parametrize("place", ["speech", "--emotion-from", "--style-from"])
def test_sound_that_cannot_be_used(record, refused, kind, place):
    samples, reason = SOUNDS[kind]
    soundfile.write("bad.wav", samples, 16000, "FLOAT")
    words = ["bad.wav", "--emotion", "anger"] if place == "speech" else [record(), place, "bad.wav"]
    sentence = refused("swap", *words, "--out", "out")
    assert "bad.wav" in sentence
    assert reason in sentence


def test_files_that_are_no_sound(here, refused):
    assert "no sound file at none.wav" in refused("swap", "none.wav", *EDIT)
    (here / "text.wav").write_text("This is a letter, not a sound.")
    assert "text.wav cannot be read as sound" in refused("swap", "text.wav", *EDIT)
    (here / "folder.wav").mkdir()
    assert "folder.wav" in refused("swap", "folder.wav", *EDIT)


EDIT = ("--emotion", "anger", "--out", "out")


def test_an_unknown_emotion_is_answered_with_the_eight(record, refused):
    sentence = refused("swap", record(), "--emotion", "joy", "--out", "out")
    assert "'joy'; choose one of neutral, happiness, anger, sadness" in sentence


def test_nothing_to_swap(record, refused):
    assert "nothing to swap" in refused("swap", record(), "--out", "out")


def test_a_system_that_is_not_built(record, refused):
    sentence = refused("generate", record(), "--system", "mddiffusion", "--out", "out")
    assert "mddiffusion is not built yet" in sentence


@pytest.mark.parametrize("out", ["file", "file/below", "file/far/below"])
def test_an_output_at_or_below_a_file(here, record, refused, out):
    (here / "file").write_text("mine")
    assert "file is a file" in refused("swap", record(), "--emotion", "anger", "--out", out)


def test_an_output_where_a_folder_stands_in_the_way(here, record, refused):
    (here / "out" / "motion.glb").mkdir(parents=True)
    assert "motion.glb is a folder" in refused("swap", record(), *EDIT)


def test_an_output_that_cannot_be_written(record, refused, monkeypatch):
    def forbid(*_):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(tempfile, "mkdtemp", forbid)
    assert "cannot write to out (Permission denied)" in refused("swap", record(), *EDIT)


def test_a_disk_that_is_full_leaves_the_old_files(here, record, refused, monkeypatch):
    def fill(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    (here / "out").mkdir()
    (here / "out" / "motion.npz").write_text("old")
    monkeypatch.setattr("s2glib.commands.studio.write_bvh", fill)
    assert "cannot write to out (No space left on device)" in refused("swap", record(), *EDIT)
    assert (here / "out" / "motion.npz").read_text() == "old"


@pytest.fixture
def networks(data, here):
    """A copy of the networks to damage."""
    return shutil.copytree(data / "checkpoints", here / "networks")


def truncated(path):
    path.write_bytes(path.read_bytes()[:-1000])


def foreign(path):
    save_file(load_file(path), path)


def of_another_class(path):
    shutil.copy(path.with_name("amuse-prior.safetensors"), path)


def of_another_shape(path):
    with safe_open(path, "pt") as file:
        header = file.metadata()
    tensors = load_file(path)
    save_file(tensors | {"out.bias": tensors["out.bias"][:-1].clone()}, path, header)


def of_another_training(path):
    config = replace(TEACHING_DENOISER, emotion_dim=16)
    save_checkpoint(path, LatentDenoiser(config), config)


def missing(path):
    path.unlink()


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (truncated, "not a whole safetensors file"),
        (foreign, "has the format None"),
        (of_another_class, "holds a MotionPrior, not a LatentDenoiser"),
        (of_another_shape, "out.bias has the shape"),
        (of_another_training, "content, emotion and style latents differ"),
        (missing, "no checkpoint file"),
    ],
)
def test_networks_that_cannot_be_used(record, refused, networks, damage, reason):
    damage(networks / "amuse-denoiser.safetensors")
    words = ("--checkpoints", "networks")
    assert reason in refused("swap", record(), *EDIT, *words)
    assert reason in refused("generate", record(), "--system", "amuse", "--out", "out", *words)


def test_no_networks_at_all(record, refused):
    sentence = refused("swap", record(), *EDIT, "--checkpoints", "nowhere")
    assert "no folder nowhere with trained networks" in sentence


def test_a_refusal_as_a_reader_meets_it(here):
    words = [sys.executable, "-m", "s2glib", "swap", "none.wav", *EDIT]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "s2glib swap: there is no sound file at none.wav; check the path\n"
    assert not list(here.iterdir())


WORDS = st.sampled_from(
    [
        *("swap", "generate", "none.wav", "--emotion", "anger", "--emotion-from", "--style-from"),
        *("--out", "out", "--seed", "-1", "7", "--system", "amuse", "--checkpoints", "", "\0"),
    ]
)


@given(words=st.lists(WORDS, max_size=9))
def test_whatever_is_typed_ends_with_one_sentence(words, tmp_path_factory):
    err = io.StringIO()
    with contextlib.redirect_stderr(err):
        try:
            code = main(words)
        except SystemExit as leave:
            code = leave.code
    assert code == 2
    assert err.getvalue().count("\n") == 1
    assert err.getvalue().startswith("s2glib")
