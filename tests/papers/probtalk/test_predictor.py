from dataclasses import replace

import pytest
import torch

from s2glib.checkpoint import load_checkpoint, save_checkpoint
from s2glib.papers.probtalk import PAPER_PREDICTOR, TEACHING_PREDICTOR, Predictor

SMALL = replace(
    TEACHING_PREDICTOR,
    motion=10,
    speech=6,
    codes=12,
    speakers=3,
    audio_width=8,
    context_widths=(8, 10, 12),
    width=16,
    heads=2,
    layers=2,
    hidden=16,
    style=4,
)


@pytest.fixture(autouse=True)
def seed():
    torch.manual_seed(0)


@pytest.fixture
def generator():
    return torch.Generator().manual_seed(0)


@pytest.fixture(params=["adain", "adaln"])
def predictor(request):
    """Every weight has a value, also those that start at zero."""
    model = Predictor(replace(SMALL, style_norm=request.param))
    for parameter in model.parameters():
        torch.nn.init.normal_(parameter, std=0.3)
    return model.eval()


@pytest.fixture
def inputs():
    """Codes, speech, context, mask and speaker of two windows of 40 frames."""
    codes = torch.randint(13, (2, 5, 4))
    mask = torch.rand(2, 40, 4) < 0.3
    return [codes, torch.randn(2, 40, 6), torch.randn(2, 40, 10), mask, torch.tensor([0, 2])]


def test_there_is_a_number_for_every_code_at_every_place(predictor, inputs):
    assert predictor(*inputs).shape == (2, 5, 4, 12)


@pytest.mark.parametrize("place", range(5))
def test_each_input_has_a_say(predictor, inputs, place):
    other = list(inputs)
    other[place] = {
        torch.bool: lambda x: ~x,
        torch.long: lambda x: (x + 1) % 3,
        torch.float32: lambda x: x + 1,
    }[inputs[place].dtype](inputs[place])
    assert (predictor(*other) - predictor(*inputs)).abs().max() > 1e-5


def test_clips_of_a_batch_do_not_mix(predictor, inputs):
    alone = predictor(*(each[1:] for each in inputs))
    torch.testing.assert_close(alone, predictor(*inputs)[1:], rtol=1e-4, atol=1e-4)


def test_equal_tokens_at_different_places_are_told_apart(predictor, inputs):
    inputs[0] = torch.full((2, 5, 4), predictor.mask)
    places = predictor(*inputs)[0].flatten(0, 1)
    apart = (places[:, None] - places).abs().amax(-1) + torch.eye(20)
    assert apart.min() > 1e-5


def test_the_fixed_places_of_time_and_group_are_mixed_up(inputs):
    """Why `own_codes`: token 2 of group 1 cannot be told from token 1 of group 2."""
    predictor = Predictor(replace(SMALL, own_codes=False, aligned=False)).eval()
    inputs[0] = torch.full((2, 5, 4), predictor.mask)
    odds = predictor(*inputs)
    torch.testing.assert_close(odds[:, 1, 0], odds[:, 0, 1])
    torch.testing.assert_close(odds[:, 3, 2], odds[:, 2, 3])


def test_speech_is_heard_at_the_tokens_own_time(predictor):
    """What the strided convolutions make of eight frames stands around their token's place."""
    speech = torch.zeros(1, 6, 176)
    still = predictor.audio(speech)
    speech[..., 80:88] = 1.0
    changed = (predictor.audio(speech) - still).abs().amax(1)[0]
    assert changed.nonzero()[:, 0].tolist() == [9, 10, 11]


def test_decoding_starts_hidden_and_ends_whole(predictor, inputs, generator):
    memory = predictor.listen(*inputs[1:4])
    states = list(predictor.decode(memory, inputs[4], generator=generator))
    assert len(states) == 8
    assert (~states[0].known).flatten(1).sum(1).tolist() == [19, 19]  # floor(20 cos(pi / 16))
    assert states[-1].known.all()
    assert states[-1].codes.max() < predictor.mask


def test_one_step_is_one_pass(predictor, inputs):
    memory = predictor.listen(*inputs[1:4])
    inputs[0] = predictor.hidden(memory)
    with torch.no_grad():
        odds = predictor(*inputs)
    drawn = torch.multinomial(
        odds.softmax(-1).flatten(0, 2), 1, generator=torch.Generator().manual_seed(4)
    )
    generator = torch.Generator().manual_seed(4)
    (only,) = predictor.decode(memory, inputs[4], steps=1, generator=generator)
    assert torch.equal(only.codes.flatten(), drawn.flatten())


class Through(torch.nn.Module):
    """Tokens as they come."""

    def forward(self, tokens, memory, speaker):
        return tokens


@pytest.mark.parametrize("aligned", [True, False])
def test_aligned_tokens_begin_with_what_is_heard_at_their_time(aligned, inputs):
    predictor = Predictor(replace(SMALL, aligned=aligned)).eval()
    predictor.decoder = Through()
    memory = torch.randn(2, 5, 16)
    louder = memory.clone()
    louder[:, 3] += 1
    first, second = (predictor.predict(m, inputs[4], inputs[0]) for m in (memory, louder))
    changed = (first - second).abs().amax((0, 2, 3)) > 1e-6
    assert changed.tolist() == [False, False, False, aligned, False]


def test_every_part_gets_a_gradient(predictor, inputs):
    predictor.train()
    predictor(*inputs).square().sum().backward()
    assert not [name for name, p in predictor.named_parameters() if p.grad is None]


def linear(n, m):
    return n * m + m


def resample(n):
    return 2 * linear(4 * n, n) + 2 * n  # a convolution, one beside it, batch norm


def gated(n, m, kernel, stride):
    skip = linear(kernel * n, m) if stride == 2 or n != m else 0
    return linear(kernel * n, 2 * m) + linear(m, m) + skip


def test_the_paper_predictor_has_the_authors_sizes():
    with torch.device("meta"):
        predictor = Predictor(PAPER_PREDICTOR)
        inputs = [torch.zeros(2, 176, size) for size in (768, 376)]
        mask = torch.zeros(2, 176, 1, dtype=torch.bool)
        speaker = torch.zeros(2, dtype=torch.long)
        codes = torch.zeros(2, 22, 4, dtype=torch.long)
        assert predictor(codes, *inputs, mask, speaker).shape == (2, 22, 4, 128)
    audio = linear(768, 256) + 2 * 256 + 3 * resample(256)
    widths = [128, 128, 128, 128, 128, 256, 256, 512, 512, 512, 512]
    kernels = [7, 3, 4, 3, 4, 3, 4, 3, 3, 3]
    context = linear(377, 128) + sum(
        gated(n, m, kernel, 2 if kernel == 4 else 1)
        for n, m, kernel in zip(widths, widths[1:], kernels, strict=False)
    )
    attention = linear(512, 3 * 512) + linear(512, 512)
    network = linear(512, 2048) + linear(2048, 512)
    layer = 2 * attention + network + 3 * (2 * 512 + linear(512, 1024))
    decoder = 4 * 512 + 6 * layer
    head = linear(512, 512) + linear(512, 128)
    expected = audio + context + linear(768, 512) + 129 * 512 + decoder + head
    assert sum(p.numel() for p in predictor.parameters()) == expected


def test_the_teaching_predictor_fits_its_budget():
    with torch.device("meta"):
        predictor = Predictor(TEACHING_PREDICTOR)
    assert sum(p.numel() for p in predictor.parameters()) <= 1_500_000


def test_a_checkpoint_brings_back_the_predictor(predictor, inputs, tmp_path):
    save_checkpoint(tmp_path / "predictor.safetensors", predictor, predictor.config)
    loaded = load_checkpoint(tmp_path / "predictor.safetensors", Predictor)
    assert torch.equal(loaded(*inputs), predictor(*inputs))


def test_guidance_goes_on_from_what_is_unheard_beyond_what_is_heard(predictor, inputs):
    codes, *_, speaker = inputs
    memory, unheard = torch.randn(2, 2, 5, 16)

    def odds(guidance):
        return predictor.predict(memory, speaker, codes, unheard=unheard, guidance=guidance)

    heard, deaf = (predictor.predict(m, speaker, codes) for m in (memory, unheard))
    assert (heard - deaf).abs().max() > 0.01
    torch.testing.assert_close(odds(1.0), heard)
    torch.testing.assert_close(odds(0.0), deaf)
    torch.testing.assert_close(odds(2.0) - heard, heard - deaf)


def test_guidance_needs_something_to_go_on_from(predictor, inputs):
    memory = torch.randn(2, 5, 16)
    with pytest.raises(ValueError, match="goes on from what is unheard"):
        predictor.predict(memory, inputs[4], inputs[0], guidance=2.0)


def test_guidance_decides_in_decoding(predictor, inputs):
    speaker = inputs[4]
    memory, unheard = torch.randn(2, 2, 5, 16)

    def last(*heard, **guided):
        generator = torch.Generator().manual_seed(3)
        *_, last = predictor.decode(*heard, **guided, generator=generator)
        return last.codes

    assert torch.equal(last(memory, speaker, unheard=unheard, guidance=0.0), last(unheard, speaker))
    strongly = last(memory, speaker, unheard=unheard, guidance=8.0)
    assert not torch.equal(strongly, last(memory, speaker))


def test_each_group_has_codes_of_its_own(inputs):
    """Code 3 means one thing in one group, another in the next; not so in the authors' code."""
    own, shared = (Predictor(replace(SMALL, own_codes=own)) for own in (True, False))
    assert [len(model.embed) for model in (own, shared)] == [4, 1]
    assert [len(model.odds) for model in (own, shared)] == [4, 1]
    own.eval()
    other = Predictor(SMALL).eval()
    other.load_state_dict(own.state_dict())
    with torch.no_grad():
        other.embed[2].weight[3] += 1
    memory, speaker = torch.randn(1, 5, 16), torch.tensor([0])
    codes = torch.full((1, 5, 4), 4)
    for group, differs in ((1, False), (2, True)):
        codes[0, 0] = 4
        codes[0, 0, group] = 3
        same = torch.equal(*(model.predict(memory, speaker, codes) for model in (own, other)))
        assert same != differs
