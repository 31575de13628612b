"""How well codes are foretold, how much of that is due to the speech, and whether beats are kept.

Paper:    PT A.2; beats: PT B (BC), AM E (BA)
Notebook: notebooks/17_motion_distances.ipynb
"""

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor
from torch.nn import functional as F

from s2glib.corpus.build import timing_of
from s2glib.corpus.script import SPEAKERS
from s2glib.layers import in_batches
from s2glib.papers.probtalk import PQVAE, Predictor
from s2glib.papers.probtalk.pipeline import Asked, ProbTalk
from s2glib.recipes.evaluate_beats import beat_rows
from s2glib.recipes.holistic_data import HolisticClips, spoken_cell
from s2glib.recipes.holistic_seen import NINE, held, joints_of

_SEED = 11


class HeldOut(NamedTuple):
    """First windows of clips; after a clip's end its last frame is held.

    Attributes:
        motion: standardised features.
        speech: of the same frames.
        speaker: whose it is.
        lengths: frames that are not held.
    """

    motion: Float[Tensor, "n frames size"]
    speech: Float[Tensor, "n frames channels"]
    speaker: Int[Tensor, " n"]
    lengths: Int[np.ndarray, " n"]


def held_out(clips: HolisticClips, frames: int) -> HeldOut:
    """The first window of every clip, with its speech and speaker."""
    rows = np.arange(len(clips.cells))
    speaker = torch.tensor([SPEAKERS.index(cell.speaker) for cell in clips.cells])
    heard = clips.heard(rows, np.zeros_like(rows), frames)
    lengths = clips.motion.lengths.clip(max=frames)
    return HeldOut(clips.first(frames), heard, speaker, lengths)


def predictor_scores(pqvae: PQVAE, predictor: Predictor, clips: HolisticClips) -> dict[str, float]:
    """Figures of a trained Predictor on held-out clips, without the Refiner."""
    windows = held_out(clips, pqvae.config.frames)
    asked = nothing_given(windows)
    return {
        **token_scores(pqvae, predictor, windows, asked),
        **beat_margins(ProbTalk(pqvae, predictor), clips, windows, asked),
    }


def nothing_given(windows: HeldOut) -> Asked:
    """Motion for the speech of windows, of which nothing is known."""
    known = torch.zeros(*windows.motion.shape[:2], 4, dtype=torch.bool)
    return Asked(windows.speech, torch.zeros_like(windows.motion), known, windows.speaker)


def token_scores(
    pqvae: PQVAE, predictor: Predictor, windows: HeldOut, asked: Asked
) -> dict[str, float]:
    """Cross-entropy of all tokens at once, with their speech and with that of another clip.

    The second says what the speech is worth: without it a Predictor knows only how often codes are.
    Tokens after a clip's end do not count.
    """
    codes = in_batches(pqvae.encode, windows.motion)
    begins = torch.arange(codes.shape[1]) * pqvae.config.window
    real = begins < torch.from_numpy(windows.lengths)[:, None]

    def log_odds(asked: Asked) -> Tensor:
        mask = asked.known[..., : predictor.config.context_parts]
        memory = predictor.listen(asked.speech, asked.given, mask)
        return predictor.predict(memory, asked.speaker, predictor.hidden(memory))

    ring = np.random.default_rng(_SEED).permutation(len(codes))
    partners = np.empty_like(ring)
    partners[ring] = np.roll(ring, 1)
    other = asked._replace(speech=asked.speech[torch.from_numpy(partners)])
    own, others = (in_batches(log_odds, each)[real].flatten(0, 1) for each in (asked, other))
    wanted = codes[real].flatten()
    return {
        "cross-entropy": float(F.cross_entropy(own, wanted)),
        "cross-entropy, another's speech": float(F.cross_entropy(others, wanted)),
        "token accuracy": float((own.argmax(-1) == wanted).float().mean()),
    }


def beat_margins(
    probtalk: ProbTalk, clips: HolisticClips, windows: HeldOut, asked: Asked
) -> dict[str, float]:
    """Beat margins of sampled motion, and of real motion decoded from its codes, over real ones."""
    made = probtalk.sample(asked, generator=torch.Generator().manual_seed(_SEED))
    through = in_batches(lambda motion: probtalk.pqvae(motion).motion, windows.motion)
    stresses = [timing_of(spoken_cell(cell)).stress_times for cell in clips.cells]

    def places(motion: Tensor) -> Float[np.ndarray, "n frames 9 3"]:
        seen = in_batches(lambda m: joints_of(probtalk.pqvae.features, m)[..., NINE, :], motion)
        return seen.double().numpy()

    real = places(windows.motion)
    found: dict[str, float] = {}
    for kind, motion in (("sampled", made), ("decoded", through)):
        moved = places(held(motion, windows.lengths))
        rows = beat_rows(real, moved, stresses, "stress", windows.lengths)
        margins = (row for row in rows if row.name.startswith("beat margin / real"))
        found |= {f"{row.name}, {kind}": row.value for row in margins}
    return found
