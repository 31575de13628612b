"""How the latents are pulled apart: the paper's quadruples, and the full-factor swap.

A quadruple is a 2 x 2 grid: two styles x two contents, one emotion. Whatever is constant along
an axis of the grid may be exchanged along it without changing the speech.

Paper:    AM B.3, B.4, Fig. A.2
Notebook: notebooks/09_disentanglement.ipynb
"""

from typing import Literal, NamedTuple

import torch
from einops import rearrange
from jaxtyping import Float, Int
from torch import Tensor
from torch.nn import functional as F

from s2glib.papers.amuse.disentangler import SpeechDisentangler, SpeechLatents


def swap_partner(
    latents: Float[Tensor, "4 *b dim"], axis: Literal["content", "style"]
) -> Float[Tensor, "4 *b dim"]:
    """Give each clip of a quadruple the latent of its partner that differs only along `axis`.

    The order is a1 = (c1, s1), a2 = (c2, s1), a3 = (c1, s2), a4 = (c2, s2). Partners along
    "content" are j(k) = [(6 - k) mod 4] + 1 and serve the emotion and style swaps; partners along
    "style" are j(k) = [(1 + k) mod 4] + 1 and serve the content swap  [AM B.4].

    Raises:
        ValueError: for another axis.
    """
    if axis not in ("content", "style"):
        raise ValueError(f"clips of a quadruple differ in content or style, not in {axis!r}")
    grid = rearrange(latents, "(style content) ... -> style content ...", style=2)
    flipped = grid.flip(0 if axis == "style" else 1)
    return rearrange(flipped, "style content ... -> (style content) ...")


class QuadrupleLosses(NamedTuple):
    """The seven terms of L_dis  [AM B.4]."""

    self_reconstruction: Tensor
    cross_content: Tensor
    cross_emotion: Tensor
    cross_style: Tensor
    content: Tensor
    emotion: Tensor
    style: Tensor

    def total(self, *, content: float = 1.0, classification: float = 1.0) -> Float[Tensor, ""]:
        """L_dis over four, as each term is a mean over clips; the paper's weights are all one.

        A quadruple has four clips but two content pairs, so L_con counts half.
        """
        classes = classification * (self.emotion + self.style)
        return sum(self[:4]) + classes + 0.5 * content * self.content


def l1_norm(
    difference: Float[Tensor, "*b frames mels"], reduction: Literal["mean", "sum"]
) -> Float[Tensor, ""]:
    """|x|_1 per clip, averaged over clips: as a mean over elements, or as the printed sum."""
    if reduction == "mean":
        return difference.abs().mean()
    return difference.abs().sum(dim=(-2, -1)).mean()


def quadruple_losses(
    model: SpeechDisentangler,
    filterbanks: Float[Tensor, "4 batch frames mels"],
    emotion: Int[Tensor, " batch"],
    style: Int[Tensor, "4 batch"],
    *,
    heard: Float[Tensor, "4 batch frames mels"] | None = None,
    reduction: Literal["mean", "sum"] = "mean",
) -> QuadrupleLosses:
    """The paper's losses on a batch of quadruples.

    The printed cross losses lack a norm; like L_self they use L1 here, as the authors' code does.

    Args:
        model: the disentangler.
        filterbanks: clean clips in the order a1 .. a4 of `swap_partner`.
        emotion: class of each quadruple.
        style: speaker class of each clip.
        heard: what the encoders hear instead, such as augmented copies of the clips.
        reduction: "mean" over elements (authors' code) or "sum" (the printed norm).
    """
    heard = filterbanks if heard is None else heard
    flat = model.encode(rearrange(heard, "k b t m -> (k b) t m"))
    c, e, s = (rearrange(latent, "(k b) d -> k b d", k=4) for latent in flat)
    decoded = {
        "self": (c, e, s),
        "content": (swap_partner(c, "style"), e, s),
        "emotion": (c, swap_partner(e, "content"), s),
        "style": (c, e, swap_partner(s, "content")),
    }
    errors = {}
    for name, latents in decoded.items():
        drawn = model.decode(SpeechLatents(*(latent.flatten(0, 1) for latent in latents)))
        errors[name] = l1_norm(drawn - filterbanks.flatten(0, 1), reduction)
    apart = (c - swap_partner(c, "style"))[:2]
    content = apart.abs().mean() if reduction == "mean" else apart.abs().sum(-1).mean()
    return QuadrupleLosses(
        errors["self"],
        errors["content"],
        errors["emotion"],
        errors["style"],
        content,
        F.cross_entropy(model.emotion_head(flat.emotion), emotion.repeat(4)),
        F.cross_entropy(model.style_head(flat.style), style.flatten()),
    )


class FactorSwapLosses(NamedTuple):
    """The terms that train the shipped model (ours)."""

    reconstruction: Tensor
    emotion: Tensor
    style: Tensor
    cycle: Tensor

    def total(
        self, *, reconstruction: float = 4.0, classification: float = 0.25, cycle: float = 0.05
    ) -> Float[Tensor, ""]:
        """Weighted sum."""
        classes = classification * (self.emotion + self.style)
        return reconstruction * self.reconstruction + classes + cycle * self.cycle


class Donors(NamedTuple):
    """Three clips that share one factor each with a target: its content, emotion, or style."""

    content: Float[Tensor, "batch frames mels"]
    emotion: Float[Tensor, "batch frames mels"]
    style: Float[Tensor, "batch frames mels"]


def factor_swap_losses(
    model: SpeechDisentangler,
    target: Float[Tensor, "batch frames mels"],
    donors: Donors,
    emotion: Int[Tensor, " batch"],
    style: Int[Tensor, " batch"],
    *,
    cycle: bool,
) -> FactorSwapLosses:
    """Build a clip from three others and compare it with the true one (ours).

    A corpus with known factors has the true clip for any combination of content, emotion and
    style, which the paper's quadruples only have where the emotion is the same. With `cycle`,
    the decoded speech must also be recognised by the model's own frozen emotion and style heads.
    """
    c = model.content_encoder(donors.content)
    e = model.emotion_encoder(donors.emotion)
    s = model.style_encoder(donors.style)
    drawn = model.decode(SpeechLatents(c, e, s))
    return FactorSwapLosses(
        l1_norm(drawn - target, "mean"),
        F.cross_entropy(model.emotion_head(e), emotion),
        F.cross_entropy(model.style_head(s), style),
        _recognised(model, drawn, emotion, style) if cycle else target.new_zeros(()),
    )


def _recognised(model, drawn, emotion, style):
    """Cross-entropy of the frozen encoders and heads on decoded speech."""
    judges = (model.emotion_encoder, model.emotion_head, model.style_encoder, model.style_head)
    training = model.training
    for judge in judges:
        judge.requires_grad_(False).eval()
    e, s = model.emotion_encoder(drawn), model.style_encoder(drawn)
    loss = F.cross_entropy(model.emotion_head(e), emotion)
    loss = loss + F.cross_entropy(model.style_head(s), style)
    for judge in judges:
        judge.requires_grad_(True).train(training)
    return loss


def latent_reliance(
    model: SpeechDisentangler, filterbanks: Float[Tensor, "batch frames mels"]
) -> dict[str, float]:
    """Mean L1 of self-reconstruction, and with each latent taken from the next clip instead."""
    with torch.no_grad():
        latents = model.encode(filterbanks)
        errors = {"self": float((model.decode(latents) - filterbanks).abs().mean())}
        for name, latent in latents._asdict().items():
            mixed = latents._replace(**{name: latent.roll(1, dims=0)})
            errors[name] = float((model.decode(mixed) - filterbanks).abs().mean())
    return errors
