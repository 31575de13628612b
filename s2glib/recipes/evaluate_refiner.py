"""What the Refiner mends: motion out of codes, and the borders of what is kept.

Paper:    PT A.3
Notebook: notebooks/07_refiner.ipynb
"""

import torch

from s2glib.data import clips, load_clip
from s2glib.papers.probtalk import PARTS, ProbTalk, window_contexts
from s2glib.recipes.holistic_data import HolisticClips
from s2glib.recipes.holistic_seen import NINE, border_errors, joint_places
from s2glib.recipes.predictor_scores import held_out, nothing_given
from s2glib.recipes.probtalk_predictor import PredictorData
from s2glib.recipes.probtalk_refiner import RefinerScores, refiner_scores
from s2glib.recipes.report import Row, figure, ratio

SHIPPED, KEPT = 8, slice(45, 75)  # clips that come with the workbook, and the second that is kept
_SEED = 11


def refiner_rows(probtalk: ProbTalk, shelf: HolisticClips) -> list[Row]:
    """True codes, decoded and refined: how much of the error is left.

    Raises:
        ValueError: if there is no Refiner.
    """
    if probtalk.refiner is None:
        raise ValueError("there is no Refiner to measure; train probtalk-refiner")
    data = PredictorData(shelf, probtalk.pqvae, probtalk.refiner.config.context_parts)
    scores = refiner_scores(data, probtalk.refiner)
    rows = [
        ratio(f"true codes: {name}, refined / {before}", *values)
        for before in ("pasted", "eased")
        for name, *values in zip(
            RefinerScores._fields, scores["refined"], scores[before], strict=True
        )
    ]
    for name, one in scores.items():
        rows.append(figure(f"true codes: wrist error, {name}, cm", one.wrist))
        rows.append(figure(f"true codes: border, {name}, m/s^2", one.border))
    return rows


def context_rows(probtalk: ProbTalk, shelf: HolisticClips) -> list[Row]:
    """Motion made around a second that is kept: how it gets there.

    Both systems ease what they made into what is kept; see `keeping.eased`.
    """
    windows = held_out(shelf, probtalk.pqvae.config.frames)
    count, frames = windows.motion.shape[:2]
    generator = torch.Generator().manual_seed(_SEED)
    known = window_contexts(2 * count, frames, generator)[count:]
    asked = nothing_given(windows)._replace(given=windows.motion, known=known)
    features, errors = probtalk.pqvae.features, []
    real = joint_places(features, windows.motion)[:, :, NINE]
    for system in (probtalk, ProbTalk(probtalk.pqvae, probtalk.predictor, None, probtalk.hear)):
        made = system.sample(asked, generator=torch.Generator().manual_seed(_SEED))
        places = joint_places(features, made)[:, :, NINE]
        errors.append(border_errors(real, places, known.all(-1).numpy()))
    return [
        ratio("one second kept: border, refined / not", *errors),
        figure("one second kept: border, refined, m/s^2", errors[0]),
        kept_row(probtalk),
    ]


def kept_row(probtalk: ProbTalk) -> Row:
    """By how much written poses and faces differ from what was to be kept, in shipped clips."""
    changes = []
    for name in clips()[:SHIPPED]:
        clip = load_clip(name)
        assert clip.waveform is not None
        mask = torch.zeros(clip.motion.frames, len(PARTS), dtype=torch.bool)
        mask[KEPT] = True
        made = probtalk.generate(
            clip.waveform,
            known=clip.motion,
            context_mask=mask,
            generator=torch.Generator().manual_seed(_SEED),
        )
        tracks = ((made.poses, clip.motion.poses), (made.expression, clip.motion.expression))
        changes += [float((ours[KEPT] - theirs[KEPT]).abs().max()) for ours, theirs in tracks]
    return Row("one second kept: largest change of what is written", max(changes), SHIPPED)
