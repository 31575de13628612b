import pytest
import torch

from s2glib.warping import (
    combine_flows,
    compose_flows,
    coordinate_grid,
    cycle_error,
    fit_tps,
    identity_flow,
    random_tps,
    resize_flow,
    tps_grid,
    warp_features,
    warp_image,
    warp_with_each,
    weight_maps,
    with_identity,
)


@pytest.fixture
def flows(generator):
    """Three gentle flows of two images, (2, 3, 12, 10, 2)."""
    return tps_grid(random_tps(6, generator=generator), 12, 10).unflatten(0, (2, 3))


@pytest.fixture
def image(generator):
    return torch.rand(2, 3, 12, 10, generator=generator)


def test_the_identity_comes_first(flows):
    together = with_identity(flows)
    assert torch.equal(together[1, 0], coordinate_grid(12, 10))
    assert torch.equal(together[:, 1:], flows)


def test_weight_maps_share_every_pixel(generator):
    maps = weight_maps(torch.randn(2, 4, 5, 6, generator=generator))
    torch.testing.assert_close(maps.sum(1), torch.ones(2, 5, 6))
    assert (maps > 0).all()


def test_dropout_leaves_out_whole_flows_but_never_the_identity(generator):
    logits = torch.zeros(400, 3, 2, 2)
    maps = weight_maps(logits, dropout=0.25, generator=generator)
    left_out = (maps == 0).all(-1).all(-1)
    assert not left_out[:, 0].any()
    assert left_out[:, 1:].float().mean().item() == pytest.approx(0.25, abs=0.05)
    torch.testing.assert_close(maps.sum(1), torch.ones(400, 2, 2))
    assert torch.equal((maps == 0).any(-1).any(-1), left_out)


def test_dropout_is_the_generators(generator):
    logits = torch.zeros(9, 5, 2, 2)
    first = weight_maps(logits, dropout=0.5, generator=generator)
    again = weight_maps(logits, dropout=0.5, generator=generator.manual_seed(0))
    assert torch.equal(first, again)


@pytest.mark.parametrize("dropout", [-0.1, 1.0, float("nan")])
def test_dropout_that_is_no_probability_is_refused(dropout):
    with pytest.raises(ValueError, match="dropout"):
        weight_maps(torch.zeros(1, 2, 3, 3), dropout=dropout)


def test_where_one_flow_has_all_the_weight_it_is_the_flow(flows):
    weights = torch.zeros(2, 3, 12, 10)
    weights[:, 2, :, :4] = 1
    weights[:, 1, :, 4:] = 1
    combined = combine_flows(flows, weights)
    assert torch.equal(combined[:, :, :4], flows[:, 2, :, :4])
    assert torch.equal(combined[:, :, 4:], flows[:, 1, :, 4:])


def test_flows_of_one_image_combine_with_the_weights_of_many(flows):
    weights = torch.full((5, 3, 12, 10), 1 / 3)
    torch.testing.assert_close(combine_flows(flows[0], weights)[4], flows[0].mean(0))


def test_each_flow_warps_the_image_on_its_own(image, flows):
    together = warp_with_each(image, flows)
    assert together.shape == (2, 3, 3, 12, 10)
    for k in range(3):
        torch.testing.assert_close(together[:, k], warp_image(image, flows[:, k]))


def test_an_affine_flow_has_the_same_values_at_any_size():
    grids = [
        coordinate_grid(*size)[None] @ torch.tensor([[0.9, 0.1], [-0.2, 1.1]]) + 0.05
        for size in ((5, 7), (20, 11))
    ]
    torch.testing.assert_close(resize_flow(grids[0], 20, 11), grids[1], rtol=1e-5, atol=1e-6)


def test_features_of_any_size_follow_the_flow(flows):
    features = torch.rand(2, 8, 24, 20)
    identity = identity_flow(flows).expand(2, 12, 10, 2)
    torch.testing.assert_close(warp_features(features, identity), features, atol=1e-5, rtol=1e-5)
    assert warp_features(features, flows[:, 0]).shape == features.shape


def test_warping_by_two_flows_in_turn_is_warping_by_their_composition():
    """On an image that is a plane, bilinear lookup is exact."""
    first, second = (
        coordinate_grid(9, 9, dtype=torch.float64) @ torch.tensor(m).double() + 0.03
        for m in ([[0.7, 0.1], [0.1, 0.6]], [[0.6, -0.2], [0.2, 0.7]])
    )
    image = coordinate_grid(9, 9, dtype=torch.float64).movedim(-1, 0)[None]
    in_turn = warp_image(warp_image(image, first[None]), second[None])
    at_once = warp_image(image, compose_flows(first[None], second[None]))
    torch.testing.assert_close(at_once, in_turn)


def test_the_identity_composes_to_the_other_flow_even_outside_the_image(flows):
    far = 1.5 * flows[:, 0]
    identity = identity_flow(far).expand_as(far)
    torch.testing.assert_close(compose_flows(identity, far), far)
    torch.testing.assert_close(compose_flows(far, identity), far, rtol=1e-5, atol=1e-5)


def test_forward_and_backward_splines_nearly_undo_each_other():
    driving = torch.tensor([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [0, 0.1]])
    source = driving + torch.tensor([0.05, -0.03]) * driving.flip(0)
    backward = tps_grid(fit_tps(driving, source), 33, 33)[None]
    forward = tps_grid(fit_tps(source, driving), 33, 33)[None]
    assert cycle_error(forward, backward).max() < 0.01
    assert cycle_error(backward, backward).max() > 0.05


def test_gradients_reach_flows_and_scores(flows, image):
    few = flows[:1, :, :3, :2].double().mul(0.83).requires_grad_()
    scores = torch.rand(1, 4, 3, 2).double().requires_grad_()
    picture = image[:1, :1, :4, :4].double()

    def show(flows, scores):
        combined = combine_flows(with_identity(flows), weight_maps(scores))
        moved = compose_flows(combined, 0.77 * combined)
        return warp_with_each(picture, flows), warp_features(picture, 0.9 * moved)

    assert torch.autograd.gradcheck(show, (few, scores))


def test_the_paper_size_has_its_shapes_on_the_meta_device():
    with torch.device("meta"):
        flows = with_identity(torch.empty(2, 20, 64, 64, 2))
        flow = combine_flows(flows, weight_maps(torch.empty(2, 21, 64, 64), dropout=0.5))
        assert warp_with_each(torch.empty(2, 3, 64, 64), flows).shape == (2, 21, 3, 64, 64)
        assert warp_features(torch.empty(2, 128, 128, 128), flow).shape == (2, 128, 128, 128)
        assert cycle_error(flow, flow).shape == (2, 64, 64)
