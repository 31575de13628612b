import pytest
import torch
from torch import nn

from s2glib.layers import SelfAttention


@pytest.mark.parametrize(("width", "heads"), [(8, 1), (24, 4), (64, 8)])
def test_attention_agrees_with_torchs(width, heads):
    torch.manual_seed(0)
    ours, theirs = (
        SelfAttention(width, heads),
        nn.MultiheadAttention(width, heads, batch_first=True),
    )
    theirs.in_proj_weight.data = ours.qkv.weight.data
    theirs.in_proj_bias.data = ours.qkv.bias.data
    theirs.out_proj.load_state_dict(ours.out.state_dict())
    x = torch.randn(3, 7, width)
    torch.testing.assert_close(ours(x), theirs(x, x, x, need_weights=False)[0])


def test_attention_does_not_know_the_order_of_tokens():
    torch.manual_seed(0)
    attention, x, order = SelfAttention(16, 4), torch.randn(2, 9, 16), torch.randperm(9)
    torch.testing.assert_close(attention(x[:, order]), attention(x)[:, order])


def test_attention_is_differentiable():
    torch.manual_seed(0)
    attention = SelfAttention(4, 2).double()
    x = torch.randn(1, 3, 4, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(attention, (x,))
