import json
from dataclasses import replace

import numpy as np
import pytest
import torch

from s2glib.body import REST_JOINTS, joint
from s2glib.checkpoint import save_checkpoint
from s2glib.corpus import Cell
from s2glib.papers.probtalk import PQVAE, TEACHING_PQVAE, HolisticFeatures
from s2glib.recipes import code_scores as scores
from s2glib.recipes.holistic_data import HolisticClips, Tracks

NARROW = replace(TEACHING_PQVAE, frames=24, widths=(8, 8, 8, 8), straight=0, latent=8, codes=5)
CELLS = [Cell(0, "voice_01", "anger", take) for take in range(3)]


@pytest.fixture
def model():
    torch.manual_seed(0)
    return PQVAE(NARROW).eval()


@pytest.fixture
def clips():
    """Three clips: one shorter than a window, one as long, one longer."""
    torch.manual_seed(1)
    return HolisticClips(CELLS, Tracks(torch.randn(n, 288) for n in (11, 24, 40)))


def test_frames_held_after_a_clips_end_do_not_count(clips):
    motion, real = scores.held_out(clips, 24)
    assert motion.shape == (3, 24, 288)
    assert real.sum(1).tolist() == [11, 24, 24]
    values = torch.where(real, torch.arange(3.0)[:, None], torch.nan).nan_to_num(99)
    assert scores.mean_where(real, values).tolist() == [0, 1, 2]


def test_a_shoulder_off_by_an_angle_moves_the_wrist_by_its_chord(model):
    poses = torch.zeros(1, 8, 55, 3)
    off = poses.clone()
    off[..., joint("left_shoulder"), 2] = 0.2
    features = HolisticFeatures(12)
    motion, made = (features.from_motion(p, torch.zeros(1, 8, 100)) for p in (poses, off))
    arm = REST_JOINTS[joint("left_wrist")] - REST_JOINTS[joint("left_shoulder")]
    chord = 2 * np.sin(0.1) * np.hypot(*arm[:2])
    found = scores.wrist_distance(model, motion, made)
    torch.testing.assert_close(found, torch.full((1, 8), chord / 2).float(), atol=1e-6, rtol=1e-4)


def test_parts_are_weighed_as_in_the_loss(model):
    for part, weight in (("jaw", 0.1), ("body", 0.4), ("hands", 0.4), ("expression", 0.1)):
        made = torch.zeros(2, 3, 288)
        made[..., model.features.parts[part]] = 2.0
        error = scores.part_error(model, torch.zeros(2, 3, 288), made)
        torch.testing.assert_close(error, torch.full((2, 3), 2 * weight))


def test_usage_is_one_where_all_codes_occur_alike_and_least_where_one_does_it_all():
    codes = torch.stack([torch.arange(40) % 5, torch.zeros(40).long()], dim=1)
    assert scores.code_usage(codes, 5) == pytest.approx([1.0, 0.2])


def test_scores_are_those_of_decoded_codes(model, clips):
    found = scores.code_scores(model, clips)
    motion = clips.first(24)
    made = model(motion).motion.detach()
    distance = scores.wrist_distance(model, motion, made)
    assert found.wrist[1:] == pytest.approx(100 * distance[1:].mean(1).numpy(), rel=1e-4)
    assert found.wrist[0] == pytest.approx(100 * float(distance[0, :11].mean()), rel=1e-4)
    assert found.usage.shape == (4,)


def test_rows_come_from_the_checkpoint_and_the_test_clips(model, clips, tmp_path, monkeypatch):
    save_checkpoint(tmp_path / "probtalk-pqvae.safetensors", model, NARROW)
    monkeypatch.setattr(scores, "holistic_clips", lambda cells, features: clips)
    rows = {row.name: row for row in scores.code_rows(tmp_path)}
    expected = scores.code_scores(model, clips)
    assert rows["codes: wrist error, cm"].value == pytest.approx(expected.wrist.mean())
    least = rows["codes: perplexity / codes, least used group"].value
    assert least == pytest.approx(expected.usage.min())
    assert least == min(rows[f"codes: perplexity / codes, group {g}"].value for g in range(1, 5))
    assert all(row.n == 3 for row in rows.values())


def test_without_a_checkpoint_there_are_no_rows(tmp_path):
    with pytest.raises(FileNotFoundError, match="probtalk-pqvae"):
        scores.code_rows(tmp_path)


def test_recorded_runs_are_compared_seed_by_seed(tmp_path):
    for seed, (product, plain) in enumerate([(1.0, 2.0), (3.0, 4.0), (1.0, 1.0)]):
        figures = {
            f"{name}: {what}": value
            for name, value in (("PQ 4 x 128", product), ("VQ 128", plain))
            for what in ("wrist error, cm", "part-wise error")
        }
        path = tmp_path / f"probtalk-codes-teaching-{seed}.json"
        path.write_text(json.dumps({"figures": figures}))
    rows = {row.name: row for row in scores.study_rows(tmp_path)}
    worst = rows["short runs: wrist error, cm, PQ / VQ, equal memory, worst seed"]
    assert worst.value == 1.0
    row = rows["short runs: wrist error, cm, PQ / VQ, equal memory"]
    assert row.value == pytest.approx((0.5 + 0.75 + 1) / 3)
    assert row.interval == (0.5, 1.0)
    assert row.recorded
    assert rows["short runs: VQ 128: wrist error, cm"].value == pytest.approx(7 / 3)


@pytest.mark.parametrize("seeds", [0, 2])
def test_with_fewer_than_three_seeds_there_is_no_study(tmp_path, seeds):
    for seed in range(seeds):
        (tmp_path / f"probtalk-codes-teaching-{seed}.json").write_text('{"figures": {}}')
    with pytest.raises(FileNotFoundError, match=f"3 seeds of probtalk-codes .* found {seeds}"):
        scores.study_rows(tmp_path)
