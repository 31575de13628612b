"""The unmasking stepper: go through a decoding step by step, and see tokens and body fill in.

Paper:    PT A.2 (iterative decoding: authors' code, after MaskGIT)
Notebook: notebooks/06_masked_prediction.ipynb
"""

from functools import partial
from typing import NamedTuple

import ipywidgets
import torch
from jaxtyping import Bool, Float, Int
from matplotlib.axes import Axes
from torch import Tensor
from torch.nn import functional as F

from s2glib.audio import Waveform
from s2glib.body import BodyModel, Motion
from s2glib.papers.probtalk import PARTS, PQVAE, Asked, ProbTalk
from s2glib.papers.probtalk.keeping import embody
from s2glib.papers.probtalk.masking import decode
from s2glib.papers.probtalk.speech_features import MOTION_FPS
from s2glib.viz import draw_tokens
from s2glib.widgets.player import Player
from s2glib.widgets.token_grid import token_grid

STEPS, MOST_STEPS = 8, 16
DRAWS = 10  # different chances to choose from
START = "Nothing is decoded yet: all {tokens} tokens are hidden."
TOLD = (
    "Step {step} of {steps}: {known} of {tokens} tokens are known, {new} of them new, chosen with "
    "probabilities from {least:.1%} to {most:.1%}. {hidden} were drawn and hidden again."
)


class Unmasked(NamedTuple):
    """One state of a decoding.

    Attributes:
        codes: the mask's number where a token is hidden.
        known: tokens that stay.
        new: those that became known in this step.
        log_p: log-probability of every known token's code when it was chosen, else nan.
        motion: of the known tokens; a hidden one is the mean of what the predictor expects.
    """

    codes: Int[Tensor, "time groups"]
    known: Bool[Tensor, "time groups"]
    new: Bool[Tensor, "time groups"]
    log_p: Float[Tensor, "time groups"]
    motion: Motion


class UnmaskingStepper(ipywidgets.VBox):
    """Step through the decoding of a recording's first window.

    Args:
        probtalk: the trained networks; the refiner is not used.
        waveform: speech.
        body: who moves.
        speaker: whose manner it is.

    Attributes:
        states: all of this decoding, the first with nothing known, the last whole.

    Raises:
        TypeError: if something is of another type.
        ValueError: if there is no such speaker, or codes are no product codes.
    """

    def __init__(
        self, probtalk: ProbTalk, waveform: Waveform, body: BodyModel, *, speaker: int = 0
    ) -> None:
        self._probtalk = check_product_codes(probtalk)
        probtalk.check(waveform, speaker)
        config = probtalk.pqvae.config
        frames, self._pace = config.frames, config.window / MOTION_FPS
        self._codes = config.codes
        nothing = torch.zeros(frames, len(PARTS), dtype=torch.bool)
        self._asked = probtalk.ask(waveform, frames, None, nothing, speaker)
        end = round(frames / MOTION_FPS * waveform.sample_rate)
        self._sound = Waveform(waveform.samples[:end], waveform.sample_rate)
        self.steps = _slider("steps in all", 1, MOST_STEPS, STEPS)
        self.draw_number = _slider("draw", 1, DRAWS, 1)
        self.step = _slider("step", 0, STEPS, 0)
        self.again = ipywidgets.Button(description="Start again")
        self.next = ipywidgets.Button(description="Next step")
        self._grid, self.told = ipywidgets.HTML(), ipywidgets.HTML()
        self._decode()
        self.player = Player(self.state.motion, self._sound, body, height=340)
        for each in (self.steps, self.draw_number):
            each.observe(self._begin, names="value")
        self.step.observe(self._show, names="value")
        self.again.on_click(lambda _: self.go(0))
        self.next.on_click(lambda _: self.go(self.step.value + 1))
        rows = [self.steps, self.draw_number], [self.again, self.next, self.step]
        super().__init__([*map(_row, rows), self._grid, self.told, self.player])
        self._tell()

    def choose(self, *, steps: int, draw: int) -> None:
        """Move the sliders that say how to decode, as a reader would."""
        self.steps.value, self.draw_number.value = steps, draw

    def go(self, step: int) -> None:
        """Show the state after a step; beyond the last one there is nothing."""
        self.step.value = min(max(step, 0), self.steps.value)

    @property
    def state(self) -> Unmasked:
        """What is shown."""
        return self.states[self.step.value]

    def draw(self, axes: Axes) -> Axes:
        """Draw the tokens as they are now: what is seen where no kernel runs."""
        state = self.state
        tables = (state.log_p.numpy(), state.new.numpy())
        return draw_tokens(axes, *tables, codes=self._codes, seconds=self._pace)

    def _decode(self) -> None:
        generator = torch.Generator().manual_seed(self.draw_number.value)
        self.states = unmask(
            self._probtalk, self._asked, steps=self.steps.value, generator=generator
        )

    def _begin(self, _change) -> None:
        self._decode()
        self.step.max = self.steps.value
        self._show()

    def _show(self, _change=None) -> None:
        self.player.show(self.state.motion, self._sound)
        self._tell()

    def _tell(self) -> None:
        state, words = self.state, START.format(tokens=self.state.known.numel())
        if state.new.any():
            chances = state.log_p[state.new].exp()
            words = TOLD.format(
                step=self.step.value,
                steps=self.steps.value,
                tokens=state.known.numel(),
                known=int(state.known.sum()),
                new=int(state.new.sum()),
                least=float(chances.min()),
                most=float(chances.max()),
                hidden=int((~state.known).sum()),
            )
        tables = (state.codes.numpy(), state.log_p.numpy(), state.new.numpy())
        drawn = self.step.value > 0
        picture = token_grid(*tables, codes=self._codes, seconds=self._pace, drawn=drawn)
        self._grid.value = f'<div role="img" aria-label="{words}">{picture}</div>'
        self.told.value = f'<p role="status" aria-live="polite">{words}</p>'

    def __repr__(self) -> str:
        return "UnmaskingStepper: a decoding, step by step. Needs a running kernel; or .draw(axes)"


@torch.no_grad()
def unmask(
    probtalk: ProbTalk, asked: Asked, *, steps: int, generator: torch.Generator
) -> list[Unmasked]:
    """All states of the decoding of one window, from nothing known to everything."""
    predictor, codes = probtalk.predictor, probtalk.pqvae.config.codes
    parts = asked.known[..., : predictor.config.context_parts]
    memory = predictor.listen(asked.speech, asked.given, parts)
    unheard = predictor.listen(torch.zeros_like(asked.speech), asked.given, parts)
    odds = partial(predictor.predict, unheard=unheard, guidance=predictor.config.guidance)
    heard: list[Tensor] = []  # log-probabilities, given every state but the last

    def predict(tokens: Tensor) -> Tensor:
        heard.append(odds(memory, asked.speaker, tokens).log_softmax(-1))
        return heard[-1]

    start = predictor.hidden(memory)
    later = decode(predict, start, mask=predictor.mask, steps=steps, generator=generator)
    tables = torch.cat([start, *(state.codes for state in later)])  # (steps + 1, time, groups)
    known = tables != predictor.mask
    new = known.diff(dim=0, prepend=known[:1])
    before = torch.cat([heard[0], *heard])
    chosen = before.gather(-1, tables.clamp_max(codes - 1)[..., None])[..., 0]
    log_p = (chosen * new).cumsum(0).masked_fill(~known, torch.nan)
    tracks = expected_motion(probtalk.pqvae, tables, torch.cat([*heard, heard[-1]]))
    motions = map(partial(_standing, probtalk.pqvae), tracks)
    return list(map(Unmasked, tables.cpu(), known.cpu(), new.cpu(), log_p.cpu(), motions))


def expected_motion(
    pqvae: PQVAE, tokens: Int[Tensor, "b time groups"], log_p: Float[Tensor, "b time groups codes"]
) -> Float[Tensor, "b frames size"]:
    """Motion of tokens; where one is hidden, the mean of its vectors by their probabilities."""
    codes = pqvae.config.codes
    hidden = (tokens == codes)[..., None]
    shares = torch.where(hidden, log_p.exp(), F.one_hot(tokens, codes + 1)[..., :-1].to(log_p))
    vectors = torch.einsum("btgc,gcd->btgd", shares, pqvae.quantizer.codebooks)
    return pqvae.from_latents(vectors.flatten(-2))


def _standing(pqvae: PQVAE, track: Float[Tensor, "frames size"]) -> Motion:
    features = pqvae.features
    nothing = torch.zeros(len(track), len(PARTS), dtype=torch.bool)
    return embody(features.to_poses(track), features.to_expression(track), None, nothing)


def check_product_codes(probtalk: ProbTalk) -> ProbTalk:
    """Refuse what is no ProbTalk, or has codes that are no product codes."""
    if not isinstance(probtalk, ProbTalk):
        raise TypeError(f"probtalk must be a ProbTalk, got {type(probtalk).__name__}; load one")
    if probtalk.pqvae.config.quantizer == "residual":
        raise ValueError("the groups of residual codes hang together; take product codes")
    return probtalk


def _slider(name: str, low: int, high: int, value: int) -> ipywidgets.IntSlider:
    style, layout = {"description_width": "6em"}, {"width": "24em"}
    words = {"description": name, "style": style, "layout": layout}
    return ipywidgets.IntSlider(value, low, high, continuous_update=False, **words)


def _row(children: list[ipywidgets.Widget]) -> ipywidgets.HBox:
    return ipywidgets.HBox(children, layout={"flex_flow": "row wrap"})
