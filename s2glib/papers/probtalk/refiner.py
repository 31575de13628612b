"""The Refiner: what the codes could not say is put back, and what is known is met without a jump.

Paper:    PT A.3, Eqs. 8-10
Notebook: notebooks/07_refiner.ipynb
"""

from typing import Literal, NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from s2glib.layers import sinusoidal_embedding
from s2glib.papers.probtalk.config import RefinerConfig
from s2glib.papers.probtalk.keeping import eased
from s2glib.papers.probtalk.motion_features import PARTS, HolisticFeatures
from s2glib.papers.probtalk.style_decoder import StyleDecoder

Frames = Float[Tensor, "batch frames features"]
Known = Bool[Tensor, "batch frames features"]
ContextMask = Bool[Tensor, "batch frames parts"]
_GRAINS = ("jaw", "body", "hands", "expression")  # that weigh the same in the loss; authors' code


class Refiner(nn.Module):
    """The Predictor's decoder at frame rate, without its embedding of codes  [PT A.3]."""

    config_class = RefinerConfig

    def __init__(self, config: RefinerConfig):
        super().__init__()
        self.config = config
        self.features = HolisticFeatures(config.expression)
        size, width = self.features.size, config.width
        heard = config.speech + 2 * config.context_parts
        self.embed = nn.Conv1d(size, width, config.reach, padding="same")
        self.listen = nn.Conv1d(heard, width, config.reach, padding="same")
        self.decoder = StyleDecoder(
            config.layers,
            width,
            config.heads,
            config.hidden,
            speakers=config.speakers,
            style_dim=config.style,
            style_norm=config.style_norm,
            dropout=config.dropout,
        )
        last = nn.Linear(config.head, size)
        self.head = nn.Sequential(nn.Linear(width, config.head), nn.ReLU(), last)
        if config.adds:  # nothing, at first
            for parameter in last.parameters():
                nn.init.zeros_(parameter)

    def forward(
        self,
        motion: Frames,
        speech: Float[Tensor, "batch frames speech"],
        context_mask: ContextMask,
        speaker: Int[Tensor, " batch"],
    ) -> Frames:
        """Refine motion  [PT Eq. 9].

        Args:
            motion: known where the mask says so, elsewhere decoded from codes  [PT Eq. 8].
            speech: of every frame.
            context_mask: I, true where motion is given; as many columns as `context_parts`.
            speaker: D, whose manner it is.
        """
        kept = context_mask.to(motion)
        heard = self.listen(torch.cat([speech, 1 - kept, kept], dim=-1).mT).mT
        frames = torch.arange(1, motion.shape[1] + 1, device=motion.device)
        places = sinusoidal_embedding(frames, self.config.width).to(motion)
        tokens = self.embed(motion.mT).mT + places
        if self.config.aligned:
            tokens = tokens + heard
        made = self.head(self.decoder(tokens, heard + places, speaker))
        return motion + made if self.config.adds else made

    def known(self, context_mask: ContextMask) -> Known:
        """The mask, spread to the numbers of every frame."""
        return self.features.of_parts(context_mask.expand(-1, -1, len(PARTS)))

    def meet(self, given: Frames, made: Frames, known: Known) -> Frames:
        """The input  [PT Eq. 8]; if the config says so, without a jump between the two (ours)."""
        return (eased if self.config.eased else fill)(given, made, known)

    def refine(
        self,
        given: Frames,
        made: Frames,
        speech: Float[Tensor, "batch frames speech"],
        context_mask: ContextMask,
        speaker: Int[Tensor, " batch"],
    ) -> Frames:
        """Refine what was made; what is known comes out as it was given (authors' code).

        It is met as the input is, see `meet`.
        """
        known = self.known(context_mask)
        refined = self(self.meet(given, made, known), speech, context_mask, speaker)
        return self.meet(given, refined, known)


def fill(given: Frames, made: Frames, known: Known) -> Frames:
    """Eq. 8: I * given + (1 - I) * made."""
    return torch.where(known, given, made)


class RefinerLosses(NamedTuple):
    """The terms of Eq. 10: L1 of each part, and of the changes from frame to frame.

    The authors' code leaves the expression out of the changes.
    """

    jaw: Float[Tensor, ""]
    body: Float[Tensor, ""]
    hands: Float[Tensor, ""]
    expression: Float[Tensor, ""]
    velocity: Float[Tensor, ""]

    def total(self, *, velocity: float = 1.0) -> Float[Tensor, ""]:
        """L_refine  [PT Eq. 10]; the mean over the parts: authors' code."""
        return (self.jaw + self.body + self.hands + self.expression) / 4 + velocity * self.velocity


def refiner_losses(
    motion: Frames,
    refined: Frames,
    known: Known,
    features: HolisticFeatures,
    *,
    region: Literal["unknown", "known"] = "unknown",
) -> RefinerLosses:
    """The Refiner's terms for a batch of windows.

    Args:
        motion: the true windows.
        refined: the Refiner's output.
        known: I of every number.
        features: where the parts are.
        region: where refined motion is compared with the true one. The text's Eq. 10 has I, where
            the input already is the true motion (Eq. 8): that teaches to copy. The authors' code,
            and the default here, have the rest.
    """
    compared = (known if region == "known" else ~known).to(motion)
    apart = motion - refined
    parts = {}
    for name in _GRAINS:
        where = features.parts[name]
        count = compared[..., where].sum().clamp_min(1)  # a batch may know a part throughout
        parts[name] = (compared * apart)[..., where].abs().sum() / count
    return RefinerLosses(**parts, velocity=apart.diff(dim=-2).abs().mean())
