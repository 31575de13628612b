import numpy as np
import pytest
import torch

from s2glib.layers import GatedConv


def convolve(x, weight, bias, stride, padding):
    """A convolution over time as its definition says: x (channels, time)."""
    x = np.pad(x, ((0, 0), (padding, padding)))
    kernel = weight.shape[-1]
    starts = range(0, x.shape[1] - kernel + 1, stride)
    return (
        np.stack([(weight * x[:, s : s + kernel]).sum((1, 2)) for s in starts], 1) + bias[:, None]
    )


@pytest.mark.parametrize(
    ("channels", "width", "kernel", "stride"),
    [(6, 6, 7, 1), (6, 6, 3, 1), (6, 10, 4, 2), (4, 6, 3, 1)],
)
def test_it_is_what_its_formula_says(channels, width, kernel, stride):
    torch.manual_seed(0)
    layer = GatedConv(channels, width, kernel, stride).double()
    values = {name: value.numpy() for name, value in layer.state_dict().items()}
    x = torch.randn(1, channels, 24, dtype=torch.float64)
    padding = (kernel - 1) // 2
    both = convolve(x[0].numpy(), values["conv.weight"], values["conv.bias"], stride, padding)
    gated = np.tanh(both[:width]) / (1 + np.exp(-both[width:]))
    expected = values["mix.weight"][..., 0] @ gated + values["mix.bias"][:, None]
    if "skip.weight" in values:
        skip = convolve(x[0].numpy(), values["skip.weight"], values["skip.bias"], stride, padding)
    else:
        skip = x[0].numpy()
    np.testing.assert_allclose(layer(x)[0].detach(), expected + skip, atol=1e-12)


def test_stride_two_halves_time():
    assert GatedConv(5, 8, 4, stride=2)(torch.zeros(2, 5, 176)).shape == (2, 8, 88)


def test_a_closed_gate_lets_only_the_input_through():
    layer = GatedConv(5, 5, 3)
    torch.nn.init.constant_(layer.conv.bias[5:], -1e4)
    torch.nn.init.zeros_(layer.mix.bias)
    x = torch.randn(2, 5, 12)
    assert torch.equal(layer(x), x)


def test_gradients_agree_with_differences():
    torch.manual_seed(0)
    layer = GatedConv(2, 3, 4, stride=2).double()
    x = torch.randn(1, 2, 6, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(layer, x)
