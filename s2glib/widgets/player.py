"""The player: a body that gestures to its sound, in a notebook cell, drawn by the GPU.

Paper:    -
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from collections.abc import Mapping

import traitlets

from s2glib.audio.io import Waveform
from s2glib.body.motion import Motion
from s2glib.body.skinning import BodyModel
from s2glib.widgets.packing import pack_mesh, pack_motion, pack_sound
from s2glib.widgets.parts import read_parts
from s2glib.widgets.playback import STYLE, Playback, check_waveform

PARTS = ("entry.js", "playback.js", "shaders.js", "pose.js", "stage.js", "player.js")


class Player(Playback):
    """Plays motions on a body, with their sound as the clock.

    Several motions of the same sound stand side by side; `view` names the one to see alone.
    Space plays, the arrow keys step, Home returns to the start; drag to look around.
    What Python can ask for is in `Playback`.

    Args:
        motion: what the body does, or several motions by name.
        waveform: what is heard, or None for silence.
        body: who does it.
        height: of the picture, in pixels of the page.

    Raises:
        TypeError: if something else than a motion, a waveform and a body comes.
        ValueError: if there is no motion, or motions differ in frames per second.
    """

    _esm = read_parts(*PARTS) + "export default createPlayer;\n"
    _css = STYLE
    mesh = traitlets.Bytes().tag(sync=True)
    motion = traitlets.Bytes().tag(sync=True)
    view = traitlets.Unicode("").tag(sync=True)
    height = traitlets.Int(420).tag(sync=True)

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

    def _pack(self, motion, waveform) -> dict[str, bytes | str]:
        motions = named_motions(motion)
        check_waveform(waveform)
        packed = pack_motion(motions, self._body)
        self._names = tuple(motions)
        self.fps = next(iter(motions.values())).fps
        self.frames = max(each.frames for each in motions.values())
        sound = pack_sound(waveform, self.frames / self.fps)
        return {"motion": packed, "sound": sound, "view": ""}

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


def check_body(body: BodyModel) -> BodyModel:
    """Refuse what is not a body with the joints of our motions."""
    if not isinstance(body, BodyModel):
        raise TypeError(f"body must be a BodyModel, got {type(body).__name__}")
    if len(body.joints) != 55:
        raise ValueError(f"body must have the 55 SMPL-X joints, got {len(body.joints)}")
    return body
