import pytest
import torch

from s2glib.papers.mddiffusion import PAPER_DECOUPLING, Flow, ImageSynthesizer
from s2glib.papers.mddiffusion.image_synthesis import warp_and_mask
from s2glib.warping import coordinate_grid, warp_features


def convolution(inputs, outputs, kernel):
    return inputs * outputs * kernel**2 + outputs


def flow_of(config, shift=0.0, visible=1.0):
    """The identity, shifted to the right in the source, everything as visible as told."""
    size = config.flow_size
    grid = (coordinate_grid(size, size) + torch.tensor([shift, 0.0])).expand(2, size, size, 2)
    masks = [torch.full((2, 1, s, s), visible) for s in config.mask_sizes]
    return Flow(grid, torch.ones(2, 1, size, size), grid[:, None], masks)


@pytest.fixture
def synthesizer(config):
    return ImageSynthesizer(config)


def test_the_papers_network_has_the_released_widths():
    """Down 64-128-256-512; two residual blocks at 512, 512 and 256; up to 256, 128, 64."""
    with torch.device("meta"):
        synthesizer = ImageSynthesizer(PAPER_DECOUPLING)
    resampling = [(64, 128), (128, 256), (256, 512), (512, 256), (512, 128), (256, 64)]
    expected = convolution(3, 64, 7) + 2 * 64 + convolution(64, 3, 7)
    expected += sum(convolution(*pair, 3) + 2 * pair[1] for pair in resampling)
    expected += sum(2 * 2 * (convolution(w, w, 3) + 2 * w) for w in (512, 512, 256))
    assert sum(p.numel() for p in synthesizer.parameters()) == expected == 24_737_283


def test_the_papers_picture_has_256_pixels():
    with torch.device("meta"):
        made = ImageSynthesizer(PAPER_DECOUPLING)(
            torch.zeros(2, 3, 256, 256), flow_of(PAPER_DECOUPLING)
        )
    assert made.image.shape == made.warped.shape == (2, 3, 256, 256)


def test_what_is_visible_is_the_warped_source(config, synthesizer, images):
    flow = flow_of(config, shift=0.3)
    made = synthesizer(images[0], flow)
    torch.testing.assert_close(made.image, made.warped)
    torch.testing.assert_close(made.warped, warp_features(images[0], flow.sampling_grid))
    identity = synthesizer(images[0], flow_of(config))
    torch.testing.assert_close(identity.image, images[0], atol=1e-5, rtol=0)


def test_what_is_hidden_is_painted_without_a_look_at_the_source(config, synthesizer, images):
    hidden = flow_of(config, visible=0.0)
    here, there = (synthesizer(x, hidden).image for x in images)
    torch.testing.assert_close(here, there)
    assert ((here > 0) & (here < 1)).all()


def test_half_visible_is_half_painted(config, synthesizer, images):
    flow = flow_of(config, visible=0.5)
    made = synthesizer(images[0], flow)
    painted = 2 * made.image - made.warped
    assert ((painted > -1e-5) & (painted < 1 + 1e-5)).all()
    assert not torch.allclose(painted, made.warped, atol=0.05)


def test_features_come_coarse_to_fine(config, synthesizer, images):
    assert [tuple(f.shape[1:]) for f in synthesizer.encode(images[0])] == [
        (16, 8, 8), (8, 16, 16), (4, 32, 32)
    ]  # fmt: skip


def test_features_of_a_picture_are_its_own_unmoved(config, synthesizer, images):
    flow = flow_of(config, visible=0.7)
    driving = synthesizer.masked_features(images[0], flow)
    warped = warp_and_mask(synthesizer(images[0], flow).features, flow)
    for f, w in zip(driving, warped, strict=True):
        torch.testing.assert_close(f, w, atol=1e-4, rtol=0)
        assert not f.requires_grad


def test_masks_multiply_warped_features(config, synthesizer, images):
    features = synthesizer.encode(images[0])
    full, half = (
        warp_and_mask(features, flow_of(config, shift=0.2, visible=v)) for v in (1.0, 0.5)
    )
    for a, b in zip(full, half, strict=True):
        torch.testing.assert_close(a / 2, b)
