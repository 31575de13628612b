"""Masks: which tokens are hidden in training, which are hidden again in decoding, what is given.

Paper:    PT A.2; curriculum, schedule and windows: authors' code (after MaskGIT)
Notebook: notebooks/06_masked_prediction.ipynb
"""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from s2glib.papers.probtalk.motion_features import PARTS

GIVEN = 30  # frames of a training context; authors' code
CHOICE_NOISE = 4.5  # tau: how much chance decides which tokens stay; authors' code
_LONGEST = 0.7  # share of a window that is given, or left open, at most (ours)


class DecodingStep(NamedTuple):
    """Tokens after a step of decoding; those that are not known hold the mask's number.

    `confidence` is what decided: the log-probability of every token with noise, infinite for those
    that were known before.
    """

    codes: Int[Tensor, "batch time groups"]
    known: Bool[Tensor, "batch time groups"]
    confidence: Float[Tensor, "batch time groups"]


def remask_counts(tokens: int, steps: int) -> list[int]:
    """How many of `tokens` are hidden again after each step: a cosine, and always fewer.

    Raises:
        ValueError: if there is no step, or a negative number of tokens.
    """
    if steps < 1 or tokens < 0:
        raise ValueError(f"expected 1 step or more and 0 tokens or more, got {steps} and {tokens}")
    counts, unknown = [], tokens
    for step in range(1, steps + 1):
        cosine = math.floor(tokens * math.cos(step / steps * math.pi / 2))
        unknown = max(0, min(cosine, unknown - 1))
        counts.append(unknown)
    return counts


@torch.no_grad()
def decode(
    predict: Callable[[Int[Tensor, "batch time groups"]], Float[Tensor, "batch time groups codes"]],
    codes: Int[Tensor, "batch time groups"],
    *,
    mask: int,
    steps: int = 8,
    temperature: float = 1.0,
    generator: torch.Generator,
) -> Iterator[DecodingStep]:
    """Fill in hidden tokens, the surest first; yields every state, the last one whole.

    Args:
        predict: the log-odds of every code at every place, given tokens some of which are hidden.
        codes: where to start; usually all hidden. Tokens that are known stay.
        mask: the number of a hidden token.
        steps: how many.
        temperature: of the choice of codes, above 0; towards 0 it takes the likeliest.
        generator: source of chance, on any device.

    Raises:
        ValueError: if there is no step, or the temperature is not above 0.
    """
    if not temperature > 0:
        raise ValueError(
            f"a temperature is above 0, got {temperature}; for the likeliest codes take a small "
            "one, such as 0.001"
        )
    known = codes != mask
    unknown = (~known).flatten(1).sum(1).tolist()
    remasked = torch.tensor([remask_counts(n, steps) for n in unknown], device=codes.device)
    for step in range(steps):
        log_p = (predict(codes) / temperature).log_softmax(-1)
        drawn = _choice(log_p.exp().flatten(0, -2), generator).view_as(codes)
        noise = CHOICE_NOISE * (1 - (step + 1) / steps) * _gumbel(codes.shape, generator)
        sure = log_p.gather(-1, drawn[..., None])[..., 0] + noise.to(log_p)
        confidence = sure.masked_fill(known, math.inf)
        rank = confidence.flatten(1).argsort(dim=1).argsort(dim=1).view_as(codes)
        codes = torch.where(known, codes, drawn)
        known = rank >= remasked[:, step, None, None]
        codes = codes.masked_fill(~known, mask)
        yield DecodingStep(codes, known, confidence)


def _choice(odds: Float[Tensor, "n codes"], generator: torch.Generator) -> Int[Tensor, "n 1"]:
    """One code a row, drawn where the generator is."""
    drawn = torch.multinomial(odds.to(generator.device), 1, generator=generator)
    return drawn.to(odds.device)


def _gumbel(shape: torch.Size, generator: torch.Generator) -> Tensor:
    uniform = torch.rand(shape, generator=generator, device=generator.device)
    return -(-uniform.clamp_min(1e-20).log()).log()


def masked_share(progress: float) -> float:
    """The authors' curriculum: half of the tokens are hidden at first, all of them at the end."""
    return min(max(progress, 0.5), 1.0)


def random_shares(count: int, generator: torch.Generator) -> Float[Tensor, " count"]:
    """MaskGIT's instead: for each clip any share, as decoding meets them; cos(u pi / 2)."""
    return (torch.rand(count, generator=generator) * math.pi / 2).cos()


def hide_tokens(
    codes: Int[Tensor, "batch time groups"],
    shares: Float[Tensor, " batch"],
    *,
    mask: int,
    generator: torch.Generator,
) -> Int[Tensor, "batch time groups"]:
    """Hide a share of each clip's tokens, wherever they are; floor((1 - share) tokens) stay."""
    flat = codes.flatten(1)
    kept = ((1 - shares) * flat.shape[1] + 1e-4).floor()[:, None]
    rank = torch.rand(flat.shape, generator=generator).argsort(dim=1)
    return torch.where(rank < kept, flat, mask).view_as(codes)


def window_contexts(count: int, frames: int, generator: torch.Generator) -> Bool[Tensor, "n t 4"]:
    """The authors' contexts: nothing for half of the clips, `GIVEN` frames for the others."""
    start = (torch.rand(count, generator=generator) * (frames - GIVEN + 1)).long()
    given = _spans(start, start + GIVEN, frames)
    given[: count // 2] = False
    return given[..., None].expand(-1, -1, len(PARTS))


def part_contexts(count: int, frames: int, generator: torch.Generator) -> Bool[Tensor, "n t 4"]:
    """Contexts for editing (ours): any stretch of frames, all but a stretch, and single parts.

    Half of the clips have none. Of the others a third is given some frames, a third all but some
    frames, and a third some parts of the body throughout; the first two, half of the time, in some
    parts only.
    """
    length = (torch.rand(count, generator=generator) * _LONGEST * frames).long() + 1
    start = (torch.rand(count, generator=generator) * (frames + length)).long() - length
    stretch = _spans(start, start + length, frames)[..., None]
    kind = torch.randint(3, (count, 1, 1), generator=generator)
    when = torch.where(kind == 0, stretch, torch.where(kind == 1, ~stretch, True))
    chosen = torch.rand(count, 1, len(PARTS), generator=generator) < 0.5
    whole = (kind < 2) & (torch.rand(count, 1, 1, generator=generator) < 0.5)
    given = when & (chosen | whole)
    given[: count // 2] = False
    return given


def _spans(start: Tensor, end: Tensor, frames: int) -> Bool[Tensor, "n t"]:
    frame = torch.arange(frames)
    return (frame >= start[:, None]) & (frame < end[:, None])
