import torch

from s2glib.layers import AdaptiveLayer, FiLM


def test_an_adaptive_layer_starts_as_the_identity():
    torch.manual_seed(0)
    layer = AdaptiveLayer(16, 4, 32, condition=6)
    x = torch.randn(2, 5, 16)
    assert torch.equal(layer(x, torch.randn(2, 6)), x)


def test_a_trained_adaptive_layer_listens_to_its_condition():
    torch.manual_seed(0)
    layer = AdaptiveLayer(16, 4, 32, condition=6)
    torch.nn.init.normal_(layer.modulate.weight)
    x = torch.randn(1, 5, 16)
    assert (layer(x, torch.ones(1, 6)) - layer(x, -torch.ones(1, 6))).abs().max() > 0.1


def test_the_first_gradient_reaches_the_modulation():
    torch.manual_seed(0)
    layer = AdaptiveLayer(16, 4, 32, condition=6)
    layer(torch.randn(2, 5, 16), torch.randn(2, 6)).square().sum().backward()
    assert layer.modulate.weight.grad.abs().max() > 0


def test_film_scales_and_shifts_every_token_alike():
    torch.manual_seed(0)
    film = FiLM(6, 16)
    x, condition = torch.randn(2, 5, 16), torch.randn(2, 6)
    moved = film(x, condition)
    for clip in range(2):
        numbers = film.to_scale_shift.weight @ condition[clip] + film.to_scale_shift.bias
        for token in range(5):
            expected = (1 + numbers[:16]) * x[clip, token] + numbers[16:]
            torch.testing.assert_close(moved[clip, token], expected)
