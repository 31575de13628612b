"""How good ProbTalk's motion is: as a crowd, against the one truth, on the beat, with what is kept.

All of it with and without the Refiner, and with 1 to 16 steps of decoding.

Paper:    PT B, Tab. 7, Fig. 6
Notebook: notebooks/17_motion_distances.ipynb
"""

from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.checkpoint import load_checkpoint
from s2glib.corpus.script import split
from s2glib.papers.probtalk import Asked, FeatureNets, ProbTalk
from s2glib.recipes.code_scores import code_rows, study_rows
from s2glib.recipes.evaluate_holistic import (
    Truth,
    crowd_rows,
    manner_rows,
    real_rows,
    rhythm_rows,
    truth_of,
    truth_rows,
)
from s2glib.recipes.evaluate_refiner import context_rows, refiner_rows
from s2glib.recipes.evaluate_variety import variety_rows
from s2glib.recipes.holistic_data import HolisticClips, holistic_clips
from s2glib.recipes.holistic_seen import Seen, half_codes, look
from s2glib.recipes.holistic_speech import log_mel_tracks
from s2glib.recipes.predictor_scores import held_out, nothing_given
from s2glib.recipes.probtalk_speakers import speaker_rows
from s2glib.recipes.report import Row

CLIPS = 192  # of the test clips, which come in a random order
OTHERS = 512  # training clips, which real clips are compared with
STEPS = (1, 2, 4, 8, 16)
DEFAULT_STEPS = 8  # authors' code
_SEED = 11


def evaluate_probtalk(folder: Path) -> list[Row]:
    """All rows for the checkpoints of a folder, on the test clips.

    Raises:
        FileNotFoundError: if a checkpoint is missing.
        ImportError: without the extra `corpus`, where the cache lacks a clip.
    """
    probtalk = ProbTalk.load(folder)
    nets = load_checkpoint(folder / "probtalk-features.safetensors", FeatureNets)
    check_statistics(probtalk, nets)
    clips = holistic_clips(split("test")[:CLIPS], nets.features, hear=log_mel_tracks)
    frames = probtalk.pqvae.config.frames
    truth = truth_of(nets, clips, frames, other_codes(nets, frames))
    return [
        *code_rows(folder),
        *refiner_rows(probtalk, clips),
        *generated_rows(probtalk, nets, clips, truth),
        *context_rows(probtalk, clips),
        *variety_rows(probtalk, clips),
    ]


def check_statistics(probtalk: ProbTalk, nets: FeatureNets) -> None:
    """Refuse feature networks that standardise motion otherwise than the PQ-VAE.

    Raises:
        ValueError: if they do.
    """
    known, own = (model.features.state_dict() for model in (probtalk.pqvae, nets))
    if not all(torch.equal(known[name], own[name]) for name in known):
        raise ValueError(
            "the feature networks and the PQ-VAE standardise motion differently; train "
            "probtalk-features after probtalk-pqvae, in the same folder"
        )


def other_codes(nets: FeatureNets, frames: int) -> dict[str, Float[np.ndarray, "m code"]]:
    """What FGD's networks make of some training clips."""
    train = split("train")
    drawn = np.random.default_rng(_SEED).choice(len(train), OTHERS, replace=False)
    clips = holistic_clips([train[row] for row in drawn], nets.features)
    return half_codes(nets, clips.first(frames), clips.motion.lengths)


def generated_rows(
    probtalk: ProbTalk, nets: FeatureNets, clips: HolisticClips, truth: Truth
) -> list[Row]:
    """Motion from nothing but speech."""
    asked = nothing_given(held_out(clips, probtalk.pqvae.config.frames))

    def seen(system: ProbTalk, steps: int) -> Seen:
        return look(nets, sampled(system, asked, steps), truth.seen.lengths)

    plain = seen(ProbTalk(probtalk.pqvae, probtalk.predictor, None, probtalk.hear), DEFAULT_STEPS)
    made = {steps: seen(probtalk, steps) for steps in STEPS}
    rows = real_rows(truth)
    for name, one in (("refined", made[DEFAULT_STEPS]), ("not refined", plain)):
        rows += crowd_rows(truth, one, name) + truth_rows(truth, one, name)
        rows += rhythm_rows(truth, one, name) + manner_rows(truth, one, name)
    for steps, one in made.items():
        name = f"{steps} step{'s' * (steps > 1)}"
        rows += crowd_rows(truth, one, name) + rhythm_rows(truth, one, name)
    return rows


def sampled(system: ProbTalk, asked: Asked, steps: int) -> Float[Tensor, "n frames motion"]:
    """One window for each clip; at every call the same chance."""
    return system.sample(asked, steps=steps, generator=torch.Generator().manual_seed(_SEED))


def recorded_rows(runs: Path) -> list[Row]:
    """The study of codes, and one voice beside all of them.

    Raises:
        FileNotFoundError: if there is no record.
    """
    return [*study_rows(runs), *speaker_rows(runs)]
