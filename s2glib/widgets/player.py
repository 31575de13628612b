"""The player: a body that gestures to its sound, in a notebook cell, drawn by the GPU.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from collections.abc import Mapping
from pathlib import Path

import anywidget
import traitlets

from s2glib.audio.io import Waveform
from s2glib.body.motion import Motion
from s2glib.body.skinning import BodyModel
from s2glib.widgets.packing import pack_mesh, pack_motion, pack_sound

HERE = Path(__file__).parent
PARTS = ("shaders.js", "pose.js", "stage.js", "player.js")
SCRIPT = "\n".join((HERE / part).read_text("utf-8") for part in PARTS)
STYLE = (HERE / "player.css").read_text("utf-8")


class Player(anywidget.AnyWidget):
    """Plays motions on a body, with their sound as the clock.

    Several motions of the same sound stand side by side; `view` names the one to see alone.
    Space plays, the arrow keys step, Home returns to the start; drag to look around.

    Python and the page never write the same trait: orders go out in `order`, what happened comes
    back in `heard`. Each order has a number, so that news from before an order is not believed.

    Args:
        motion: what the body does, or several motions by name.
        waveform: what is heard, or None for silence.
        body: who does it.
        height: of the picture, in pixels of the page.

    Attributes:
        frame: the frame that is shown; can be observed, as can `playing`.
        playing: whether time runs.

    Raises:
        TypeError: if something else than a motion, a waveform and a body comes.
        ValueError: if there is no motion, or motions differ in frames per second.
    """

    _esm = SCRIPT
    _css = STYLE
    mesh = traitlets.Bytes().tag(sync=True)
    motion = traitlets.Bytes().tag(sync=True)
    sound = traitlets.Bytes().tag(sync=True)
    view = traitlets.Unicode("").tag(sync=True)
    height = traitlets.Int(420).tag(sync=True)
    order = traitlets.Dict({"frame": (0, 0), "playing": (0, False)}).tag(sync=True)
    heard = traitlets.Dict({"frame": (0, 0), "playing": (0, False)}).tag(sync=True)
    frame = traitlets.Int(0, read_only=True)
    playing = traitlets.Bool(False, read_only=True)

    def __init__(
        self,
        motion: Motion | Mapping[str, Motion],
        waveform: Waveform | None,
        body: BodyModel,
        *,
        height: int = 420,
    ) -> None:
        self._body = check_body(body)
        super().__init__(mesh=pack_mesh(body), height=height, **self._pack(motion, waveform))

    def show(self, motion: Motion | Mapping[str, Motion], waveform: Waveform | None) -> None:
        """Swap motion and sound in one message, also while playing.

        The same sound plays on, so that two motions can be compared in mid-gesture; another one
        starts from the beginning.
        """
        packed = self._pack(motion, waveform)
        with self.hold_sync():
            if packed["sound"] != self.sound:
                self.seek(0.0)
            self.set_trait("frame", self.frame)
            for name, value in packed.items():
                setattr(self, name, value)

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

    def _pack(self, motion, waveform) -> dict[str, bytes | str]:
        motions = named_motions(motion)
        check_waveform(waveform)
        packed = pack_motion(motions, self._body)
        self._names = tuple(motions)
        self.fps = next(iter(motions.values())).fps
        self.frames = max(each.frames for each in motions.values())
        sound = pack_sound(waveform, self.frames / self.fps)
        return {"motion": packed, "sound": sound, "view": ""}

    @traitlets.validate("frame")
    def _inside(self, proposal) -> int:
        return min(max(proposal["value"], 0), self.frames - 1)

    @traitlets.validate("view")
    def _known(self, proposal) -> str:
        if proposal["value"] not in ("", *self._names):
            raise ValueError(f"no motion is called {proposal['value']!r}; there are {self._names}")
        return proposal["value"]

    def __repr__(self) -> str:
        return "Player: a body that gestures to its sound. It needs a running kernel."


def named_motions(motion: Motion | Mapping[str, Motion]) -> dict[str, Motion]:
    """Motions by name; a single one has no name."""
    motions = dict(motion) if isinstance(motion, Mapping) else {"": motion}
    if not motions:
        raise ValueError("there is no motion to show; give one, or several by name")
    for name, each in motions.items():
        if not isinstance(each, Motion):
            raise TypeError(f"motion {name!r} must be a Motion, got {type(each).__name__}")
    return motions


def check_waveform(waveform: Waveform | None) -> None:
    """Refuse a sound that has no sample rate."""
    if waveform is not None and not isinstance(waveform, Waveform):
        raise TypeError(f"waveform must be a Waveform or None, got {type(waveform).__name__}")


def check_body(body: BodyModel) -> BodyModel:
    """Refuse what is not a body with the joints of our motions."""
    if not isinstance(body, BodyModel):
        raise TypeError(f"body must be a BodyModel, got {type(body).__name__}")
    if len(body.joints) != 55:
        raise ValueError(f"body must have the 55 SMPL-X joints, got {len(body.joints)}")
    return body
