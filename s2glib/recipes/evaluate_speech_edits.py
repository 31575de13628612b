"""Edited speech before a judge that had no part in training, and beside the true target.

Paper:    AM Tab. A.1-A.2 leave open whether swapped speech is recognised; procedure: ours
Notebook: notebooks/09_disentanglement.ipynb
"""

import numpy as np
import torch

from s2glib.corpus.build import Request
from s2glib.layers import in_batches
from s2glib.papers.amuse.disentangler import SpeechDisentangler, SpeechLatents
from s2glib.papers.amuse.speech_judge import SpeechJudge, SpeechOpinion
from s2glib.recipes.amuse_extractor import blur
from s2glib.recipes.donors import emotion_donors, style_donors
from s2glib.recipes.report import Row, ratio, share
from s2glib.recipes.speech_clips import (
    Encoded,
    SpeechClips,
    decoded_errors,
    encode_clips,
    is_right,
    speech_clips,
)

WIDEST_BLUR = 2  # that the judge met in training
_SEED = 11


def judge_rows(judge: SpeechJudge, clips: SpeechClips) -> list[Row]:
    """What the independent judge is worth: on real clips, and on clips as blurred as decoded ones.

    Its verdicts on edits count only if these rows reach their aims.
    """
    rows = []
    for name, windows in (("", clips.windows), (", blurred", blur(clips.windows, WIDEST_BLUR))):
        heard = in_batches(judge, windows)
        rows += [
            share(f"judge right, emotion{name}", is_right(heard.emotion, clips.emotion)),
            share(f"judge right, voice{name}", is_right(heard.style, clips.style)),
        ]
    return rows


def edit_rows(model: SpeechDisentangler, judge: SpeechJudge, test: Encoded) -> list[Row]:
    """Edits of emotion and style, as the judge hears them and against the true target."""
    rng = np.random.default_rng(_SEED)
    emotion = encode_clips(model, emotion_donors(test.clips.cells, rng))
    style = encode_clips(model, style_donors(test.clips.cells, rng))
    unedited = _opinion(model, judge, test.latents)
    restyled = _opinion(model, judge, test.latents._replace(style=style.latents.style))
    return [
        share("unedited recognised", is_right(unedited.emotion, test.clips.emotion)),
        *_emotion_edit_rows(model, judge, test, emotion),
        *true_target_rows(model, test, emotion),
        share("style edit recognised", is_right(restyled.style, style.clips.style)),
        share("style edit, emotion kept", is_right(restyled.emotion, test.clips.emotion)),
    ]


def _opinion(
    model: SpeechDisentangler, judge: SpeechJudge, latents: SpeechLatents
) -> SpeechOpinion:
    return in_batches(judge, in_batches(model.decoder, *latents))


def _emotion_edit_rows(model, judge, test: Encoded, lent: Encoded) -> list[Row]:
    """A donor's emotion, and for comparison the mean emotion of its class."""
    wanted, source = lent.clips.emotion, test.clips
    means = model.emotion_centres[torch.from_numpy(wanted)]
    edited = _opinion(model, judge, test.latents._replace(emotion=lent.latents.emotion))
    by_mean = _opinion(model, judge, test.latents._replace(emotion=means))
    return [
        share("emotion edit recognised", is_right(edited.emotion, wanted)),
        share("emotion edit by class mean, recognised", is_right(by_mean.emotion, wanted)),
        share("emotion edit, old emotion recognised", is_right(edited.emotion, source.emotion)),
        share("emotion edit, voice kept", is_right(edited.style, source.style)),
    ]


def true_target_rows(model: SpeechDisentangler, test: Encoded, lent: Encoded) -> list[Row]:
    """L1 of an emotion edit to the clip it should have become, over reconstructing that clip.

    The aim holds for the target on the source's clock. A model that re-times what it edits comes
    closer to the target on its own clock, which stands beside it.
    """
    edited = test.latents._replace(emotion=lent.latents.emotion)
    pairs = list(zip(test.clips.cells, lent.clips.cells, strict=True))
    wanted = [cell._replace(emotion=donor.emotion) for cell, donor in pairs]
    clocks = {
        "the source's": [Request(w, c.emotion) for w, (c, _) in zip(wanted, pairs, strict=True)],
        "its own": [Request(w) for w in wanted],
    }
    rows = []
    for clock, requests in clocks.items():
        target = speech_clips(requests, model.config)
        own = in_batches(model.encode, target.windows)
        errors = (decoded_errors(model, latents, target) for latents in (edited, own))
        rows.append(ratio(f"edit / target on {clock} clock", *errors))
    return rows


def unseen_voice_row(model: SpeechDisentangler, judge: SpeechJudge, heard: Encoded) -> Row:
    """The emotion edit on voices that nothing was trained on."""
    donors = emotion_donors(heard.clips.cells, np.random.default_rng(_SEED))
    lent = encode_clips(model, donors)
    edited = _opinion(model, judge, heard.latents._replace(emotion=lent.latents.emotion))
    right = is_right(edited.emotion, lent.clips.emotion)
    return share("emotion edit recognised, unseen voices", right)
