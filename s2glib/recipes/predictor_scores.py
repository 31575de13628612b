"""How well codes are foretold, how much of that is due to the speech, and whether beats are kept.

Paper:    PT A.2; beats: PT B (BC), AM E (BA)
Notebook: notebooks/17_motion_distances.ipynb
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor
from torch.nn import functional as F

from s2glib.corpus.build import timing_of
from s2glib.corpus.script import SPEAKERS
from s2glib.layers import in_batches
from s2glib.metrics import derivative_sizes
from s2glib.papers.probtalk import PQVAE, Predictor
from s2glib.papers.probtalk.motion_features import POINTS
from s2glib.papers.probtalk.pipeline import Asked, ProbTalk
from s2glib.papers.probtalk.speech_features import MOTION_FPS
from s2glib.recipes.evaluate_beats import beat_rows
from s2glib.recipes.holistic_data import HolisticClips
from s2glib.recipes.holistic_seen import NINE, held, joints_of

GUIDANCES = (1.0, 1.5, 2.0, 2.5, 3.0)
_APART = 0.2  # share by which wrists may be faster or slower than real ones
MARGINS = tuple(
    f"beat margin / real, {way}, stress" for way in ("motion to audio", "audio to motion")
)
SPEED = "speed of wrists / real"
_SEED = 11
_WRISTS = [place for place, name in enumerate(POINTS) if name.endswith("wrist")]


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


def predictor_scores(
    pqvae: PQVAE,
    predictor: Predictor,
    clips: HolisticClips,
    guidances: Sequence[float] = (1.0,),
) -> dict[str, float]:
    """Figures of a trained Predictor on held-out clips, without the Refiner."""
    windows = held_out(clips, pqvae.config.frames)
    asked = nothing_given(windows)
    return {
        **token_scores(pqvae, predictor, windows, asked),
        **rhythm_scores(ProbTalk(pqvae, predictor), clips, windows, asked, guidances),
    }


def wise_guidance(figures: dict[str, float], guidances: Sequence[float] = GUIDANCES) -> float:
    """The guidance of the best beats, of those that leave wrists about as fast as real ones.

    Args:
        figures: of `rhythm_scores`.
        guidances: which were tried; 1 is what is left if all are too fast or too slow.
    """

    def about(guidance: float) -> list[float]:
        """Wrist speed, and both beat margins."""
        end = f", guidance {guidance:g}"
        return [figures[name + end] for name in (SPEED, *MARGINS)]

    fit = [each for each in guidances if abs(about(each)[0] - 1) <= _APART]
    return max(fit, key=lambda each: sum(about(each)[1:]), default=1.0)


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


def rhythm_scores(
    probtalk: ProbTalk,
    clips: HolisticClips,
    windows: HeldOut,
    asked: Asked,
    guidances: Sequence[float],
) -> dict[str, float]:
    """Beat margins and wrist speed over real ones: of real motion through its codes, and sampled.

    Sampled motion is that of each guidance.
    """
    stresses = [timing_of(cell).stress_times for cell in clips.cells]

    def places(motion: Tensor) -> Float[np.ndarray, "n frames 9 3"]:
        seen = in_batches(lambda m: joints_of(probtalk.pqvae.features, m)[..., NINE, :], motion)
        return seen.double().numpy()

    real = places(windows.motion)
    speed = wrist_speed(real, windows.lengths)

    def rhythm(motion: Tensor, kind: str) -> dict[str, float]:
        moved = places(held(motion, windows.lengths))
        rows = beat_rows(real, moved, stresses, "stress", windows.lengths)
        found = {f"{row.name}, {kind}": row.value for row in rows if row.name in MARGINS}
        return found | {f"{SPEED}, {kind}": wrist_speed(moved, windows.lengths) / speed}

    found = rhythm(in_batches(lambda m: probtalk.pqvae(m).motion, windows.motion), "decoded")
    for guidance in guidances:
        chance = torch.Generator().manual_seed(_SEED)
        made = probtalk.sample(asked, guidance=guidance, generator=chance)
        found |= rhythm(made, f"guidance {guidance:g}")
    return found


def wrist_speed(places: Float[np.ndarray, "n frames 9 3"], lengths: Int[np.ndarray, " n"]) -> float:
    """Metres a second, mean over the clips' own frames and both wrists."""
    clips = zip(places[:, :, _WRISTS], lengths, strict=True)
    sizes = [derivative_sizes(clip[:n], float(MOTION_FPS), order=1).mean() for clip, n in clips]
    return float(np.mean(sizes))
