"""The Predictor: hears speech, sees what motion is given, and fills in the hidden tokens.

Paper:    PT A.2
Notebook: notebooks/06_masked_prediction.ipynb
"""

from collections.abc import Iterator
from functools import partial
from itertools import cycle

import torch
from einops import rearrange
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from s2glib.layers import GatedConv, sinusoidal_embedding
from s2glib.papers.probtalk.config import PredictorConfig
from s2glib.papers.probtalk.masking import DecodingStep, decode
from s2glib.papers.probtalk.pqvae import Resample
from s2glib.papers.probtalk.style_decoder import StyleDecoder

WINDOW = 8  # frames of a token: three halvings  [PT A.2]
_GATED = 10  # convolutions of the context encoder  [PT A.2]


def audio_encoder(config: PredictorConfig) -> nn.Sequential:
    """Three strided convolutions [PT A.2] after a projection; (batch, speech, frames) comes in.

    Projection, dropout and the convolutions' skips: authors' code.
    """
    width = config.audio_width
    layers = [nn.Conv1d(config.speech, width, 1), nn.BatchNorm1d(width), nn.LeakyReLU(0.1)]
    for _ in range(3):
        layers += [nn.Dropout(config.dropout), Resample(nn.Conv1d, width, width)]
    return nn.Sequential(*layers, nn.Dropout(config.dropout))


def context_encoder(config: PredictorConfig) -> nn.Sequential:
    """Ten gated convolutions [PT A.2] after a projection; (batch, motion + parts, frames) comes in.

    Number 2, 4 and 6, counted from 0, halve time; kernels and widths: authors' code.
    """
    narrow, middle, wide = config.context_widths
    widths = [narrow] * 4 + [middle] * 2 + [wide] * (_GATED - 6)
    layers: list[nn.Module] = [nn.Conv1d(config.motion + config.context_parts, narrow, 1)]
    layers.append(GatedConv(narrow, narrow, 7))
    for number in range(1, _GATED):
        halves = number in (2, 4, 6)
        kernel, stride = (4, 2) if halves else (3, 1)
        layers.append(GatedConv(widths[number - 1], widths[number], kernel, stride))
    return nn.Sequential(*layers)


class Predictor(nn.Module):
    """Log-odds of every code at every place: 22 tokens in time x 4 groups, at once.

    The mask is one more code, `mask`: a token that is hidden.
    """

    config_class = PredictorConfig

    def __init__(self, config: PredictorConfig):
        super().__init__()
        self.config, self.mask = config, config.codes
        width = config.width
        self.audio = audio_encoder(config)
        self.context = context_encoder(config)
        both = config.audio_width + config.context_widths[-1]
        self.join = nn.Conv1d(both, width, 1)
        tables = config.groups if config.own_codes else 1  # all groups share one; authors' code
        self.embed = nn.ModuleList(nn.Embedding(config.codes + 1, width) for _ in range(tables))
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
        self.head = nn.Sequential(nn.Linear(width, width), nn.ReLU())
        self.odds = nn.ModuleList(nn.Linear(width, config.codes) for _ in range(tables))

    def listen(
        self,
        speech: Float[Tensor, "batch frames speech"],
        context: Float[Tensor, "batch frames motion"],
        context_mask: Bool[Tensor, "batch frames parts"],
    ) -> Float[Tensor, "batch time width"]:
        """What the tokens look at: speech and given motion, at their rate, with places in time.

        Args:
            speech: of every frame; frames are a multiple of 8.
            context: given motion; zero where none is given.
            context_mask: true where motion is given; as many columns as `config.context_parts`.
        """
        given = torch.cat([context, context_mask.to(context)], dim=-1)
        both = torch.cat([self.context(given.mT), self.audio(speech.mT)], dim=1)
        memory = self.join(both).mT
        return memory + _places(memory.shape[1], memory)

    def predict(
        self,
        memory: Float[Tensor, "batch time width"],
        speaker: Int[Tensor, " batch"],
        codes: Int[Tensor, "batch time groups"],
        *,
        unheard: Float[Tensor, "batch time width"] | None = None,
        guidance: float = 1.0,
    ) -> Float[Tensor, "batch time groups codes"]:
        """Log-odds, from what `listen` gave and tokens of which some are hidden.

        Args:
            memory: what `listen` gave.
            speaker: whose manner it is.
            codes: the tokens.
            unheard: what `listen` gives for the same context and speech of zeros; for guidance.
            guidance: above 1, log-odds go from those of `unheard` beyond those heard (ours, after
                [MDD Eq. B16]); 1 is none.

        Raises:
            ValueError: if there is guidance, but no `unheard`.
        """
        if guidance != 1:
            if unheard is None:
                raise ValueError(
                    f"guidance {guidance} goes on from what is unheard; give what `listen` makes "
                    "of the same context and speech of zeros"
                )
            heard, deaf = (self.predict(m, speaker, codes) for m in (memory, unheard))
            return guidance * heard + (1 - guidance) * deaf
        time, groups = codes.shape[1:]
        named = zip(codes.unbind(dim=2), cycle(self.embed), strict=False)
        tokens = torch.stack([embed(of_group) for of_group, embed in named], dim=2)
        tokens = tokens + _places(time, tokens)[:, None] + _places(groups, tokens)  # 2-D positions
        if self.config.aligned:
            tokens = tokens + memory[:, :, None]
        mixed = self.decoder(rearrange(tokens, "b t g w -> b (t g) w"), memory, speaker)
        features = rearrange(self.head(mixed), "b (t g) w -> g b t w", g=groups)
        guesses = zip(features, cycle(self.odds), strict=False)
        return torch.stack([odds(of_group) for of_group, odds in guesses], dim=2)

    def forward(
        self,
        codes: Int[Tensor, "batch time groups"],
        speech: Float[Tensor, "batch frames speech"],
        context: Float[Tensor, "batch frames motion"],
        context_mask: Bool[Tensor, "batch frames parts"],
        speaker: Int[Tensor, " batch"],
    ) -> Float[Tensor, "batch time groups codes"]:
        """Log-odds of every code; arguments as in `listen` and `predict`."""
        return self.predict(self.listen(speech, context, context_mask), speaker, codes)

    def hidden(self, memory: Float[Tensor, "batch time width"]) -> Int[Tensor, "batch time groups"]:
        """Tokens of which nothing is known: where decoding starts."""
        shape = (*memory.shape[:2], self.config.groups)
        return torch.full(shape, self.mask, device=memory.device)

    def decode(
        self,
        memory: Float[Tensor, "batch time width"],
        speaker: Int[Tensor, " batch"],
        *,
        unheard: Float[Tensor, "batch time width"] | None = None,
        guidance: float = 1.0,
        steps: int = 8,
        temperature: float = 1.0,
        generator: torch.Generator,
    ) -> Iterator[DecodingStep]:
        """All tokens, the surest first; yields every state of the decoding, the last one whole.

        Args:
            memory: what `listen` gave.
            speaker: whose manner it is.
            unheard: for guidance, see `predict`.
            guidance: how much the speech counts: 1 as in training, 0 not at all.
            steps: how many.
            temperature: of the choice of codes, above 0.
            generator: source of chance.

        Raises:
            ValueError: if there is no step, the temperature is not above 0, or there is guidance
                without `unheard`.
        """
        return decode(
            partial(self.predict, memory, speaker, unheard=unheard, guidance=guidance),
            self.hidden(memory),
            mask=self.mask,
            steps=steps,
            temperature=temperature,
            generator=generator,
        )


def _places(count: int, like: Tensor) -> Float[Tensor, "count width"]:
    """Fixed sines and cosines of places 1, 2, ... (authors' code)."""
    places = torch.arange(1, count + 1, device=like.device)
    return sinusoidal_embedding(places, like.shape[-1]).to(like)
