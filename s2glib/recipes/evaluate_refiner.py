"""What the Refiner mends: motion out of codes, and the borders of what is kept.

Paper:    PT A.3
Notebook: notebooks/07_refiner.ipynb
"""

import numpy as np
import torch

from s2glib.papers.probtalk import ProbTalk, window_contexts
from s2glib.recipes.holistic_data import HolisticClips
from s2glib.recipes.holistic_seen import NINE, border_errors, joint_places
from s2glib.recipes.predictor_scores import held_out, nothing_given
from s2glib.recipes.probtalk_predictor import PredictorData
from s2glib.recipes.probtalk_refiner import RefinerScores, refiner_scores
from s2glib.recipes.report import Row, figure, ratio

_SEED = 11


def refiner_rows(probtalk: ProbTalk, clips: HolisticClips) -> list[Row]:
    """True codes, decoded and refined: how much of the error is left.

    Raises:
        ValueError: if there is no Refiner.
    """
    if probtalk.refiner is None:
        raise ValueError("there is no Refiner to measure; train probtalk-refiner")
    data = PredictorData(clips, probtalk.pqvae, probtalk.refiner.config.context_parts)
    scores = refiner_scores(data, probtalk.refiner)
    rows = [
        ratio(f"true codes: {name}, refined / {before}", *values)
        for before in ("pasted", "eased")
        for name, *values in zip(
            RefinerScores._fields, scores["refined"], scores[before], strict=True
        )
    ]
    return rows + [
        figure(f"true codes: border, {name}, m/s^2", one.border) for name, one in scores.items()
    ]


def context_rows(probtalk: ProbTalk, clips: HolisticClips) -> list[Row]:
    """Motion made around a second that is kept: how it gets there, and whether that is kept.

    Both systems ease what they made into what is kept; see `keeping.eased`.
    """
    windows = held_out(clips, probtalk.pqvae.config.frames)
    count, frames = windows.motion.shape[:2]
    generator = torch.Generator().manual_seed(_SEED)
    known = window_contexts(2 * count, frames, generator)[count:]
    asked = nothing_given(windows)._replace(given=windows.motion, known=known)
    features, errors, changes = probtalk.pqvae.features, [], []
    real = joint_places(features, windows.motion)[:, :, NINE]
    for system in (probtalk, ProbTalk(probtalk.pqvae, probtalk.predictor, None, probtalk.hear)):
        made = system.sample(asked, generator=torch.Generator().manual_seed(_SEED))
        places = joint_places(features, made)[:, :, NINE]
        errors.append(border_errors(real, places, known.all(-1).numpy()))
        changes.append((made - asked.given)[features.of_parts(known)].abs().max())
    return [
        ratio("one second kept: border, refined / not", *errors),
        figure("one second kept: border, refined, m/s^2", errors[0]),
        Row("one second kept: largest change of it", float(np.max(changes)), count),
    ]
