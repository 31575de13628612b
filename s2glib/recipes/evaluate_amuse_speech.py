"""How well speech is taken apart: accuracy, cross-reconstruction, reliance, edits, leakage.

Low reconstruction errors prove little: a latent that is ignored can be swapped for free, and a
content latent that carries everything makes an edit do nothing. So every error stands beside a
reliance, and every edit before a judge that had no part in training.

Paper:    AM B.2, B.4, Tab. A.1-A.2
Notebook: notebooks/09_disentanglement.ipynb
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from torch import Tensor

from s2glib.checkpoint import load_checkpoint
from s2glib.corpus.script import split
from s2glib.metrics import classification_report
from s2glib.papers.amuse.cross_reconstruction import swap_partner
from s2glib.papers.amuse.disentangler import SpeechDisentangler, SpeechLatents
from s2glib.papers.amuse.speech_judge import SpeechJudge
from s2glib.recipes.donors import strangers
from s2glib.recipes.evaluate_speech_edits import edit_rows, judge_rows, unseen_voice_row
from s2glib.recipes.report import Row, figure, ratio, share
from s2glib.recipes.speech_clips import Encoded, decoded_errors, encode_clips, is_right
from s2glib.recipes.speech_data import FactorTable

QUADRUPLES = 128
PROBE_CLIPS = 1536  # training clips that the probes learn from
_SEED = 11


def evaluate_amuse_speech(folder: Path) -> list[Row]:
    """All rows for the checkpoints of a folder, on the test clips.

    Raises:
        FileNotFoundError: if a checkpoint is missing.
        ImportError: without the extra `corpus`, where the cache lacks a clip.
    """
    model = load_checkpoint(folder / "amuse-disentangler.safetensors", SpeechDisentangler)
    judge = load_checkpoint(folder / "amuse-speech-judge.safetensors", SpeechJudge)
    test = encode_clips(model, split("test"))
    new_voices = encode_clips(model, split("unseen-speakers"))
    train = split("train")
    probed = np.random.default_rng(_SEED).choice(len(train), PROBE_CLIPS, replace=False)
    return [
        *disentangler_rows(model, test, encode_clips(model, [train[row] for row in probed])),
        *recognition_rows(model, encode_clips(model, split("unseen-sentences")), "sentences"),
        *recognition_rows(model, new_voices, "voices"),
        *judge_rows(judge, test.clips),
        *edit_rows(model, judge, test),
        unseen_voice_row(model, judge, new_voices),
    ]


def disentangler_rows(
    model: SpeechDisentangler, test: Encoded, train: Encoded, *, quadruples: int = QUADRUPLES
) -> list[Row]:
    """The rows that need no judge; `train` is what the leakage probes learn from."""
    return [
        *recognition_rows(model, test),
        *cross_rows(model, test, quadruples),
        *reliance_rows(model, test),
        *leakage_rows(train, test),
    ]


def recognition_rows(model: SpeechDisentangler, heard: Encoded, unseen: str = "") -> list[Row]:
    """EA and SA by the model's own heads, and macro F1; a voice must be known to be named."""
    tasks = [("EA", model.emotion_head(heard.latents.emotion), heard.clips.emotion)]
    if heard.clips.style.max() < model.config.styles:
        tasks.append(("SA", model.style_head(heard.latents.style), heard.clips.style))
    if unseen:
        return [share(f"{name}, unseen {unseen}", is_right(*task)) for name, *task in tasks]
    return [
        row
        for name, *task in tasks
        for row in (share(name, is_right(*task)), _macro_f1(f"{name}, macro F1", *task))
    ]


def _macro_f1(name: str, scores: Tensor, labels: np.ndarray) -> Row:
    def macro_f1(true: np.ndarray, called: np.ndarray) -> float:
        return classification_report(true, called, scores.shape[-1]).macro_f1

    return figure(name, labels, scores.argmax(-1).numpy(), statistic=macro_f1)


def cross_rows(model: SpeechDisentangler, heard: Encoded, quadruples: int) -> list[Row]:
    """Self error, and the paper's three swaps inside quadruples over it  [AM B.4]."""
    table = FactorTable(heard.clips.cells, heard.clips.windows)
    four = table.quadruple_indices(quadruples, np.random.default_rng(_SEED))
    within = heard.at(four.flatten())
    c, e, s = (latent.unflatten(0, four.shape) for latent in within.latents)
    swapped = {
        "content": (swap_partner(c, "style"), e, s),
        "emotion": (c, swap_partner(e, "content"), s),
        "style": (c, e, swap_partner(s, "content")),
    }

    def error(latents: tuple[Tensor, ...]) -> np.ndarray:
        flat = SpeechLatents(*(latent.flatten(0, 1) for latent in latents))
        return decoded_errors(model, flat, within.clips).reshape(four.shape).mean(axis=0)

    own = error((c, e, s))
    rows = [figure("self error", decoded_errors(model, heard.latents, heard.clips))]
    return rows + [
        ratio(f"cross {n} / self", error(latents), own) for n, latents in swapped.items()
    ]


def reliance_rows(model: SpeechDisentangler, heard: Encoded) -> list[Row]:
    """Error with one latent from a clip that differs in that factor, over the self error."""
    rng = np.random.default_rng(_SEED)
    own = decoded_errors(model, heard.latents, heard.clips)
    clips = heard.clips
    rows = []
    for name, classes in zip(
        SpeechLatents._fields, (clips.sentence, clips.emotion, clips.style), strict=True
    ):
        foreign = getattr(heard.at(strangers(classes, rng)).latents, name)
        mixed = heard.latents._replace(**{name: foreign})
        rows.append(ratio(f"reliance on {name}", decoded_errors(model, mixed, clips), own))
    return rows


def leakage_rows(train: Encoded, test: Encoded) -> list[Row]:
    """How often a linear probe reads each factor from c, from e and from s.

    A probe shows what is readable, reliance and edits show what is used: print both.
    """
    rows = []
    for letter, learnt, unknown in zip("ces", train.latents, test.latents, strict=True):
        for factor, name in (("sentence", "sentence"), ("style", "voice"), ("emotion", "emotion")):
            called = probe(learnt, getattr(train.clips, factor), unknown)
            rows.append(share(f"{name} in {letter}", called == getattr(test.clips, factor)))
    return rows


def probe(
    latents: Float[Tensor, "n dim"], labels: Int[np.ndarray, " n"], unknown: Float[Tensor, "m dim"]
) -> Int[np.ndarray, " m"]:
    """Classes that a linear probe, fitted to labelled latents, gives to others."""
    from sklearn.linear_model import LogisticRegression

    mean, std = latents.mean(0), latents.std(0).clamp_min(1e-8)
    learnt, asked = (((x - mean) / std).numpy() for x in (latents, unknown))
    return LogisticRegression(C=0.1, max_iter=2000).fit(learnt, labels).predict(asked)
