import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from s2glib.papers.probtalk import (
    hide_tokens,
    masked_share,
    part_contexts,
    random_shares,
    remask_counts,
    window_contexts,
)
from s2glib.papers.probtalk.masking import GIVEN, decode

MASK = 7


@pytest.fixture
def generator():
    return torch.Generator().manual_seed(0)


@pytest.fixture
def hidden():
    return torch.full((3, 5, 4), MASK)


def fixed(scale=2.0):
    """Log-odds that do not look at the tokens."""
    logits = scale * torch.randn(3, 5, 4, MASK, generator=torch.Generator().manual_seed(1))
    return lambda codes: logits


def test_the_schedule_of_the_authors():
    assert remask_counts(88, 8) == [86, 81, 73, 62, 48, 33, 17, 0]


@given(st.integers(0, 400), st.integers(1, 40))
def test_ever_fewer_tokens_are_hidden_and_none_at_the_end(tokens, steps):
    counts = remask_counts(tokens, steps)
    assert len(counts) == steps
    assert counts[-1] == 0
    assert all(
        after < before or before == 0
        for before, after in zip([tokens, *counts], counts, strict=False)
    )


@pytest.mark.parametrize(("tokens", "steps"), [(88, 0), (88, -1), (-1, 8)])
def test_a_schedule_needs_steps(without_type_hook, tokens, steps):
    with pytest.raises(ValueError, match="1 step or more"):
        remask_counts(tokens, steps)


@given(st.integers(1, 24), st.integers(0, 10_000), st.floats(0, 1))
def test_known_tokens_stay_and_their_number_follows_the_schedule(steps, seed, given_share):
    generator = torch.Generator().manual_seed(seed)
    start = hide_tokens(
        torch.randint(MASK, (3, 5, 4), generator=generator),
        torch.full((3,), given_share),
        mask=MASK,
        generator=generator,
    )
    before, unknown = start, int((start[0] == MASK).sum())
    states = list(decode(fixed(), start, mask=MASK, steps=steps, generator=generator))
    for state, count in zip(states, remask_counts(unknown, steps), strict=True):
        was_known = before != MASK
        assert torch.equal(state.codes[was_known], before[was_known])
        assert state.confidence[was_known].isinf().all()
        assert ((~state.known).flatten(1).sum(1) == count).all()
        assert torch.equal(state.codes != MASK, state.known)
        before = state.codes


def test_the_surest_tokens_stay(hidden, generator):
    first, *_ = decode(fixed(), hidden, mask=MASK, generator=generator)
    kept, dropped = first.confidence[first.known], first.confidence[~first.known]
    for row in range(3):
        known = first.known[row]
        assert first.confidence[row][known].min() >= first.confidence[row][~known].max()
    assert len(kept) + len(dropped) == hidden.numel()


def test_one_step_is_one_draw_from_one_pass(hidden):
    predict = fixed()
    drawn = torch.multinomial(
        predict(hidden).softmax(-1).flatten(0, 2), 1, generator=torch.Generator().manual_seed(3)
    )
    (only,) = decode(
        predict, hidden, mask=MASK, steps=1, generator=torch.Generator().manual_seed(3)
    )
    assert torch.equal(only.codes.flatten(), drawn.flatten())


@pytest.mark.parametrize("steps", [1, 8])
def test_a_cold_choice_takes_the_likeliest(hidden, generator, steps):
    predict = fixed()
    *_, last = decode(
        predict, hidden, mask=MASK, steps=steps, temperature=1e-3, generator=generator
    )
    assert torch.equal(last.codes, predict(hidden).argmax(-1))


@pytest.mark.parametrize("temperature", [0.0, -1.0, math.nan])
def test_a_temperature_is_above_zero(without_type_hook, hidden, generator, temperature):
    states = decode(fixed(), hidden, mask=MASK, temperature=temperature, generator=generator)
    with pytest.raises(ValueError, match=f"above 0, got {temperature}"):
        next(states)


def test_the_same_generator_gives_the_same_tokens_and_another_does_not(hidden):
    def last(seed):
        return list(
            decode(fixed(), hidden, mask=MASK, generator=torch.Generator().manual_seed(seed))
        )[-1].codes

    assert torch.equal(last(5), last(5))
    assert not torch.equal(last(5), last(6))


def test_tokens_are_drawn_as_often_as_their_odds_say(generator):
    logits = torch.tensor([0.5, 0.3, 0.2]).log().expand(1, 4000, 1, 3)
    (only,) = decode(
        lambda codes: logits, torch.full((1, 4000, 1), 3), mask=3, steps=1, generator=generator
    )
    shares = only.codes.flatten().bincount(minlength=3) / 4000
    torch.testing.assert_close(shares, torch.tensor([0.5, 0.3, 0.2]), rtol=0, atol=0.03)


def test_what_was_decided_is_seen_in_the_next_step(hidden, generator):
    seen = []

    def predict(codes):
        seen.append(codes)
        return fixed()(codes)

    states = list(decode(predict, hidden, mask=MASK, steps=4, generator=generator))
    assert torch.equal(seen[0], hidden)
    assert all(torch.equal(a, b.codes) for a, b in zip(seen[1:], states, strict=False))


@pytest.mark.parametrize(
    ("progress", "share"), [(0.0, 0.5), (0.3, 0.5), (0.5, 0.5), (0.8, 0.8), (1.0, 1.0)]
)
def test_the_curriculum_hides_half_at_first_and_all_at_the_end(progress, share):
    assert masked_share(progress) == share


def test_maskgits_shares_are_the_cosine_of_a_uniform_angle(generator):
    shares = random_shares(20_000, generator)
    assert shares.mean().item() == pytest.approx(2 / math.pi, abs=0.01)
    assert (shares < 0.5).float().mean().item() == pytest.approx(1 / 3, abs=0.02)


@given(st.floats(0, 1), st.integers(0, 1000))
def test_as_many_tokens_are_hidden_as_the_share_says(share, seed):
    codes = torch.randint(MASK, (4, 22, 4))
    hidden = hide_tokens(
        codes,
        torch.full((4,), share),
        mask=MASK,
        generator=torch.Generator().manual_seed(seed),
    )
    kept = hidden != MASK
    assert (abs(kept.flatten(1).sum(1) - (1 - share) * 88) < 1 + 1e-2).all()
    assert torch.equal(hidden[kept], codes[kept])


@pytest.mark.parametrize(("share", "kept"), [(0.0, 88), (0.5, 44), (0.75, 22), (1.0, 0)])
def test_round_shares_keep_round_numbers(share, kept, generator):
    hidden = hide_tokens(
        torch.zeros(2, 22, 4, dtype=torch.long),
        torch.full((2,), share),
        mask=1,
        generator=generator,
    )
    assert ((hidden == 0).flatten(1).sum(1) == kept).all()


def test_the_authors_contexts_are_one_window_for_half_of_the_clips(generator):
    given_frames = window_contexts(400, 176, generator)
    assert not given_frames[:200].any()
    assert (given_frames[200:].sum(1) == GIVEN).all()
    runs = given_frames[200:, :, 0].int().diff(dim=1).abs().sum(1)
    assert (runs <= 2).all()
    assert given_frames[200:, 0].any()
    assert given_frames[200:, -1].any()
    assert torch.equal(given_frames, given_frames[..., :1].expand_as(given_frames))


def test_our_contexts_have_stretches_gaps_and_parts(generator):
    given_parts = part_contexts(3000, 60, generator)[1500:]
    whole = (given_parts == given_parts[..., :1]).all(-1).all(-1)
    throughout = (given_parts == given_parts[:, :1]).all(1).all(-1)
    single = throughout & (given_parts[:, 0].sum(-1) == 1)
    ends = given_parts[:, 0].all(-1) & given_parts[:, -1].all(-1) & ~throughout
    middle = ~given_parts[:, 0].any(-1) & ~given_parts[:, -1].any(-1) & given_parts.any((1, 2))
    for kind in (whole, throughout, single, ends, middle):
        assert 0.05 < kind.float().mean() < 0.7


def test_half_of_our_contexts_are_empty(generator):
    assert not part_contexts(30, 60, generator)[:15].any()
