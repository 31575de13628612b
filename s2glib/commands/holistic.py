"""From a recording to a folder of gestures by ProbTalk, around what is kept of another motion.

Paper:    PT A.2, A.3 (inference), Eq. 8 (what is known stays)
Notebook: -
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import torch
from jaxtyping import Bool
from torch import Tensor

from s2glib.audio import Waveform, load
from s2glib.body import Motion, mannequin, read_npz
from s2glib.commands.account import tell, versions, wrist_speed
from s2glib.commands.delivery import delivery, writing
from s2glib.commands.diary import Diary
from s2glib.commands.studio import FILES, write_motions, write_report
from s2glib.papers.probtalk import PARTS, ProbTalk
from s2glib.papers.probtalk.editing import context
from s2glib.papers.probtalk.speech_features import motion_frames


class Order(NamedTuple):
    """What is asked for.

    Attributes:
        speech: a sound file.
        out: folder for the results.
        seed: of the choice of codes.
        checkpoints: folder of the trained networks.
        speaker: whose manner it is.
        keep: a motion file, of which something is kept.
        frames: which frames of it; all, if there are none.
        parts: which parts of the body.
    """

    speech: Path
    out: Path
    seed: int
    checkpoints: Path
    speaker: int = 0
    keep: Path | None = None
    frames: Sequence[slice] = ()
    parts: Sequence[str] = PARTS

    @property
    def told(self) -> str:
        """What was made and what was kept."""
        made = f"Gestures and face for {self.speech.name}, in the manner of speaker {self.speaker}."
        if self.keep is None:
            return made
        frames = ", ".join(map(_spelled, self.frames)) or "all"
        parts = ", ".join(part.replace("_", " ") for part in self.parts)
        return f"{made} Kept from {self.keep.name}: {parts}; frames {frames}."


def perform(order: Order) -> None:
    """Make gestures for a recording, and deliver `FILES`.

    Raises:
        ValueError: if an input, a network or the output is not usable.
        FileNotFoundError: if a sound, a motion or a network is missing.
    """
    diary = Diary()
    with delivery(order.out, FILES) as folder:
        with diary.step("read"):
            waveform = load(order.speech)
            known = None if order.keep is None else read_npz(order.keep)
        with diary.step("load the networks"):
            probtalk, body = ProbTalk.load(order.checkpoints), mannequin()
        with diary.step("gesture"):
            motion = gesture(probtalk, order, waveform, known)
        report = describe(order, waveform) | {
            "frames": motion.frames,
            "fps": motion.fps,
            "wrist_speed": {"generated": wrist_speed(motion, body)},
            "versions": versions(),
        }
        with diary.step("write"), writing(order.out):
            write_motions(folder, {"generated": motion}, waveform, body, order)
        write_report(folder, report, diary, order)
    tell(report)
    print(f"Wrote {', '.join(FILES)} to {order.out}")


def gesture(probtalk: ProbTalk, order: Order, waveform: Waveform, known: Motion | None) -> Motion:
    """The motion that was ordered."""
    mask = None if known is None else kept_frames(order, waveform, known)
    return probtalk.generate(
        waveform,
        known=known,
        context_mask=mask,
        speaker=order.speaker,
        generator=torch.Generator().manual_seed(order.seed),
    )


def kept_frames(order: Order, waveform: Waveform, known: Motion) -> Bool[Tensor, "frames 4"]:
    """Which parts of which frames an order keeps.

    Raises:
        ValueError: if it names frames that the motion or the speech has not.
    """
    frames = motion_frames(waveform)
    both = min(frames, known.frames)
    spans = [(span.start or 0, span.stop or both) for span in order.frames or [slice(None)]]
    for start, stop in spans:
        if start >= both or stop > both:
            raise ValueError(
                f"--frames {start}:{stop} goes beyond frame {both}, where the motion to keep "
                f"({known.frames} frames) or the speech ({frames}) ends"
            )
    return context(frames, spans=spans, parts=order.parts)


def describe(order: Order, waveform: Waveform) -> dict[str, Any]:
    """What was asked for."""
    kept = None
    if order.keep is not None:
        frames = [_spelled(span) for span in order.frames] or [":"]
        kept = {"file": str(order.keep), "frames": frames, "parts": list(order.parts)}
    return {
        "system": "probtalk",
        "told": order.told,
        "inputs": {"speech": {"file": str(order.speech), "seconds": waveform.duration}},
        "options": {"checkpoints": str(order.checkpoints)},
        "seed": order.seed,
        "speaker": order.speaker,
        "kept": kept,
    }


def _spelled(span: slice) -> str:
    start, stop = ("" if end is None else end for end in (span.start, span.stop))
    return f"{start}:{stop}"
