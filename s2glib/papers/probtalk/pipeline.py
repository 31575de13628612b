"""From a recording to a moving body and face, around whatever motion is to be kept.

Paper:    PT A.2, A.3 (inference)
Notebook: notebooks/07_refiner.ipynb
"""

from functools import partial
from numbers import Integral
from pathlib import Path
from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from s2glib.audio import Waveform, resample
from s2glib.body import Motion
from s2glib.checkpoint import load_checkpoint, read_metadata
from s2glib.papers.probtalk.keeping import eased, embody, kept_parts, to_length
from s2glib.papers.probtalk.motion_features import PARTS
from s2glib.papers.probtalk.pqvae import PQVAE
from s2glib.papers.probtalk.predictor import Predictor
from s2glib.papers.probtalk.refiner import Refiner
from s2glib.papers.probtalk.speech_features import (
    SAMPLE_RATE,
    Hear,
    check_speech,
    log_mels,
    motion_frames,
)

OVERLAP = 3  # tokens that a window shares with the one before; authors' code


class Asked(NamedTuple):
    """What is asked for, frame by frame; `given` counts only where `known` says so."""

    speech: Float[Tensor, "batch frames speech"]
    given: Float[Tensor, "batch frames motion"]
    known: Bool[Tensor, "batch frames 4"]
    speaker: Int[Tensor, " batch"]

    def window(self, frames: slice) -> "Asked":
        """A part in time."""
        speech, given, known = (track[:, frames] for track in self[:3])
        return Asked(speech, given, known, self.speaker)


class ProbTalk:
    """The trained networks and how they work together.

    Args:
        pqvae: codes to motion.
        predictor: speech to codes.
        refiner: what the codes could not say; may be left out.
        hear: speech features, as many numbers a frame as the predictor wants.

    Raises:
        ValueError: if the networks were not made for each other.
    """

    def __init__(
        self,
        pqvae: PQVAE,
        predictor: Predictor,
        refiner: Refiner | None = None,
        hear: Hear = log_mels,
    ):
        self.pqvae, self.predictor = pqvae.eval(), predictor.eval()
        self.refiner = None if refiner is None else refiner.eval()
        self.hear = hear
        self._check_sizes()

    @classmethod
    def load(cls, folder: Path, hear: Hear = log_mels) -> "ProbTalk":
        """Read the three checkpoints of a folder.

        Raises:
            FileNotFoundError: if one is missing.
            ValueError: if one is not what it should be, or they do not belong together.
        """
        pqvae = load_checkpoint(folder / "probtalk-pqvae.safetensors", PQVAE)
        paths = [folder / f"probtalk-{name}.safetensors" for name in ("predictor", "refiner")]
        for path in paths:
            if read_metadata(path).get("codes") not in (None, pqvae.fingerprint()):
                raise ValueError(
                    f"{path} was trained for the codes of another PQ-VAE; take all of them from "
                    "one training"
                )
        predictor, refiner = paths
        return cls(
            pqvae, load_checkpoint(predictor, Predictor), load_checkpoint(refiner, Refiner), hear
        )

    def _check_sizes(self) -> None:
        pqvae, predictor = self.pqvae.config, self.predictor.config
        sizes = {
            "numbers a frame": [pqvae.size, predictor.motion],
            "groups": [pqvae.groups, predictor.groups],
            "codes": [pqvae.codes, predictor.codes],
        }
        if self.refiner is not None:
            refiner = self.refiner.config
            sizes["numbers a frame"].append(self.refiner.features.size)
            sizes["speech"] = [predictor.speech, refiner.speech]
            sizes["parts of the mask"] = [predictor.context_parts, refiner.context_parts]
            sizes["speakers"] = [predictor.speakers, refiner.speakers]
        for what, found in sizes.items():
            if len(set(found)) > 1:
                raise ValueError(
                    f"these networks were not made for each other: {what} differ "
                    f"({' and '.join(map(str, found))}); take all of them from one training"
                )

    @torch.no_grad()
    def generate(
        self,
        waveform: Waveform,
        *,
        known: Motion | None = None,
        context_mask: Bool[Tensor, "frames 4"] | None = None,
        speaker: int = 0,
        steps: int = 8,
        guidance: float | None = None,
        generator: torch.Generator,
    ) -> Motion:
        """Motion for a recording of any length, 30 frames a second.

        Args:
            waveform: speech.
            known: motion to keep; its first frame goes with the first of the speech.
            context_mask: true where `known` is kept, for face, body, left and right hand; without
                it, all of `known` is kept, and continued if the speech is longer.
            speaker: whose manner it is.
            steps: of the decoding of each window.
            guidance: how much the speech counts in choosing codes: 1 as in training, 0 not at all;
                None: what suits the Predictor.
            generator: source of chance.

        Returns:
            Motion in which what was kept stands bit for bit.

        Raises:
            TypeError: if something is of another type.
            ValueError: if there is no such speaker, if mask, motion and speech do not fit, or if
                the speech features are others than the Predictor was trained on.
        """
        self.check(waveform, speaker)
        frames = motion_frames(waveform)
        kept = kept_parts(known, context_mask, frames)
        asked = self.ask(waveform, frames, known, kept, speaker)
        made = self.sample(asked, steps=steps, guidance=guidance, generator=generator)
        track = made[0, :frames]
        features = self.pqvae.features
        poses, expression = features.to_poses(track).cpu(), features.to_expression(track).cpu()
        return embody(poses, expression, known, kept)

    def check(self, waveform: Waveform, speaker: int) -> None:
        """Refuse what is no speech, or a speaker whom the networks do not know.

        Raises:
            TypeError: if something is of another type.
            ValueError: if there is no such speaker.
        """
        check_speech(waveform)
        if not isinstance(speaker, Integral) or isinstance(speaker, bool):
            raise TypeError(f"a speaker is a number, got {speaker!r}")
        speakers = self.predictor.config.speakers
        if not 0 <= speaker < speakers:
            raise ValueError(f"speakers are numbered 0 to {speakers - 1}, got {speaker}")

    @torch.no_grad()
    def ask(
        self,
        waveform: Waveform,
        frames: int,
        known: Motion | None,
        kept: Bool[Tensor, "frames 4"],
        speaker: int,
    ) -> Asked:
        """A recording and a known motion as the networks see them, up to the last window's end.

        All of it is on the device of the networks.

        Raises:
            ValueError: if the speech features are others than the Predictor was trained on.
        """
        place = next(self.predictor.parameters()).device
        whole = self.window_starts(frames)[-1] + self.pqvae.config.frames
        samples = resample(waveform.samples, waveform.sample_rate, SAMPLE_RATE)
        speech = self.hear(samples, whole).to(place)
        self._check_speech_size(speech.shape[-1])
        given = speech.new_zeros(whole, self.pqvae.config.size)
        if known is not None:
            tracks = (to_length(track, frames) for track in (known.poses, known.expression))
            poses, face = (track.to(place, torch.float32) for track in tracks)
            given[:frames] = self.pqvae.features.from_motion(poses, face)
        padded = torch.cat([kept, kept.new_zeros(whole - frames, len(PARTS))]).to(place)
        who = torch.tensor([speaker], device=place)
        return Asked(speech[None], given[None], padded[None], who)

    def _check_speech_size(self, size: int) -> None:
        wanted = self.predictor.config.speech
        if size != wanted:
            raise ValueError(
                f"this Predictor hears {wanted} numbers a frame, `hear` gives {size}; for one that "
                "was trained on wav2vec2, load with hear=wav2vec2(folder), else with log_mels"
            )

    def window_starts(self, frames: int) -> list[int]:
        """First frames of the windows that cover `frames`; the last may reach beyond."""
        config = self.pqvae.config
        overlap = OVERLAP * config.window
        return list(range(0, max(frames - overlap, 1), config.frames - overlap))

    @torch.no_grad()
    def sample(
        self,
        asked: Asked,
        *,
        steps: int = 8,
        guidance: float | None = None,
        generator: torch.Generator,
    ) -> Float[Tensor, "batch frames motion"]:
        """Motion for whole windows of speech, one after the other.

        A window is given the end of the one before, as if that had always been known.
        """
        guidance = self.predictor.config.guidance if guidance is None else guidance
        given, known = asked.given.clone(), asked.known.clone()
        length = self.pqvae.config.frames
        for start in self.window_starts(given.shape[1]):
            here = slice(start, start + length)
            window = asked._replace(given=given, known=known).window(here)
            given[:, here] = self._sample_window(window, steps, guidance, generator)
            known[:, here] = True
        return given

    def _sample_window(
        self, asked: Asked, steps: int, guidance: float, generator: torch.Generator
    ) -> Float[Tensor, "batch frames motion"]:
        speech, given, known, speaker = asked
        parts = self.predictor.config.context_parts
        mask = known if parts == len(PARTS) else known.all(dim=-1, keepdim=True)
        numbers = self.pqvae.features.of_parts(known)
        context = given * self.pqvae.features.of_parts(mask.expand_as(known))
        listen = partial(self.predictor.listen, context=context, context_mask=mask)
        *_, last = self.predictor.decode(
            listen(speech),
            speaker,
            unheard=None if guidance == 1 else listen(torch.zeros_like(speech)),
            guidance=guidance,
            steps=steps,
            generator=generator,
        )
        made = self.pqvae.decode(last.codes)
        if self.refiner is not None:
            made = self.refiner.refine(given, made, speech, mask, speaker)
        return eased(given, made, numbers)
