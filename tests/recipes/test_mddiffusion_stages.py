"""Both stages of the video model on small networks and made-up films."""

import json
from dataclasses import replace

import numpy as np
import pytest
import torch
from film_folder import write_film
from small_video import SMALL_DECOUPLING, SMALL_REFINEMENT, noise_film

from s2glib.checkpoint import load_checkpoint, read_metadata
from s2glib.layers import PyramidFeatures
from s2glib.papers.mddiffusion import (
    KeypointPredictor,
    MotionDecoupler,
    PatchDiscriminator,
    RefinementNet,
    label_error,
)
from s2glib.recipes import Chance, Course, Stage, Training, footage
from s2glib.recipes import mddiffusion_ablation as ablation
from s2glib.recipes import mddiffusion_decoupling as decoupling
from s2glib.recipes import mddiffusion_refinement as refinement
from s2glib.recipes import mddiffusion_unlabelled as unlabelled
from s2glib.recipes.limb_points import ALONG, LIMBS, limb_points, mirrored_keypoints
from s2glib.recipes.video_data import VideoFrames

COURSE = Course(steps=3, batch=4, learning_rate=1e-3, warm_up=1)
LESSON = replace(decoupling.LESSONS["teaching"], course=COURSE)
ROWS = np.arange(36)
REPAIR = replace(refinement.LESSONS["teaching"], course=COURSE)


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.fixture
def video(rng):
    return VideoFrames([noise_film(rng) for _ in range(3)])


@pytest.fixture
def repair():
    return refinement.RefinementObjective(
        RefinementNet(SMALL_REFINEMENT),
        PatchDiscriminator(SMALL_REFINEMENT),
        MotionDecoupler(SMALL_DECOUPLING),
        PyramidFeatures(2),
        {},
    )


def chance(progress=0.0, seed=0):
    return Chance(np.random.default_rng(seed), torch.Generator().manual_seed(seed), progress)


def moved_by_training(objective, draw):
    """Names of the values that three steps changed; losses stay finite."""
    before = {name: value.clone() for name, value in objective.state_dict().items()}
    losses = [log.loss for log in Training(objective, COURSE).run(draw)]
    assert np.isfinite(losses).all()
    now = objective.state_dict()
    return {name for name, value in before.items() if not torch.equal(now[name], value)}


def test_the_decoupler_trains_every_part(video):
    objective = decoupling.DecouplingObjective(
        MotionDecoupler(SMALL_DECOUPLING), PyramidFeatures(2), LESSON.weights
    )
    moved = moved_by_training(objective, lambda c: decoupling.draw(video, LESSON, False, c))
    assert {name for name, _ in objective.named_parameters()} <= moved


def test_refinement_trains_both_networks_and_leaves_the_decoupler_alone(video, repair):
    moved = moved_by_training(repair, lambda c: refinement.draw(video, REPAIR, c))
    trained = {name for name, p in repair.named_parameters() if p.requires_grad}
    assert {name.split(".")[0] for name in trained} == {"model", "discriminator"}
    assert trained <= moved
    assert not {name for name in moved if name.startswith("decoupler")}


def test_each_network_learns_from_its_own_loss_only(video, repair):
    _, terms = repair(refinement.draw(video, REPAIR, chance()))
    for term, learner, other in (
        ("adversarial", repair.model, repair.discriminator),
        ("discriminator", repair.discriminator, repair.model),
    ):
        for network, reached in ((learner, True), (other, False)):
            slopes = torch.autograd.grad(
                terms[term], list(network.parameters()), retain_graph=True, allow_unused=True
            )
            assert any(slope is not None for slope in slopes) is reached


def test_a_step_counts_the_moving_quarter_more(video):
    step = decoupling.draw(video, LESSON, False, chance())
    assert step.labels is None
    assert decoupling.draw(video, LESSON, False, chance(progress=0.1)).dropout == 0.5
    assert set(step.weight.unique().tolist()) == {1.0, 7.0}
    assert step.source.shape == step.driving.shape == (4, 3, 32, 32)
    assert len(step.bend.affine) == 4


def test_a_step_of_refinement_has_the_masks_of_its_driving_picture(video):
    step = refinement.draw(video, REPAIR, chance())
    rows = video.pairs(4, np.random.default_rng(0), furthest=12).driving
    assert torch.equal(step.driving, video.images(rows))
    assert torch.equal(step.hand, video.hands(rows))
    assert torch.equal(step.face, video.faces(rows))


def test_labels_are_mirrored_with_their_pictures(video):
    step = decoupling.draw(video, LESSON, True, chance(progress=0.1))
    assert step.dropout == 0.0
    rows = video.pairs(4, np.random.default_rng(0), furthest=12).driving
    plain = limb_points(video.keypoints[rows])
    mirrored = limb_points(mirrored_keypoints(video.keypoints[rows]))
    same, other = (
        torch.isclose(step.labels, labels).flatten(1).all(1) for labels in (plain, mirrored)
    )
    assert (same ^ other).all()
    assert same.any()
    assert other.any()


def test_where_labels_are_known_keypoints_go_there_first(tmp_path, video):
    config = replace(SMALL_DECOUPLING, transforms=len(LIMBS), points=len(ALONG))
    lesson = replace(LESSON, labelled=replace(COURSE, steps=40))
    stage = Stage("mddiffusion-decoupling", tmp_path, steps=10)
    assert decoupling.has_labels(video, config)
    model, record = decoupling.fit_decoupler(stage, "some", config, lesson, video)
    errors = [point["labelled"] for point in record["labels"]["curve"]]
    assert len(errors) == 1
    assert np.isfinite(errors).all()
    assert record["labels"]["course"]["steps"] == 40
    torch.manual_seed(0)
    start = MotionDecoupler(config).keypoints
    start.start_at(decoupling.first_keypoints(video, config, True, 0))
    before, after = (
        label_error(each.eval()(video.images(ROWS)), limb_points(video.keypoints[ROWS])).item()
        for each in (start, model.keypoints)
    )
    assert after < before


def test_films_without_keypoints_have_no_labels(video):
    config = replace(SMALL_DECOUPLING, transforms=len(LIMBS), points=len(ALONG))
    assert not decoupling.has_labels(video, SMALL_DECOUPLING)
    video.keypoints[:] = torch.nan
    assert not decoupling.has_labels(video, config)


@pytest.mark.parametrize(("progress", "frames"), [(0.0, 10), (0.2, 32), (0.4, 100), (1.0, 100)])
def test_frames_may_lie_further_apart_as_training_goes_on(progress, frames):
    assert decoupling.reach(LESSON, progress, 100) == frames
    assert decoupling.reach(replace(LESSON, near=None), progress, 100) == 100


@pytest.mark.parametrize(
    ("progress", "share"), [(0.0, 0.0), (0.025, 0.25), (0.05, 0.5), (0.17, 0.5), (0.175, 0.0)]
)
def test_warps_drop_out_at_first_and_not_later(progress, share):
    assert decoupling.warp_dropout(progress) == pytest.approx(share)


def test_without_vgg_pictures_are_compared_by_colours_and_edges(tmp_path, monkeypatch):
    monkeypatch.setenv("S2G_CACHE", str(tmp_path))
    for recipe in (decoupling, refinement):
        assert isinstance(recipe.picture_features("paper"), PyramidFeatures)
        assert isinstance(recipe.picture_features("teaching"), PyramidFeatures)


@pytest.fixture
def short(monkeypatch, rng):
    """Stages of a step or two on small networks and films of noise."""
    for recipe, lesson, config, presets in (
        (decoupling, LESSON, SMALL_DECOUPLING, "DECOUPLING_PRESETS"),
        (refinement, REPAIR, SMALL_REFINEMENT, "REFINEMENT_PRESETS"),
    ):
        monkeypatch.setitem(recipe.LESSONS, "teaching", lesson)
        monkeypatch.setitem(getattr(recipe, presets), "teaching", config)
    monkeypatch.setitem(ablation.DECOUPLING_PRESETS, "teaching", SMALL_DECOUPLING)
    for module in (footage, ablation):
        monkeypatch.setattr(module, "films", lambda shots, size: [noise_film(rng) for _ in shots])


def test_both_stages_run_and_leave_their_checkpoints(tmp_path, short):
    decoupling.train(Stage("mddiffusion-decoupling", tmp_path, steps=1))
    refinement.train(Stage("mddiffusion-refinement", tmp_path, steps=1))
    checkpoints = tmp_path / "checkpoints"
    load_checkpoint(checkpoints / "mddiffusion-decoupling.safetensors", MotionDecoupler)
    load_checkpoint(checkpoints / "mddiffusion-refinement.safetensors", RefinementNet)
    run = json.loads((tmp_path / "runs" / "mddiffusion-decoupling-teaching-0.json").read_text())
    assert set(run["figures"]) == {"made / copied", "warped / copied", "mean / copied", "wrists R2"}
    assert np.isfinite(list(run["figures"].values())).all()


def test_without_labels_only_the_keypoint_predictor_is_kept(tmp_path, short, monkeypatch):
    monkeypatch.setattr(unlabelled, "CONFIG", SMALL_DECOUPLING)
    unlabelled.train(Stage("mddiffusion-unlabelled", tmp_path, steps=1))
    kept = tmp_path / "checkpoints" / "mddiffusion-unlabelled.safetensors"
    assert load_checkpoint(kept, KeypointPredictor).config == SMALL_DECOUPLING
    run = json.loads((tmp_path / "runs" / "mddiffusion-unlabelled-teaching-0.json").read_text())
    assert "labels" not in run
    assert set(run["figures"]) == {"made / copied", "hand: made / copied", "wrists R2"}


@pytest.fixture
def own(tmp_path, rng):
    """Run both stages on two films of noise with what is given beside the frames."""

    def run(**given):
        folder = tmp_path / "own"
        for name in ("a", "b"):
            write_film(folder / name, noise_film(rng).frames, **given)
        for recipe, stage in ((decoupling, "decoupling"), (refinement, "refinement")):
            recipe.train(Stage(f"mddiffusion-{stage}", tmp_path, steps=1, data=folder))
        return (
            read_metadata(tmp_path / "checkpoints" / f"mddiffusion-{stage}.safetensors")
            for stage in ("decoupling", "refinement")
        )

    return run


def test_on_films_of_ones_own_all_is_measured_that_is_known(short, own, rng):
    hands = rng.random((12, 32, 32)) < 0.2
    first, second = own(hands=hands, face=~hands, keypoints=rng.uniform(2, 30, (12, 55, 2)))
    assert first["data"] == second["data"] == "own"
    assert first["figures"].keys() == {
        *("made / copied", "warped / copied", "mean / copied", "wrists R2")
    }
    assert second["figures"].keys() == {
        f"{region}, {name} / copied"
        for region in ("moving", "hand", "face")
        for name in ("made", "refined")
    }
    assert np.isfinite([*first["figures"].values(), *second["figures"].values()]).all()


def test_on_films_without_masks_and_keypoints_only_what_moves_is_measured(short, own):
    first, second = own()
    assert first["figures"].keys() == {"made / copied", "warped / copied", "mean / copied"}
    assert second["figures"].keys() == {"moving, made / copied", "moving, refined / copied"}


def test_the_ablation_leaves_one_record_of_all_its_runs(tmp_path, short):
    ablation.train(Stage(ablation.STAGE, tmp_path, steps=ablation.STEPS // 200))
    run = json.loads((tmp_path / "runs" / "mddiffusion-ablation-teaching-0.json").read_text())
    assert run["steps"] == ablation.STEPS // 200
    assert np.isfinite(list(run["figures"].values())).all()
    kinds = {f"{kind}{how}" for kind in ("splines", "affine") for how in ("", ", refined")}
    named = {f"{kind}: {region}" for kind in kinds for region in ("moving", "hand", "face")}
    assert set(run["figures"]) == named | {"one speaker: moving", "four speakers: moving"}
    assert run["figures"]["splines: hand"] != run["figures"]["affine: hand"]
    assert not list((tmp_path / "runs").glob("*splines*"))
