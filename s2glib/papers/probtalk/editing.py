"""What ProbTalk is for: many motions for one sentence, and motion of which any part can be kept.

Each function says with a mask what stays, and lets `ProbTalk.generate` make the rest; what stays is
copied bit for bit.

Paper:    PT A.2 (motion context), Eq. 8; the masks: ours
Notebook: notebooks/07_refiner.ipynb
"""

from collections.abc import Iterator, Sequence

import torch
from jaxtyping import Bool
from torch import Tensor

from s2glib.audio import Waveform
from s2glib.body import Motion
from s2glib.papers.probtalk.keeping import check_known
from s2glib.papers.probtalk.motion_features import PARTS
from s2glib.papers.probtalk.pipeline import ProbTalk
from s2glib.papers.probtalk.speech_features import motion_frames


def context(
    frames: int,
    *,
    spans: Sequence[tuple[int, int]] | None = None,
    parts: Sequence[str] = PARTS,
) -> Bool[Tensor, "frames 4"]:
    """A context mask: true for these parts of the body in these frames, else false.

    Args:
        frames: of the speech.
        spans: first frame, and the one after the last, of each stretch; all frames by default.
        parts: some of `PARTS`; all by default.

    Raises:
        ValueError: if there is no such part, or a stretch is empty or leaves the speech.
    """
    unknown = [part for part in parts if part not in PARTS]
    if unknown or not parts:
        raise ValueError(f"parts are some of {', '.join(PARTS)}; got {', '.join(unknown) or None}")
    when = torch.zeros(frames, 1, dtype=torch.bool)
    for start, end in [(0, frames)] if spans is None else spans:
        if not 0 <= start < end <= frames:
            raise ValueError(
                f"a stretch lies within 0 and {frames}, the frames of the speech, and is not "
                f"empty; got {start} to {end}"
            )
        when[start:end] = True
    return when & torch.tensor([part in parts for part in PARTS])


def samples(
    probtalk: ProbTalk,
    waveform: Waveform,
    count: int,
    *,
    speaker: int = 0,
    steps: int = 8,
    generator: torch.Generator,
) -> Iterator[Motion]:
    """Variable: as many motions as wanted for one recording, one after the other."""
    for _ in range(count):
        yield probtalk.generate(waveform, speaker=speaker, steps=steps, generator=generator)


def fill_in(
    probtalk: ProbTalk,
    waveform: Waveform,
    known: Motion,
    start: int,
    end: int,
    *,
    parts: Sequence[str] = PARTS,
    speaker: int = 0,
    steps: int = 8,
    generator: torch.Generator,
) -> Motion:
    """In-between: frames `start` to `end` are made anew, in some parts or in all; the rest stays.

    Raises:
        TypeError: if there is no speech, or no motion.
        ValueError: if the stretch leaves the speech, or `known` ends before the speech does.
    """
    check_known(known)
    made = context(motion_frames(waveform), spans=[(start, end)], parts=parts)
    return probtalk.generate(
        waveform,
        known=known,
        context_mask=~made,
        speaker=speaker,
        steps=steps,
        generator=generator,
    )


def carry_on(
    probtalk: ProbTalk,
    waveform: Waveform,
    beginning: Motion,
    *,
    speaker: int = 0,
    steps: int = 8,
    generator: torch.Generator,
) -> Motion:
    """Continue: the beginning stays, and goes on for as long as the speech does.

    Raises:
        TypeError: if there is no speech, or no motion.
        ValueError: if there is no such speaker, or the beginning has another frame rate.
    """
    check_known(beginning)
    return probtalk.generate(
        waveform, known=beginning, speaker=speaker, steps=steps, generator=generator
    )


def keep_parts(
    probtalk: ProbTalk,
    waveform: Waveform,
    known: Motion,
    parts: Sequence[str],
    *,
    speaker: int = 0,
    steps: int = 8,
    generator: torch.Generator,
) -> Motion:
    """Keep parts of the body throughout, and make the others anew, so that they agree.

    With another `speaker`, the others take on that speaker's manner: a re-styling that leaves, for
    instance, the face to the words.

    Raises:
        TypeError: if there is no speech, or no motion.
        ValueError: if there is no such part.
    """
    check_known(known)
    frames = motion_frames(waveform)
    kept = context(frames, spans=[(0, min(frames, known.frames))], parts=parts)
    return probtalk.generate(
        waveform, known=known, context_mask=kept, speaker=speaker, steps=steps, generator=generator
    )


def restyle(
    probtalk: ProbTalk,
    waveform: Waveform,
    known: Motion,
    speaker: int,
    *,
    keep: Sequence[str] = ("face",),
    steps: int = 8,
    generator: torch.Generator,
) -> Motion:
    """Re-style: what is not kept is made anew in the manner of another speaker.

    Raises:
        TypeError: if there is no speech, or no motion.
        ValueError: if there is no such part or speaker.
    """
    return keep_parts(
        probtalk, waveform, known, keep, speaker=speaker, steps=steps, generator=generator
    )
