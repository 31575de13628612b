"""The larger video model on small networks: what it begins with, and that its stage runs."""

import json
from dataclasses import replace

import numpy as np
import pytest
import torch
from small_video import SMALL_DECOUPLING, SMALL_REFINEMENT, noise_film

from s2glib.checkpoint import save_checkpoint
from s2glib.layers import shrink
from s2glib.papers.mddiffusion import MDDiffusion, MotionDecoupler, RefinementNet
from s2glib.recipes import Course, Stage, footage
from s2glib.recipes import mddiffusion_128 as larger

CONFIG = replace(SMALL_DECOUPLING, size=64, keypoint_size=32)
COURSE = Course(steps=1, batch=2, learning_rate=1e-3, warm_up=1)


@pytest.fixture
def small():
    torch.manual_seed(0)
    return MotionDecoupler(SMALL_DECOUPLING).eval()


def test_it_begins_with_all_that_the_smaller_one_knows(small):
    model, known = larger.enlarged(small, CONFIG), small.state_dict()
    now = model.state_dict()
    for name in known:
        if not name.startswith("flow.masks"):
            assert torch.equal(now[name], known[name])
    assert SMALL_DECOUPLING.mask_sizes == (8, 16, 32)
    assert CONFIG.mask_sizes == (16, 32, 64)
    for old, new in ((1, 0), (2, 1)):
        for part in ("weight", "bias"):
            name = f"flow.masks.{{}}.{part}"
            assert torch.equal(now[name.format(new)], known[name.format(old)])


def test_it_finds_the_keypoints_that_the_smaller_one_finds_on_a_smaller_picture(small):
    picture = torch.rand(2, 3, 64, 64)
    model = larger.enlarged(small, CONFIG).eval()
    assert torch.equal(model.keypoints(picture), small.keypoints(shrink(picture, 2)))


@pytest.fixture
def short(monkeypatch, rng):
    """The stage with one step on small networks and films of noise."""

    def noise(shots, size):
        return [noise_film(rng, size) for _ in shots]

    monkeypatch.setattr(footage, "films", noise)
    monkeypatch.setattr(larger, "CONFIG", CONFIG)
    for lesson in ("DECOUPLING", "REFINEMENT"):
        monkeypatch.setattr(larger, lesson, replace(getattr(larger, lesson), course=COURSE))


def test_its_stage_leaves_two_checkpoints_beside_the_smaller_ones(tmp_path, short, small):
    folder = tmp_path / "checkpoints"
    folder.mkdir()
    for name, model in (("decoupling", small), ("refinement", RefinementNet(SMALL_REFINEMENT))):
        path = folder / f"mddiffusion-{name}.safetensors"
        save_checkpoint(path, model, model.config, metadata={})
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    larger.train(Stage("mddiffusion-128", tmp_path))
    assert {name: (folder / name).read_bytes() for name in before} == before
    model = MDDiffusion.load(folder, size=128)
    assert model.decoupler.config == CONFIG
    assert model.refiner.config == SMALL_REFINEMENT
    for part, figures in (("decoupling", 4), ("refinement", 6)):
        path = tmp_path / "runs" / f"mddiffusion-{part}-128-teaching-0.json"
        found = json.loads(path.read_text())["figures"]
        assert len(found) == figures
        assert np.isfinite(list(found.values())).all()


def test_without_the_smaller_networks_it_says_which_file_is_missing(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"mddiffusion-decoupling\.safetensors"):
        larger.train(Stage("mddiffusion-128", tmp_path))


@pytest.mark.parametrize("size", [100, "128", None])
def test_there_are_no_networks_of_other_sizes(tmp_path, size):
    with pytest.raises(ValueError, match="for 64 or 128 pixels, got size="):
        MDDiffusion.load.__wrapped__(MDDiffusion, tmp_path, size=size)
