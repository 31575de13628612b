"""How good the gestures are: seen by two judges, by their statistics and by their beats.

Any one figure can be fooled: guidance lifts the accuracy above that of real motion, fewer steps
lift it while realism falls, a still body has no jerk. They are to be read together.

Paper:    AM D, E, Tab. 1-2
Notebook: notebooks/17_motion_distances.ipynb
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from s2glib.checkpoint import load_checkpoint
from s2glib.corpus.build import Request, onset_set, timing_of
from s2glib.corpus.script import EMOTIONS, Cell, split
from s2glib.layers import in_batches
from s2glib.papers.amuse.front_end import frame_moments, time_tracks
from s2glib.papers.amuse.latent_denoiser import SpeechCondition
from s2glib.papers.amuse.motion_extractor import MotionExtractor, PositionJudge
from s2glib.papers.amuse.motion_prior import MotionPrior
from s2glib.papers.amuse.pipeline import Amuse
from s2glib.papers.amuse.stress_listener import heard_rhythm
from s2glib.recipes.donors import emotion_donors
from s2glib.recipes.evaluate_beats import beat_rows
from s2glib.recipes.evaluate_frechet import frechet_rows
from s2glib.recipes.evaluate_seams import recordings, seam_rows
from s2glib.recipes.motion_data import motion_windows
from s2glib.recipes.motion_seen import (
    WRISTS,
    Judges,
    Seen,
    look,
    wrist_motion,
    wrist_spread,
)
from s2glib.recipes.report import Row, figure, ratio, share
from s2glib.recipes.speech_clips import Encoded, encode_clips

TRAIN_CLIPS = 1536  # from which the sets for the Frechet distance are drawn
_SEED = 11


def evaluate_amuse_gesture(folder: Path) -> list[Row]:
    """All rows for the checkpoints of a folder, on the test clips.

    Raises:
        FileNotFoundError: if a checkpoint is missing.
        ImportError: without the extra `corpus`, where the cache lacks a clip.
    """
    amuse = Amuse.load(folder)
    judges = Judges(
        load_checkpoint(folder / "amuse-extractor.safetensors", MotionExtractor),
        load_checkpoint(folder / "amuse-position-judge.safetensors", PositionJudge),
    )
    check_statistics(amuse.prior, judges)
    cells, train = split("test"), split("train")
    speech = encode_clips(amuse.speech, cells)
    drawn = np.random.default_rng(_SEED).choice(len(train), TRAIN_CLIPS, replace=False)
    real = look(judges, first_windows(amuse.prior, cells))
    others = look(judges, first_windows(amuse.prior, [train[row] for row in drawn]))
    return [
        *prior_rows(judges, amuse.prior, real, speech.clips.emotion),
        *generator_rows(judges, amuse, real, others, speech),
        *seam_rows(amuse, list(recordings())),
    ]


def check_statistics(prior: MotionPrior, judges: Judges) -> None:
    """Refuse judges that standardise motion otherwise than the prior.

    Raises:
        ValueError: naming the judge.
    """
    known = prior.features.state_dict()
    for judge in judges:
        own = judge.features.state_dict()
        if not all(torch.equal(known[name], own[name]) for name in known):
            raise ValueError(
                f"this {type(judge).__name__} and the prior standardise motion differently; "
                "train both on the same cells"
            )


def first_windows(prior: MotionPrior, cells: list[Cell]) -> Float[Tensor, "n frames features"]:
    """Features of the first window of each clip."""
    return motion_windows(cells, prior.features, prior.config.frames).first()


def prior_rows(
    judges: Judges, prior: MotionPrior, real: Seen, emotion: Int[np.ndarray, " n"]
) -> list[Row]:
    """What real motion gets from the judges, and what is left of it after the prior."""
    through = look(judges, in_batches(prior, real.motion))
    apart = np.linalg.norm(through.places - real.places, axis=-1)[..., WRISTS]
    return [
        *(share(f"GA of real motion, {j}", real.emotion[j] == emotion) for j in real.emotion),
        figure("prior: wrist error, cm", 100 * apart.mean(axis=(1, 2))),
        ratio("prior: spread / real", wrist_spread(through), wrist_spread(real)),
        *accuracy_rows("prior: GA / real", real, through, emotion, emotion),
    ]


def accuracy_rows(
    name: str,
    real: Seen,
    made: Seen,
    emotion: Int[np.ndarray, " n"],
    wanted: Int[np.ndarray, " n"],
    ending: str = "",
) -> list[Row]:
    """By each judge, how often the wanted emotion is seen, over how often the real one is."""
    return [
        ratio(f"{name}, {judge}{ending}", made.emotion[judge] == wanted, seen == emotion)
        for judge, seen in real.emotion.items()
    ]


def generator_rows(
    judges: Judges, amuse: Amuse, real: Seen, others: Seen, speech: Encoded
) -> list[Row]:
    """Gestures for the speech of the clips in `real`, as they are and with another emotion.

    Args:
        judges: who sees the motion.
        amuse: the generator.
        real: the clips' own motion.
        others: real motion of training clips, for the Frechet ratios.
        speech: the clips' speech.
    """
    cells, emotion = speech.clips.cells, speech.clips.emotion
    lent = encode_clips(amuse.speech, emotion_donors(cells, np.random.default_rng(_SEED)))
    condition = first_window_condition(amuse, speech)
    latents = condition.latents._replace(emotion=lent.latents.emotion)
    swapped, wanted = condition._replace(latents=latents), lent.clips.emotion
    made, edited = (look(judges, sample(amuse, wish)) for wish in (condition, swapped))
    plain = with_guidance(amuse, 1.0)
    made_1, edited_1 = (look(judges, sample(plain, wish)) for wish in (condition, swapped))
    alone = ", guidance 1"
    return [
        *accuracy_rows("GA generated / real", real, made, emotion, emotion),
        *accuracy_rows("GA generated / real", real, made_1, emotion, emotion, alone),
        *accuracy_rows("GA edited / real", real, edited, emotion, wanted),
        *accuracy_rows("GA edited / real", real, edited_1, emotion, wanted, alone),
        share("GA edited, old emotion seen, M", edited.emotion["M"] == emotion),
        *frechet_rows(real, made, others),
        *manner_rows(real, made, emotion),
        *beat_rows(real.places, made.places, onset_set([Request(c) for c in cells]), "onsets"),
        *beat_rows(real.places, made.places, [timing_of(c).stress_times for c in cells], "stress"),
        repeat_row(amuse, condition),
    ]


def first_window_condition(amuse: Amuse, speech: Encoded) -> SpeechCondition:
    """What the first seconds of each clip ask of its first motion window."""
    count = len(speech.clips.cells)
    moments = frame_moments(amuse.prior.config.frames).expand(count, -1)
    heard = heard_rhythm(speech.clips.windows, amuse.stress)
    tracks = time_tracks(heard, speech.latents.content, moments, amuse.speech.config)
    return SpeechCondition(speech.latents, tracks, torch.zeros(count, 3, dtype=torch.bool))


def with_guidance(amuse: Amuse, guidance: float) -> Amuse:
    """The same networks, sampled with another guidance."""
    sampling = replace(amuse.sampling, guidance=guidance)
    return Amuse(amuse.speech, amuse.prior, amuse.denoiser, amuse.stress, amuse.face, sampling)


def sample(amuse: Amuse, condition: SpeechCondition) -> Float[Tensor, "n frames features"]:
    """One window for each clip, from noise that is the same at every call."""
    return amuse.sample_windows(condition, generator=torch.Generator().manual_seed(_SEED))


def manner_rows(real: Seen, made: Seen, emotion: Int[np.ndarray, " n"]) -> list[Row]:
    """How far, how fast and how smoothly the wrists move."""
    speeds = {"generated": wrist_motion(made, 1), "real": wrist_motion(real, 1)}
    return [
        ratio("spread of wrists / real", wrist_spread(made), wrist_spread(real)),
        ratio("jerk of wrists / real", wrist_motion(made, 3), wrist_motion(real, 3)),
        ratio("speed of wrists / real", *speeds.values()),
        *(
            _anger_over_sadness(f"wrist speed, anger / sadness, {who}", speed, emotion)
            for who, speed in speeds.items()
        ),
    ]


def _anger_over_sadness(name: str, speed: np.ndarray, emotion: np.ndarray) -> Row:
    """As many clips of the one as there are of the other."""
    angry, sad = (speed[emotion == EMOTIONS.index(name)] for name in ("anger", "sadness"))
    count = min(len(angry), len(sad))
    return ratio(name, angry[:count], sad[:count])


def repeat_row(amuse: Amuse, condition: SpeechCondition, clips: int = 4) -> Row:
    """Whether the same noise gives the same motion, bit for bit."""
    latents = type(condition.latents)(*(latent[:clips] for latent in condition.latents))
    few = SpeechCondition(latents, condition.tracks[:clips], condition.dropped[:clips])
    apart = sample(amuse, few) - sample(amuse, few)
    return Row("same seed twice, largest difference", float(apart.abs().max()), len(apart))
