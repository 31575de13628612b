import pytest
import torch
from torch import nn

from s2glib.papers.probtalk import StyleDecoder, StyleLayer
from s2glib.papers.probtalk.style_decoder import AdaptiveInstanceNorm, AdaptiveLayerNorm


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.fixture
def tokens():
    return torch.randn(2, 9, 16)


@pytest.fixture
def memory():
    return torch.randn(2, 5, 16)


class Unstyled(nn.Module):
    """No style at all."""

    def forward(self, tokens, style):
        return tokens


def test_without_style_it_is_torchs_own_decoder_layer(tokens, memory):
    ours = StyleLayer(16, 4, 32, style_dim=6).eval()
    ours.styles = nn.ModuleList(Unstyled() for _ in range(3))
    theirs = nn.TransformerDecoderLayer(16, 4, 32, batch_first=True).eval()
    for parameter in ours.norms.parameters():
        nn.init.normal_(parameter)
    theirs.self_attn.load_state_dict(ours.self_attention.state_dict())
    theirs.multihead_attn.load_state_dict(ours.cross_attention.state_dict())
    for place, linear in ((0, theirs.linear1), (3, theirs.linear2)):
        linear.load_state_dict(ours.network[place].state_dict())
    for norm, own in zip((theirs.norm1, theirs.norm2, theirs.norm3), ours.norms, strict=True):
        norm.load_state_dict(own.state_dict())
    expected = theirs(tokens, memory)
    torch.testing.assert_close(ours(tokens, memory, torch.zeros(2, 6)), expected)


def test_the_codes_form_starts_as_the_layer_norms_alone(tokens, memory):
    layer = StyleLayer(16, 4, 32, style_dim=6, style_norm="adaln").eval()
    expected = tokens
    for norm in layer.norms:
        expected = norm(expected)
    torch.testing.assert_close(layer(tokens, memory, torch.randn(2, 6)), expected)


def test_the_texts_form_is_torchs_instance_norm_with_a_scale_and_a_shift(tokens):
    norm, style = AdaptiveInstanceNorm(16, 6), torch.randn(2, 6)
    still = nn.InstanceNorm1d(16)(tokens.mT).mT
    numbers = norm.to_scale_shift(style)[:, None]
    expected = still * (1 + numbers[..., :16]) + numbers[..., 16:]
    torch.testing.assert_close(norm(tokens, style), expected)


def test_the_codes_form_is_a_gated_layer_norm(tokens):
    norm, style = AdaptiveLayerNorm(16, 6), torch.randn(2, 6)
    nn.init.normal_(norm.gate.weight)
    scale, shift = norm.to_scale_shift[1](nn.functional.silu(style))[:, None].chunk(2, dim=-1)
    h = nn.functional.layer_norm(tokens, (16,)) * (1 + scale) + shift
    torch.testing.assert_close(norm(tokens, style), nn.functional.silu(h) @ norm.gate.weight.T)


def test_after_the_texts_form_a_speaker_alone_decides_mean_and_spread_over_time(tokens):
    norm, style = AdaptiveInstanceNorm(16, 6), torch.randn(2, 6)
    first, second = (norm(x, style) for x in (tokens, 5 * tokens + 3))
    torch.testing.assert_close(first, second, rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("style_norm", ["adain", "adaln"])
def test_speaker_and_memory_both_have_a_say(style_norm, tokens, memory):
    decoder = decoder_of(style_norm)
    first = decoder(tokens, memory, torch.tensor([0, 1]))
    for changed in (
        decoder(tokens, memory, torch.tensor([1, 1])),
        decoder(tokens, memory + torch.randn(1, 5, 16), torch.tensor([0, 1])),
    ):
        assert (changed - first)[0].abs().max() > 1e-3
    torch.testing.assert_close(decoder(tokens, memory, torch.tensor([1, 1]))[1], first[1])


def decoder_of(style_norm):
    decoder = StyleDecoder(
        2, 16, 4, 32, speakers=3, style_dim=6, style_norm=style_norm, dropout=0.1
    ).eval()
    for parameter in decoder.parameters():
        nn.init.normal_(parameter, std=0.3)
    return decoder


@pytest.mark.parametrize("style_norm", ["adain", "adaln"])
def test_it_has_no_places_of_its_own(style_norm, tokens, memory):
    """Tokens or memory in another order: the same tokens in that order."""
    decoder, speaker = decoder_of(style_norm), torch.tensor([2, 0])
    order = torch.randperm(9)
    whole = decoder(tokens, memory, speaker)
    moved = decoder(tokens[:, order], memory[:, torch.randperm(5)], speaker)
    torch.testing.assert_close(moved, whole[:, order], rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("style_norm", ["adain", "adaln"])
def test_every_part_gets_a_gradient(style_norm, tokens, memory):
    decoder = decoder_of(style_norm)
    decoder(tokens, memory, torch.tensor([2, 0])).square().sum().backward()
    assert all(p.grad is not None and p.grad.abs().max() > 0 for p in decoder.parameters())


@pytest.mark.parametrize("form", [AdaptiveInstanceNorm, AdaptiveLayerNorm])
def test_gradients_agree_with_differences(form):
    norm = form(4, 3).double()
    for parameter in norm.parameters():
        nn.init.normal_(parameter)
    tokens, style = torch.randn(1, 5, 4).double(), torch.randn(1, 3).double()
    inputs = (tokens.requires_grad_(), style.requires_grad_())
    assert torch.autograd.gradcheck(norm, inputs)


def test_a_track_that_stands_still_has_no_spread_and_stays_finite():
    norm = AdaptiveInstanceNorm(4, 3)
    still = torch.ones(1, 5, 4, requires_grad=True)
    out = norm(still, torch.randn(1, 3))
    out.sum().backward()
    assert out.isfinite().all()
    assert still.grad.isfinite().all()
