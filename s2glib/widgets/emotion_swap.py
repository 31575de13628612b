"""The emotion swap: one sentence, one voice, two bodies - as it was said, and in another emotion.

Paper:    AM 3.4, Fig. 1 (gesture editing by swapping latents)
Notebook: notebooks/00_start_here.ipynb
"""

from collections.abc import Callable, Sequence
from typing import Protocol

import ipywidgets

from s2glib.audio.io import Waveform
from s2glib.body.motion import Motion
from s2glib.body.skinning import BodyModel
from s2glib.widgets.player import Player

SHOWN = ("source", "edited", "side by side", "true target")
TOLD = {
    "source": "The body of the sentence as it was said: <b>{emotion}</b>.",
    "edited": "The same sound; the body moves with <b>{new_emotion}</b>.",
    "side by side": "One sound, two bodies: <b>{emotion}</b> and <b>{new_emotion}</b>.",
    "true target": "How the corpus itself speaks and gestures it: <b>{new_emotion}</b>.",
}


class Recording(Protocol):
    """What the demo needs of a clip."""

    @property
    def waveform(self) -> Waveform | None:
        """Its sound."""

    @property
    def motion(self) -> Motion:
        """Its gestures."""


class EmotionSwapDemo(ipywidgets.VBox):
    """Choose a clip and another emotion; see the two bodies, and hear the true target.

    Args:
        body: who gestures.
        sentences: options of the sentence, values or (label, value) pairs.
        speakers: options of the voice.
        emotions: what the source and the edit can be.
        find: the id of a clip, from sentence, speaker and emotion.
        load: the clip of an id, with `waveform` and `motion`.
        generate: the motion that a model gives to the sound of a clip.
        edit: the same with another emotion.
    """

    def __init__(
        self,
        body: BodyModel,
        sentences: Sequence,
        speakers: Sequence,
        emotions: Sequence[str],
        *,
        find: Callable[..., str],
        load: Callable[[str], Recording],
        generate: Callable[[str], Motion],
        edit: Callable[[str, str], Motion],
    ) -> None:
        self._find, self._load, self._generate, self._edit = find, load, generate, edit
        self.sentence = _dropdown("sentence", sentences)
        self.speaker = _dropdown("speaker", speakers)
        self.emotion = _dropdown("emotion", emotions)
        self.new_emotion = _dropdown("becomes", emotions[::-1])
        self.shown = ipywidgets.ToggleButtons(options=SHOWN, value="side by side")
        self.told = ipywidgets.HTML()
        self._compute()
        self.player = Player(self._motions, self._sound, body)
        for each in (self.sentence, self.speaker, self.emotion, self.new_emotion):
            each.observe(self._recompute, names="value")
        self.shown.observe(self._show, names="value")
        self.sentence.layout.width = "45.5em"  # a sentence is longer than a name
        choices = ipywidgets.HBox([self.speaker, self.emotion, self.new_emotion])
        choices.layout.flex_flow = "row wrap"
        super().__init__([self.sentence, choices, self.shown, self.player, self.told])
        self._tell()

    def _clip(self, emotion: str) -> str:
        return self._find(self.sentence.value, self.speaker.value, emotion)

    def _compute(self) -> None:
        """Both bodies by name, and the sound of the source, which they share."""
        source = self._clip(self.emotion.value)
        edited = self._edit(source, self.new_emotion.value)
        self._motions = {"source": self._generate(source), "edited": edited}
        self._sound = self._load(source).waveform

    def _recompute(self, _change) -> None:
        self._compute()
        self._show()

    def _show(self, _change=None) -> None:
        shown = self.shown.value
        with self.player.hold_sync():
            if shown == "true target":
                target = self._load(self._clip(self.new_emotion.value))
                self.player.show({shown: target.motion}, target.waveform)
            else:
                self.player.show(self._motions, self._sound)
                self.player.view = "" if shown == "side by side" else shown
        self._tell()

    def _tell(self) -> None:
        words = {"emotion": self.emotion.value, "new_emotion": self.new_emotion.value}
        self.told.value = f'<p role="status">{TOLD[self.shown.value].format(**words)}</p>'

    def __repr__(self) -> str:
        return "EmotionSwapDemo: one sentence, two emotions. It needs a running kernel."


def _dropdown(name: str, options: Sequence) -> ipywidgets.Dropdown:
    style, layout = {"description_width": "6.5em"}, {"width": "15em"}
    return ipywidgets.Dropdown(options=options, description=name, style=style, layout=layout)
