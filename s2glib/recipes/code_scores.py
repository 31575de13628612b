"""How good codes are: whether all are used, and how much of a motion comes back from them.

Paper:    PT A.1
Notebook: notebooks/05_product_codes.ipynb
"""

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from s2glib.checkpoint import load_checkpoint
from s2glib.corpus.script import split
from s2glib.layers import in_batches
from s2glib.papers.probtalk import PQVAE
from s2glib.quantization import perplexity
from s2glib.recipes.holistic_data import HolisticClips, holistic_clips
from s2glib.recipes.report import Row, figure, over_draws

STUDY = "probtalk-codes"  # the stage that leaves the records of `study_rows`
_FEWEST = 3  # seeds of it
WEIGHTS = {"jaw": 0.1, "expression": 0.1, "body": 0.4, "hands": 0.4}  # of the loss; authors' code


class HeldOut(NamedTuple):
    """First windows of clips, and which of their frames are real, not held after the end."""

    motion: Float[Tensor, "n frames size"]
    real: Bool[Tensor, "n frames"]


def held_out(clips: HolisticClips, frames: int) -> HeldOut:
    """The first window of every clip."""
    lengths = torch.from_numpy(clips.motion.lengths)
    return HeldOut(clips.first(frames), torch.arange(frames) < lengths[:, None])


class CodeScores(NamedTuple):
    """What happens to held-out clips on their way through the codes.

    Attributes:
        wrist: cm between true and decoded wrists in the chest's frame, one a clip.
        parts: mean absolute error of standardised features, parts weighed as in the loss.
        usage: perplexity / number of codes, of each group.
    """

    wrist: Float[np.ndarray, " n"]
    parts: Float[np.ndarray, " n"]
    usage: Float[np.ndarray, " groups"]


@torch.no_grad()
def code_scores(model: PQVAE, clips: HolisticClips) -> CodeScores:
    """Encode, quantise and decode the first window of every clip."""
    motion, real = held_out(clips, model.config.frames)
    codes = in_batches(model.eval().encode, motion)
    made = in_batches(model.decode, codes)
    return CodeScores(
        100 * mean_where(real, wrist_distance(model, motion, made)),
        mean_where(real, part_error(model, motion, made)),
        code_usage(codes[real[:, :: model.config.window]], model.config.codes),
    )


def wrist_distance(
    model: PQVAE, motion: Float[Tensor, "n frames size"], made: Float[Tensor, "n frames size"]
) -> Float[Tensor, "n frames"]:
    """Metres between the wrists of two motions in the chest's frame, mean of both sides."""
    true, found = (in_batches(model.features.wrists, features) for features in (motion, made))
    return (found - true).norm(dim=-1).mean(-1)


def part_error(
    model: PQVAE, motion: Float[Tensor, "n frames size"], made: Float[Tensor, "n frames size"]
) -> Float[Tensor, "n frames"]:
    """Mean absolute differences of jaw, body, hands and expression, weighed as in the loss."""
    off, spans = (made - motion).abs(), model.features.parts
    return torch.stack([w * off[..., spans[p]].mean(-1) for p, w in WEIGHTS.items()]).sum(0)


def mean_where(
    real: Bool[Tensor, "n frames"], values: Float[Tensor, "n frames"]
) -> Float[np.ndarray, " n"]:
    """Each clip's mean over its own frames."""
    return ((values * real).sum(1) / real.sum(1)).numpy()


def code_usage(codes: Int[Tensor, "n groups"], num_codes: int) -> Float[np.ndarray, " groups"]:
    """Perplexity / number of codes, group by group: 1 if all are used alike."""
    return np.array([float(perplexity(c, num_codes)) / num_codes for c in codes.unbind(-1)])


def code_rows(folder: Path) -> list[Row]:
    """Rows for the PQ-VAE of a folder, on test clips.

    Raises:
        FileNotFoundError: if its checkpoint is missing.
    """
    model = load_checkpoint(folder / "probtalk-pqvae.safetensors", PQVAE)
    scores = code_scores(model, holistic_clips(split("test"), model.features))
    n = len(scores.wrist)
    return [
        Row("codes: perplexity / codes, least used group", float(scores.usage.min()), n),
        *(
            Row(f"codes: perplexity / codes, group {number}", float(share), n)
            for number, share in enumerate(scores.usage, start=1)
        ),
        figure("codes: wrist error, cm", scores.wrist),
        figure("codes: part-wise error", scores.parts),
    ]


def study_rows(runs: Path) -> list[Row]:
    """The recorded short runs of `probtalk_codes`; intervals are ranges over the seeds.

    Raises:
        FileNotFoundError: if there is no record.
    """
    records = [json.loads(path.read_text()) for path in sorted(runs.glob(f"{STUDY}-teaching-*"))]
    if len(records) < _FEWEST:
        raise FileNotFoundError(
            f"expected records of {_FEWEST} seeds of {STUDY} in {runs}, found {len(records)}; "
            "evaluate with --retrain"
        )

    def of(name: str) -> Float[np.ndarray, " seeds"]:
        return np.array([record["figures"][name] for record in records])

    def recorded(name: str, values: Float[np.ndarray, " seeds"]) -> Row:
        return over_draws(f"short runs: {name}", values, len(records))._replace(recorded=True)

    names = dict.fromkeys(name for record in records for name in record["figures"])
    compared = []
    for what in ("wrist error, cm", "part-wise error"):
        shares = of(f"PQ 4 x 128: {what}") / of(f"VQ 128: {what}")
        name = f"{what}, PQ / VQ, equal memory"
        worst = shares.max(keepdims=True)
        compared += [recorded(name, shares), recorded(f"{name}, worst seed", worst)]
    return [*compared, *(recorded(name, of(name)) for name in names)]
