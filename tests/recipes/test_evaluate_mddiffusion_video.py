import json

import numpy as np
import pytest
import torch
from small_video import SMALL_DECOUPLING, SMALL_REFINEMENT, noise_film

from s2glib.papers.mddiffusion import (
    KeypointPredictor,
    MDDiffusion,
    MotionDecoupler,
    RefinementNet,
)
from s2glib.recipes import evaluate_mddiffusion_video as module
from s2glib.recipes.evaluate_mddiffusion_video import (
    ablation_rows,
    error_rows,
    generalisation_rows,
    larger_rows,
    wrist_rows,
)
from s2glib.recipes.video_data import VideoFrames
from s2glib.recipes.video_scores import Errors, RegionErrors

MOVING, HAND, FACE = (
    Errors(*(np.array([k, k]) for k in ks))
    for ks in ((6.0, 5.0, 7.0, 10.0, 8.0), (4.0, 3.0, 9.0, 8.0, 9.0), (2.0, 1.0, 3.0, 4.0, 5.0))
)


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


def test_errors_are_compared_region_by_region():
    values = {row.name: row.value for row in error_rows(RegionErrors(MOVING, HAND, FACE))}
    assert values == pytest.approx(
        {
            "moving region / copied, refined": 0.5,
            "moving region / copied, decoupler": 0.6,
            "moving region / copied, bent only": 0.7,
            "moving region / copied, mean frame": 0.8,
            "hand region / copied, refined": 3 / 8,
            "hand region, refined / decoupler": 3 / 4,
            "face region / copied, refined": 1 / 4,
            "face region, refined / decoupler": 1 / 2,
        }
    )


def test_the_gain_of_training_is_what_the_untrained_network_lacks(rng):
    video = VideoFrames([noise_film(rng) for _ in range(3)])
    untold, told = KeypointPredictor(SMALL_DECOUPLING), KeypointPredictor(SMALL_DECOUPLING)
    after, before, gain, with_labels = wrist_rows(untold, told, video, video)
    assert gain.value == pytest.approx(after.value - before.value)
    assert len({after.value, before.value, with_labels.value}) == 3


def test_the_same_gestures_are_filmed_in_three_looks(rng, monkeypatch):
    shot = []

    def films(shots, size):
        shot.append(shots)
        return [noise_film(rng) for _ in shots]

    monkeypatch.setattr(module, "films", films)
    rows = generalisation_rows(MotionDecoupler(SMALL_DECOUPLING), RefinementNet(SMALL_REFINEMENT))
    assert len(rows) == len(shot) == 3
    assert len({tuple(one.cell for one in shots) for shots in shot}) == 1
    assert {one.appearance.name for one in shot[0]} == {"voice_01/a", "voice_01/b"}
    assert [{one.appearance.name for one in shots} for shots in shot[1:]] == [
        {"voice_01/c"},
        {"portrait"},
    ]


def test_larger_pictures_have_the_same_rows_under_another_name(rng, monkeypatch):
    monkeypatch.setattr(module, "films", lambda shots, size: [noise_film(rng, size)] * 2)
    decoupler, refiner = MotionDecoupler(SMALL_DECOUPLING), RefinementNet(SMALL_REFINEMENT)
    found = {row.name: row for row in larger_rows(MDDiffusion(decoupler, refiner))}
    plain = [row.name for row in error_rows(RegionErrors(MOVING, HAND, FACE))]
    assert list(found) == [f"32 px: {name}" for name in plain]
    assert found["32 px: moving region / copied, bent only"].value > 0


def test_recorded_runs_are_compared_seed_by_seed(tmp_path):
    for seed in range(3):
        figures = dict.fromkeys(["one speaker: moving", "four speakers: moving"], 1.0 + seed)
        for kind, level in (("splines", 0.5), ("affine", 0.8)):
            for how, share in (("", 1.0), (", refined", 0.9)):
                for region in ("moving", "hand", "face"):
                    figures[f"{kind}{how}: {region}"] = level * share * (1 + seed)
        record = {"figures": figures}
        (tmp_path / f"mddiffusion-ablation-teaching-{seed}.json").write_text(json.dumps(record))
    rows = {row.name: row for row in ablation_rows(tmp_path)}
    assert all(row.recorded and row.n == 3 for row in rows.values())
    assert rows["short runs: hand, splines / affine"].value == pytest.approx(5 / 8)
    assert rows["short runs: face, affine, refined / not"].value == pytest.approx(0.9)
    assert rows["short runs: four speakers / one"].interval == (1.0, 1.0)


def test_without_a_record_it_says_how_to_make_one(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no record of mddiffusion-ablation .*--retrain"):
        ablation_rows(tmp_path)
