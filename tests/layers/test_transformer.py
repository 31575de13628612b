import pytest
import torch
from torch import nn

from s2glib.layers import SkipTransformer, TransformerLayer


class Named(nn.Module):
    """A layer that notes when it is called, and with what."""

    def __init__(self, name, calls):
        super().__init__()
        self.name, self.calls = name, calls

    def forward(self, tokens, *context):
        self.calls.append((self.name, len(context)))
        return tokens + 2.0**self.name


def first_half(join, skip):
    """Make a join pass on the way up (False) or only the skip (True)."""
    width = join.out_features
    eye, none = torch.eye(width), torch.zeros(width, width)
    join.weight.data = torch.cat([none, eye] if skip else [eye, none], dim=1)
    join.bias.data.zero_()


def test_layers_run_in_order_and_all_see_the_context():
    calls = []
    stack = SkipTransformer([Named(n, calls) for n in range(5)], 4)
    stack(torch.zeros(1, 2, 4), torch.zeros(1, 3), torch.zeros(1, 3))
    assert calls == [(n, 2) for n in range(5)]


@pytest.mark.parametrize(("skips", "expected"), [(False, 31.0), (True, 1 + 16.0)])
def test_the_last_layer_receives_the_first_ones_output(skips, expected):
    stack = SkipTransformer([Named(n, []) for n in range(5)], 4)
    for join in stack.joins:
        first_half(join, skips)
    assert (stack(torch.zeros(1, 2, 4)) == expected).all()


def test_gradients_reach_every_layer_through_the_skips():
    torch.manual_seed(0)
    stack = SkipTransformer([TransformerLayer(8, 2, 16) for _ in range(5)], 8)
    for join in stack.joins:
        first_half(join, skip=True)
    stack(torch.randn(2, 3, 8)).square().sum().backward()
    reached = [layer.network[0].weight.grad is not None for layer in stack.layers]
    sizes = [float(layer.network[0].weight.grad.abs().sum()) for layer in stack.layers]
    assert all(reached)
    assert sizes[0] > 0
    assert sizes[4] > 0
    assert (
        sizes[1] == sizes[2] == sizes[3] == 0
    )  # only skips are open: the inner layers are cut off


@pytest.mark.parametrize("count", [0, 2, 8])
def test_a_u_needs_a_middle(count):
    with pytest.raises(ValueError, match=f"not {count}"):
        SkipTransformer([nn.Identity() for _ in range(count)], 4)


def test_a_layer_agrees_with_torchs_pre_norm_layer():
    torch.manual_seed(0)
    ours = TransformerLayer(16, 4, 32)
    theirs = nn.TransformerEncoderLayer(
        16, 4, 32, dropout=0, activation="gelu", batch_first=True, norm_first=True
    )
    theirs.self_attn.in_proj_weight.data = ours.attention.qkv.weight.data
    theirs.self_attn.in_proj_bias.data = ours.attention.qkv.bias.data
    pairs = [
        (theirs.self_attn.out_proj, ours.attention.out),
        (theirs.linear1, ours.network[0]),
        (theirs.linear2, ours.network[2]),
        (theirs.norm1, ours.norm1),
        (theirs.norm2, ours.norm2),
    ]
    for to, source in pairs:
        to.load_state_dict(source.state_dict())
    x = torch.randn(2, 6, 16)
    torch.testing.assert_close(ours(x), theirs(x))
