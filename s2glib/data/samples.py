"""One clip: what is said, heard, moved and meant, on one clock.

Paper:    AM F (BEAT's modalities), AM E (semantic scores)
Notebook: notebooks/01_motion_and_sound.ipynb
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from s2glib.audio import Waveform
from s2glib.body import Motion

GESTURE_TYPES = ("rest", "beat", "iconic", "deictic", "metaphoric")
"""What `Clip.gesture_type` counts."""


@dataclass(frozen=True)
class Interval:
    """A word or a phoneme and when it is spoken (seconds)."""

    name: str
    start: float
    end: float


@dataclass(frozen=True)
class Clip:
    """A sentence spoken by one speaker in one emotion, with the gestures that go with it.

    `waveform` is None where only the motion was rendered. `semantic` and `gesture_type` have one
    value per motion frame; `phonemes` marks primary stress with the IPA sign.
    """

    id: str
    sentence: int
    speaker: str
    emotion: str
    take: int
    intensity: float
    waveform: Waveform | None
    motion: Motion
    words: tuple[Interval, ...]
    phonemes: tuple[Interval, ...]
    semantic: Float[np.ndarray, " frames"]
    gesture_type: Int[np.ndarray, " frames"]

    @property
    def stress_times(self) -> Float[np.ndarray, " s"]:
        """Starts of the stressed vowels (seconds)."""
        return np.array([p.start for p in self.phonemes if "ˈ" in p.name])
