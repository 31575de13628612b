"""The mask painter: paint which frames of which parts of a motion stay; the rest is made anew.

Paper:    PT A.2, A.3 (motion context), Eq. 8
Notebook: notebooks/07_refiner.ipynb
"""

import math
from collections.abc import Mapping, Sequence

import anywidget
import ipywidgets
import torch
import traitlets
from jaxtyping import Bool
from matplotlib.axes import Axes
from torch import Tensor

from s2glib.audio import Waveform
from s2glib.body import BodyModel, Motion, joint, joint_positions
from s2glib.papers.probtalk import JOINTS_OF, PARTS, ProbTalk
from s2glib.papers.probtalk.keeping import check_known
from s2glib.papers.probtalk.speech_features import check_speech, motion_frames
from s2glib.viz import draw_kept
from s2glib.widgets.parts import read_parts
from s2glib.widgets.player import Player

FIELD = 8  # frames of a field: those of a token
BEFORE, AFTER = "original", "made anew"
WRISTS = [joint("left_wrist"), joint("right_wrist")]
TOLD = (
    "Take {take}: {share:.0%} is kept, {same}. The wrists go up to {far:.0f} cm away from where "
    "they were."
)


class MaskTimeline(anywidget.AnyWidget):
    """Rows of fields to paint with mouse, finger or keys, and a button below them.

    Python and the page never write the same trait: orders go out in `order`, what happened comes
    back in `heard`. Each order has a number, so that news from before an order is not believed.
    The page offers its button again when `done` has caught up with the presses that it counts.

    Attributes:
        kept: for each row a string with a 1 for every field that is kept, else 0.
        pressed: how often the button was pressed; can be observed.
    """

    _esm = read_parts("entry.js", "mask_painter.js")
    _css = read_parts("mask_painter.css")
    names: traitlets.List = traitlets.List().tag(sync=True)
    field = traitlets.Int(FIELD).tag(sync=True)
    fps = traitlets.Float().tag(sync=True)
    order: traitlets.Dict = traitlets.Dict().tag(sync=True)
    heard: traitlets.Dict = traitlets.Dict().tag(sync=True)
    done = traitlets.Int(0).tag(sync=True)
    moment: traitlets.Dict = traitlets.Dict({"frame": (0, 0)}).tag(sync=True)
    kept: traitlets.List = traitlets.List(read_only=True)
    pressed = traitlets.Int(0, read_only=True)

    def __init__(self, names: Sequence[str], frames: int, fps: float | int) -> None:
        kept = ["1" * math.ceil(frames / FIELD)] * len(names)
        order, words = {"number": 0, "kept": kept}, [name.replace("_", " ") for name in names]
        super().__init__(names=words, fps=fps, order=order, heard={**order, "pressed": 0})
        self.set_trait("kept", kept)

    def paint(self, kept: Sequence[str]) -> None:
        """Paint all rows, as a reader would.

        Raises:
            ValueError: if these are not as many rows of zeros and ones, with as many fields.
        """
        rows = list(kept)
        if list(map(len, rows)) != list(map(len, self.kept)) or set("".join(rows)) - {"0", "1"}:
            raise ValueError(
                f"a painting has {len(self.kept)} rows of {len(self.kept[0])} zeros and ones; "
                f"got {rows}"
            )
        self.set_trait("kept", rows)
        self.order = {"number": self.order["number"] + 1, "kept": rows}

    @traitlets.observe("heard")
    def _listen(self, change) -> None:
        if change["new"]["number"] == self.order["number"]:
            self.set_trait("kept", change["new"]["kept"])
        self.set_trait("pressed", change["new"]["pressed"])


class MaskPainter(ipywidgets.VBox):
    """Paint which parts of which frames of a motion stay, and let ProbTalk make the rest anew.

    Args:
        probtalk: makes.
        waveform: speech.
        known: the motion to begin with.
        body: who moves.
        speakers: numbers of speakers by name; the first one is chosen at first.

    Raises:
        TypeError: if something is of another type.
        ValueError: if there is no such speaker, or the motion has another frame rate.
    """

    def __init__(
        self,
        probtalk: ProbTalk,
        waveform: Waveform,
        known: Motion,
        body: BodyModel,
        speakers: Mapping[str, int],
    ) -> None:
        if not isinstance(probtalk, ProbTalk):
            raise TypeError(f"probtalk must be a ProbTalk, got {type(probtalk).__name__}")
        check_speech(waveform)
        check_known(known)
        self._probtalk, self._waveform = probtalk, waveform
        self._known, self._body, self._takes = known, body, 0
        self.motion = known
        self.timeline = MaskTimeline(PARTS, known.frames, known.fps)
        self.speaker = ipywidgets.Dropdown(options=list(speakers.items()), description="manner of")
        self.told = ipywidgets.HTML()
        self.player = Player({BEFORE: known, AFTER: known}, waveform, body)
        self._link = ipywidgets.jsdlink((self.player, "heard"), (self.timeline, "moment"))
        self.timeline.observe(self._answer, names="pressed")
        super().__init__([self.timeline, self.speaker, self.player, self.told])
        fields = len(self.timeline.kept[0])
        third = fields // 3
        self.paint([("1" * third).ljust(fields - third, "0") + "1" * third] * len(PARTS))
        self.make()

    def paint(self, kept: Sequence[str]) -> None:
        """Paint the rows of face, body, left and right hand: 1 is kept, 0 is not."""
        self.timeline.paint(kept)

    def make(self) -> Motion:
        """Make anew what is not kept; every take has another chance."""
        self._takes += 1
        self._asked = self.context_mask
        self.motion = self._probtalk.generate(
            self._waveform,
            known=self._known,
            context_mask=self._asked,
            speaker=self.speaker.value,
            generator=torch.Generator().manual_seed(self._takes),
        )
        self.player.show({BEFORE: self._known, AFTER: self.motion}, self._waveform)
        self._tell()
        return self.motion

    @property
    def context_mask(self) -> Bool[Tensor, "frames 4"]:
        """True where the original is kept, frame by frame; never where it has ended."""
        rows = [[field == "1" for field in row] for row in self.timeline.kept]
        kept = torch.tensor(rows).T.repeat_interleave(FIELD, dim=0)[: self._known.frames]
        frames = motion_frames(self._waveform)
        mask = torch.zeros(frames, len(PARTS), dtype=torch.bool)
        mask[: len(kept)] = kept[:frames]
        return mask

    @property
    def stays(self) -> bool:
        """Whether all that was kept when the motion was made is the original bit for bit."""
        return all(map(torch.equal, self._kept_of(self._known), self._kept_of(self.motion)))

    def draw(self, axes: Axes) -> Axes:
        """Draw what is painted: what is seen where no kernel runs."""
        return draw_kept(axes, self.context_mask.numpy(), self._known.fps, PARTS)

    def _kept_of(self, motion: Motion) -> list[Tensor]:
        """What was to be kept, of a motion: joints of each part, and the face's expression."""
        kept = dict(zip(PARTS, self._asked.T, strict=True))
        frames = {part: when.nonzero()[:, 0] for part, when in kept.items()}
        joints = [motion.poses[when][:, list(JOINTS_OF[part])] for part, when in frames.items()]
        return [*joints, motion.expression[frames["face"]]]

    def _answer(self, change) -> None:
        """Someone pressed the button."""
        try:
            self.make()
        finally:
            self.timeline.done = change["new"]

    def _tell(self) -> None:
        made, known = (joint_positions(each, self._body) for each in (self.motion, self._known))
        frames = min(len(made), len(known))
        far = float((made[:frames] - known[:frames])[:, WRISTS].norm(dim=-1).max())
        share = float(self._asked.float().mean())
        same = "bit for bit" if self.stays else "but not bit for bit"
        words = TOLD.format(take=self._takes, share=share, same=same, far=100 * far)
        self.told.value = f'<p role="status">{words}</p>'

    def __repr__(self) -> str:
        return "MaskPainter: paint what stays. Needs a running kernel; without one, .draw(axes)"
