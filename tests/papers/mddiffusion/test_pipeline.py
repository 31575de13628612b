import pytest
import torch
from small_video import SMALL_REFINEMENT

from s2glib.checkpoint import save_checkpoint
from s2glib.papers.mddiffusion import MDDiffusion, RefinementNet

MANY = 37  # more frames than the networks see at once, and no multiple of it


@pytest.fixture
def refiner():
    """One that changes pictures."""
    net = RefinementNet(SMALL_REFINEMENT)
    torch.nn.init.normal_(net.last.weight, std=0.1)
    return net


@pytest.fixture
def model(decoupler, refiner):
    return MDDiffusion(decoupler, refiner)


@pytest.fixture
def film():
    return torch.rand(MANY, 3, 32, 32)


def test_a_film_is_made_frame_by_frame(model, decoupler, refiner, film):
    video = model.reenact(film[0], film)
    with torch.no_grad():
        made = decoupler(film[:1], film[20:21])
        refined = refiner(made.synthesis.image, made.flow.occlusion_masks[-1]).clamp(0, 1)
    assert video.frames.shape == film.shape
    assert video.fps == 25
    torch.testing.assert_close(video.frames[20:21], refined, rtol=0, atol=1e-5)
    torch.testing.assert_close(video.keypoints[20], made.driving_keypoints[0].flatten(0, 1))


def test_without_a_refiner_the_decouplers_picture_stays(decoupler, film):
    video = MDDiffusion(decoupler).reenact(film[0], film[:3])
    with torch.no_grad():
        made = decoupler(film[:1].expand(3, -1, -1, -1), film[:3])
    torch.testing.assert_close(video.frames, made.synthesis.image, rtol=0, atol=1e-5)


def test_the_motion_of_a_film_can_be_given_by_its_keypoints(model, film):
    keypoints = model.keypoints(film)
    assert keypoints.shape == (MANY, 15, 2)
    moved = model.animate(film[5], keypoints)
    assert torch.equal(moved.frames, model.reenact(film[5], film).frames)
    assert moved.frames.min() >= 0
    assert moved.frames.max() <= 1


def test_both_networks_come_from_their_files(tmp_path, decoupler, refiner, film):
    save_checkpoint(tmp_path / "mddiffusion-decoupling.safetensors", decoupler, decoupler.config)
    with pytest.raises(FileNotFoundError, match="mddiffusion-refinement"):
        MDDiffusion.load(tmp_path)
    save_checkpoint(tmp_path / "mddiffusion-refinement.safetensors", refiner, SMALL_REFINEMENT)
    loaded, made = MDDiffusion.load(tmp_path), MDDiffusion(decoupler, refiner)
    assert torch.equal(loaded.reenact(film[0], film[:2]).frames, made.reenact(film[0], film[:2])[0])


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("picture", "kind", "fault"),
    [
        (torch.zeros(3, 64, 64), ValueError, r"\(3, 32, 32\), got \(3, 64, 64\)"),
        (torch.zeros(32, 32, 3), ValueError, r"\(3, 32, 32\), got \(32, 32, 3\)"),
        (torch.zeros(3, 32, 32).double(), TypeError, "float32 tensor, got torch.float64"),
        (torch.zeros(3, 32, 32).byte(), TypeError, "got torch.uint8"),
        (torch.full((3, 32, 32), float("nan")), ValueError, "from 0 to 1"),
        (torch.full((3, 32, 32), 255.0), ValueError, "divide bytes by 255"),
    ],
)
def test_what_is_no_picture_of_the_networks_size_is_refused(model, film, picture, kind, fault):
    with pytest.raises(kind, match=fault):
        model.animate(picture, model.keypoints(film[:1]))
    with pytest.raises(kind, match=fault):
        model.keypoints(picture[None])


@pytest.mark.parametrize("shape", [(4, 14, 2), (4, 3, 5, 2), (15, 2), (4, 15, 3)])
@pytest.mark.usefixtures("without_type_hook")
def test_keypoints_of_another_model_are_refused(model, film, shape):
    with pytest.raises(ValueError, match=r"\(frames, 15, 2\), got"):
        model.animate(film[0], torch.zeros(shape))


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e30, -4.0])
def test_keypoints_that_are_nowhere_near_are_refused(model, film, value):
    keypoints = model.keypoints(film[:2]).clone()
    keypoints[1, 3, 0] = value
    with pytest.raises(ValueError, match="finite and within 3 image units"):
        model.animate(film[0], keypoints)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize("wrong", [None, [1, 2], torch.zeros(2, 15, 2).double()])
def test_what_is_no_tensor_of_single_precision_is_refused(model, film, wrong):
    with pytest.raises(TypeError, match="keypoints must be a float32 tensor"):
        model.animate(film[0], wrong)
    with pytest.raises(TypeError, match="picture must be a float32 tensor"):
        model.animate(wrong, model.keypoints(film[:1]))


def test_a_film_without_frames_is_refused(model):
    with pytest.raises(ValueError, match="0 of them"):
        model.keypoints(torch.zeros(0, 3, 32, 32))
