"""Playback: what the players share, a time that runs and can be asked for and set from Python.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

import anywidget
import traitlets

from s2glib.audio.io import Waveform
from s2glib.widgets.parts import read_parts

STYLE = read_parts("player.css")


class Playback(anywidget.AnyWidget):
    """Frames that follow each other at a rate, with a sound as their clock.

    Python and the page never write the same trait: orders go out in `order`, what happened comes
    back in `heard`. Each order has a number, so that news from before an order is not believed.

    Attributes:
        frame: the frame that is shown; can be observed, as can `playing`.
        playing: whether time runs.
        frames: how many there are.
        fps: how many there are in a second.
    """

    _esm: str
    _css: str
    sound = traitlets.Bytes().tag(sync=True)
    order = traitlets.Dict({"frame": (0, 0), "playing": (0, False)}).tag(sync=True)
    heard = traitlets.Dict({"frame": (0, 0), "playing": (0, False)}).tag(sync=True)
    frame = traitlets.Int(0, read_only=True)
    playing = traitlets.Bool(False, read_only=True)
    frames: int
    fps: float

    def play(self) -> None:
        """Let time run, from the start if it had come to the end."""
        self._tell("playing", True)

    def pause(self) -> None:
        """Stop where it is."""
        self._tell("playing", False)

    def seek(self, seconds: float) -> None:
        """Go to the frame nearest to a time, or to the first or the last one."""
        self._tell("frame", min(max(round(seconds * self.fps), 0), self.frames - 1))

    @property
    def time(self) -> float:
        """Seconds from the start to the frame that is shown."""
        return self.frame / self.fps

    def _tell(self, name: str, value: int | bool) -> None:
        self.set_trait(name, value)
        self.order = {**self.order, name: (self.order[name][0] + 1, value)}

    @traitlets.observe("heard")
    def _listen(self, change) -> None:
        for name, (number, value) in change["new"].items():
            if number == self.order[name][0]:
                self.set_trait(name, value)

    @traitlets.validate("frame")
    def _inside(self, proposal) -> int:
        return min(max(proposal["value"], 0), self.frames - 1)


def check_waveform(waveform: Waveform | None) -> None:
    """Refuse a sound that has no sample rate."""
    if waveform is not None and not isinstance(waveform, Waveform):
        raise TypeError(f"waveform must be a Waveform or None, got {type(waveform).__name__}")
