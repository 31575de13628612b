import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.losses import (
    equivariance_loss,
    gram,
    masked_l1,
    perceptual_loss,
    style_loss,
    total_variation,
    warp_loss,
)


def maps(*shapes, seed=0):
    generator = torch.Generator().manual_seed(seed)
    return [torch.randn(*s, generator=generator, dtype=torch.float64) for s in shapes]


TWO = ((2, 3, 4, 5), (2, 6, 2, 2))


@pytest.mark.parametrize("loss", [perceptual_loss, warp_loss])
def test_maps_are_compared_one_by_one_and_summed(loss):
    f, f_hat = maps(*TWO), maps(*TWO, seed=1)
    expected = sum(float((a - b).abs().sum()) / a.numel() for a, b in zip(f, f_hat, strict=True))
    assert float(loss(f, f_hat)) == pytest.approx(expected)
    assert loss(f, f) == 0


def test_a_weight_scales_the_places_it_covers():
    f, f_hat = maps(*TWO), maps(*TWO, seed=1)
    everywhere = torch.full((2, 1, 8, 8), 3.0, dtype=torch.float64)
    torch.testing.assert_close(
        perceptual_loss(f, f_hat, weight=everywhere), 3 * perceptual_loss(f, f_hat)
    )
    left = torch.zeros(2, 1, 4, 4, dtype=torch.float64)
    left[..., :2] = 1
    torch.testing.assert_close(
        perceptual_loss(f[1:], f_hat[1:], weight=left),
        perceptual_loss([f[1][..., :1]], [f_hat[1][..., :1]]) / 2,
    )


def test_style_is_the_printed_sum_over_its_size():
    """[MDD Eq. B19] with indices, one picture; divided by c h w of the map and c c of the Gram."""
    (f,), (f_hat,) = maps((1, 3, 2, 4)), maps((1, 3, 2, 4), seed=1)
    printed = 0.0
    for i in range(3):
        for j in range(3):
            printed += abs(float((f[0, i] * f[0, j]).sum() - (f_hat[0, i] * f_hat[0, j]).sum()))
    assert float(style_loss([f], [f_hat])) == pytest.approx(printed / (3 * 2 * 4) / 9)


def test_style_does_not_care_where_things_are():
    (f,) = maps((2, 3, 4, 4))
    shuffled = f.flatten(2)[..., torch.randperm(16)].reshape(f.shape)
    assert style_loss([f], [shuffled]) < 1e-12
    assert perceptual_loss([f], [shuffled]) > 0.1
    assert torch.equal(gram(f), gram(f).mT)


@given(height=st.integers(2, 6), width=st.integers(2, 6))
def test_total_variation_is_the_printed_sum_per_pair(height, width):
    (image,) = maps((1, 2, height, width))
    down = sum(
        float((image[0, :, i + 1, j] - image[0, :, i, j]).abs().sum())
        for i in range(height - 1) for j in range(width)
    )  # fmt: skip
    right = sum(
        float((image[0, :, i, j + 1] - image[0, :, i, j]).abs().sum())
        for i in range(height) for j in range(width - 1)
    )  # fmt: skip
    expected = down / (2 * (height - 1) * width) + right / (2 * height * (width - 1))
    assert float(total_variation(image)) == pytest.approx(expected)


def test_a_mask_of_ones_changes_no_variation_and_a_border_costs_nothing():
    (image,) = maps((2, 3, 4, 4))
    torch.testing.assert_close(
        total_variation(image, torch.ones(2, 1, 4, 4).double()), total_variation(image)
    )
    step = torch.zeros(1, 1, 4, 4)
    step[..., 2:] = 1
    assert total_variation(step) > 0
    assert total_variation(step, step) == 0
    assert total_variation(step, torch.zeros(1, 1, 4, 4)) == 0


def test_a_masked_error_is_the_mean_inside_the_mask():
    (image, image_hat) = maps((2, 3, 4, 4), (2, 3, 4, 4))
    mask = torch.zeros(2, 1, 4, 4, dtype=torch.float64)
    mask[0, :, 1:3, 1:3] = 1
    mask[1, :, 0, 0] = 1
    first = (image - image_hat)[0, :, 1:3, 1:3].abs().mean()
    second = (image - image_hat)[1, :, 0, 0].abs().mean()
    torch.testing.assert_close(masked_l1(image, image_hat, mask), (first + second) / 2)


def test_an_empty_mask_asks_for_nothing_and_breaks_no_gradient():
    image = torch.rand(2, 3, 4, 4, requires_grad=True)
    loss = masked_l1(torch.zeros(2, 3, 4, 4), image, torch.zeros(2, 1, 4, 4))
    loss.backward()
    assert loss == 0
    assert (image.grad == 0).all()


def test_keypoints_that_come_back_cost_nothing():
    keypoints = torch.randn(2, 4, 5, 2)
    assert equivariance_loss(keypoints, keypoints) == 0
    moved = keypoints + torch.tensor([0.3, -0.1])
    assert float(equivariance_loss(keypoints, moved)) == pytest.approx(0.2)


SOFT = torch.linspace(0.1, 1, 9, dtype=torch.float64).view(1, 1, 3, 3)


@pytest.mark.parametrize(
    "loss",
    [
        lambda a, b: perceptual_loss([a], [b], weight=SOFT),
        lambda a, b: style_loss([a], [b]),
        lambda a, b: total_variation(a) + total_variation(b, SOFT),
        lambda a, b: masked_l1(a, b, SOFT),
        lambda a, b: equivariance_loss(a.mT[..., :2], b.mT[..., :2]),
    ],
    ids=["perceptual", "style", "variation", "masked", "equivariance"],
)
def test_gradients_are_those_of_finite_differences(loss):
    a, b = (x.requires_grad_() for x in maps((1, 2, 3, 3), (1, 2, 3, 3)))
    assert torch.autograd.gradcheck(loss, (a, b))


@pytest.mark.parametrize("loss", [perceptual_loss, style_loss, warp_loss])
def test_lists_that_do_not_match_are_refused(loss):
    one, other = maps((1, 2, 4, 4)), maps((1, 2, 4, 5))
    for pair in ([one, other], [one, one * 2], [[], []], [maps((0, 2, 4, 4))] * 2):
        with pytest.raises(ValueError, match="same shapes, none empty"):
            loss(*pair)


def test_empty_pictures_are_refused(without_type_hook):
    with pytest.raises(ValueError, match="at least one picture"):
        masked_l1(torch.zeros(0, 3, 4, 4), torch.zeros(0, 3, 4, 4), torch.zeros(0, 1, 4, 4))
    with pytest.raises(ValueError, match="2 x 2 pixels"):
        total_variation(torch.zeros(1, 3, 1, 4))
    with pytest.raises(ValueError, match="same shapes"):
        equivariance_loss(torch.zeros(0, 2), torch.zeros(0, 2))
    with pytest.raises(ValueError, match="same shapes"):
        equivariance_loss(torch.zeros(3, 2), torch.zeros(4, 2))
