"""What is asked for: gestures for a recording, with an emotion or a style from elsewhere.

Paper:    AM A (emotion and style editing)
Notebook: -
"""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from s2glib.audio import Waveform
from s2glib.corpus.script import EMOTIONS
from s2glib.papers.amuse.disentangler import SpeechLatents
from s2glib.papers.amuse.pipeline import Amuse, Heard

SOUND_STAYS = "The sound stays the source's: only the body is edited."


class Job(NamedTuple):
    """One order.

    Attributes:
        speech: a sound file.
        out: folder for the results.
        seed: of the noise.
        checkpoints: folder of the trained networks.
        emotion: the name of an emotion, whose mean latent is taken; or a donor's sound file.
        style: a donor's sound file.
    """

    speech: Path
    out: Path
    seed: int
    checkpoints: Path
    emotion: str | Path | None = None
    style: Path | None = None

    def check(self) -> None:
        """Refuse an emotion that is none of the eight.

        Raises:
            ValueError: if it is not.
        """
        if isinstance(self.emotion, str) and self.emotion not in EMOTIONS:
            known = ", ".join(EMOTIONS)
            raise ValueError(f"there is no emotion {self.emotion!r}; choose one of {known}")

    @property
    def donors(self) -> dict[str, Path]:
        """The sound files that lend a latent, by latent."""
        asked = {"emotion": self.emotion, "style": self.style}
        return {latent: path for latent, path in asked.items() if isinstance(path, Path)}

    @property
    def swapped(self) -> dict[str, str]:
        """In words, where each swapped latent comes from."""
        origins = {latent: path.name for latent, path in self.donors.items()}
        if isinstance(self.emotion, str):
            origins["emotion"] = f"the mean of {self.emotion}"
        return origins

    @property
    def kept(self) -> list[str]:
        """The latents that stay the speech's own."""
        return [latent for latent in SpeechLatents._fields if latent not in self.swapped]

    @property
    def told(self) -> str:
        """What was swapped and what was not, in a few sentences."""
        if not self.swapped:
            return f"Gestures for {self.speech.name}, in its own emotion and style."
        swapped = " and ".join(f"{latent} ({origin})" for latent, origin in self.swapped.items())
        kept = " and ".join(self.kept)
        return f"Swapped in {self.speech.name}: {swapped}. Kept: {kept}. {SOUND_STAYS}"

    def edit(self, amuse: Amuse, heard: Heard, donors: Mapping[str, Waveform]) -> Heard:
        """The same speech with the latents that were asked for."""
        lent = {latent: amuse.hear(donor).latents for latent, donor in donors.items()}
        if isinstance(self.emotion, str):
            heard = heard.with_emotion(amuse.emotion_centre(EMOTIONS.index(self.emotion)))
        elif "emotion" in lent:
            heard = heard.with_emotion(lent["emotion"].emotion.mean(0))
        if "style" in lent:
            heard = heard.with_style(lent["style"].style.mean(0))
        return heard
