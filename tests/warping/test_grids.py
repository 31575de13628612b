import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import map_coordinates

from s2glib.warping import coordinate_grid, gaussian_heatmap, warp_image


@pytest.fixture
def image(generator):
    return torch.rand(2, 3, 6, 9, generator=generator)


@given(st.integers(2, 20), st.integers(2, 20))
def test_the_grid_reaches_from_corner_to_corner_x_first(height, width):
    grid = coordinate_grid(height, width, dtype=torch.float64)
    assert grid.shape == (height, width, 2)
    assert [grid[0, 0].tolist(), grid[0, -1].tolist()] == [[-1, -1], [1, -1]]
    assert [grid[-1, 0].tolist(), grid[-1, -1].tolist()] == [[-1, 1], [1, 1]]
    steps = grid.diff(dim=0)[..., 1], grid.diff(dim=1)[..., 0]
    assert all(
        torch.allclose(s, 2 / torch.tensor(n - 1.0).double())
        for s, n in zip(steps, (height, width), strict=True)
    )


def test_the_grid_shows_an_image_as_it_is(image):
    grid = coordinate_grid(6, 9).expand(2, 6, 9, 2)
    for padding in ("zeros", "border", "reflection"):
        torch.testing.assert_close(warp_image(image, grid, padding=padding), image)


def test_a_point_of_the_grid_shows_that_point_of_the_image():
    """The keypoint lies right of and above the middle: x = 0.5, y = -1."""
    image = torch.zeros(1, 1, 5, 5)
    image[0, 0, 0, 3] = 1
    assert warp_image(image, torch.tensor([[[[0.5, -1.0]]]])).item() == 1


def test_between_pixels_it_is_scipys_bilinear_lookup(image, generator):
    grid = 2 * torch.rand(2, 4, 5, 2, generator=generator) - 1
    ours = warp_image(image, grid)
    rows, columns = (grid[0, ..., 1] + 1) / 2 * 5, (grid[0, ..., 0] + 1) / 2 * 8
    peer = map_coordinates(image[0, 1].numpy(), [rows.numpy(), columns.numpy()], order=1)
    np.testing.assert_allclose(ours[0, 1], peer, rtol=1e-4, atol=1e-5)


def test_outside_the_image_is_what_the_padding_says(image):
    grid = torch.tensor([[[[-1.25, -1.0]]]]).expand(2, 1, 1, 2)  # one pixel left of the corner
    shown = {p: warp_image(image, grid, padding=p)[0, :, 0, 0] for p in ("zeros", "border")}
    shown["reflection"] = warp_image(image, grid, padding="reflection")[0, :, 0, 0]
    assert torch.equal(shown["zeros"], torch.zeros(3))
    torch.testing.assert_close(shown["border"], image[0, :, 0, 0])
    torch.testing.assert_close(shown["reflection"], image[0, :, 0, 1])


@given(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2), st.floats(0.001, 1))
def test_a_heatmap_is_a_round_bump_around_its_keypoint(x, y, variance):
    keypoints = torch.tensor([[x, y]], dtype=torch.float64)
    away = coordinate_grid(8, 11, dtype=torch.float64) - keypoints[0]
    wanted = torch.exp(-away.square().sum(-1) / (2 * variance))
    torch.testing.assert_close(gaussian_heatmap(keypoints, 8, 11, variance=variance)[0], wanted)


def test_a_heatmap_has_height_one_at_its_keypoint_and_keeps_leading_axes():
    keypoints = coordinate_grid(5, 5)[1:4, [0, 2]]  # (3, 2, 2), on pixels
    maps = gaussian_heatmap(keypoints, 5, 5, variance=0.01)
    assert maps.shape == (3, 2, 5, 5)
    assert maps.amax((-2, -1)).tolist() == [[1, 1]] * 3
    assert maps[0, 1].argmax() == 5 + 2


def test_gradients_reach_keypoints_image_and_grid(generator):
    keypoints = torch.rand(2, 2, generator=generator).double().requires_grad_()
    image = torch.rand(1, 1, 4, 5, generator=generator).double().requires_grad_()
    grid = torch.rand(1, 3, 2, 2, generator=generator).double().mul(0.7).requires_grad_()
    assert torch.autograd.gradcheck(lambda k: gaussian_heatmap(k, 4, 5, variance=0.1), keypoints)
    assert torch.autograd.gradcheck(warp_image, (image, grid))


def test_shapes_and_types_hold_on_the_meta_device():
    with torch.device("meta"):
        assert coordinate_grid(64, 32).shape == (64, 32, 2)
        maps = gaussian_heatmap(torch.empty(8, 100, 2), 64, 32, variance=0.01)
        warped = warp_image(torch.empty(8, 3, 9, 9), torch.empty(8, 64, 32, 2))
    assert (maps.shape, warped.shape) == ((8, 100, 64, 32), (8, 3, 64, 32))
    assert coordinate_grid(2, 2, dtype=torch.float16).dtype == torch.float16


@pytest.mark.parametrize(("height", "width"), [(0, 3), (3, 0), (-1, 3)])
def test_a_grid_without_pixels_is_refused(height, width):
    with pytest.raises(ValueError, match=f"got {height} x {width}"):
        coordinate_grid(height, width)


@pytest.mark.parametrize("variance", [0.0, -1.0, float("nan")])
def test_a_bump_without_width_is_refused(variance):
    with pytest.raises(ValueError, match="variance must be positive"):
        gaussian_heatmap(torch.zeros(1, 2), 3, 3, variance=variance)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("image", "grid", "kind", "fault"),
    [
        (torch.zeros(1, 3, 4, 4), [[0.0, 0.0]], TypeError, "sampling_grid must be a tensor"),
        (torch.zeros(1, 3, 4, 4), torch.zeros(1, 4, 4, 3), ValueError, "sampling_grid must be"),
        (torch.zeros(1, 3, 4, 4).byte(), torch.zeros(1, 4, 4, 2), TypeError, "torch.uint8"),
        (torch.zeros(1, 3, 4, 4).double(), torch.zeros(1, 4, 4, 2), TypeError, "torch.float64"),
        (torch.zeros(3, 4, 4), torch.zeros(4, 4, 2), ValueError, "give one picture a batch axis"),
        (torch.zeros(2, 3, 4, 4), torch.zeros(1, 4, 4, 2), ValueError, "warp_image takes"),
    ],
)
def test_a_picture_and_a_grid_that_do_not_fit_are_refused(image, grid, kind, fault):
    with pytest.raises(kind, match=fault):
        warp_image(image, grid)


@pytest.mark.usefixtures("without_type_hook")
@pytest.mark.parametrize(
    ("keypoints", "kind"),
    [([[0.0, 0.0]], TypeError), (torch.zeros(4, 2).int(), TypeError), (torch.zeros(4), ValueError)],
)
def test_keypoints_that_are_none_are_refused(keypoints, kind):
    with pytest.raises(kind, match="keypoints must be"):
        gaussian_heatmap(keypoints, 4, 4, variance=0.01)
