"""From a recording to a gesturing body, and to the same body in another emotion or style.

Paper:    AM Fig. A.4 (inference), A (emotion and style editing)
Notebook: notebooks/14_emotion_swap_studio.ipynb
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from numbers import Integral
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional as F

from s2glib.audio import Waveform, resample
from s2glib.body import Motion
from s2glib.body.skeleton import joint
from s2glib.checkpoint import load_checkpoint
from s2glib.diffusion import NoiseSchedule, from_noise_prediction, guided, sample_ddim, timesteps
from s2glib.layers import in_batches
from s2glib.papers.amuse.disentangler import SpeechDisentangler, SpeechLatents
from s2glib.papers.amuse.front_end import (
    MOTION_FPS,
    frame_moments,
    sample_track,
    speech_input,
    time_tracks,
)
from s2glib.papers.amuse.latent_denoiser import LatentDenoiser, SpeechCondition
from s2glib.papers.amuse.motion_prior import MotionPrior
from s2glib.papers.amuse.speech_face import SpeechFace
from s2glib.papers.amuse.stitching import AT_ONCE, agreeing, blend, mend_joins, window_starts
from s2glib.papers.amuse.stress_listener import StressListener, heard_rhythm

SAMPLE_RATE = 16000


@dataclass(frozen=True)
class Sampling:
    """How gestures are sampled (ours): the best of a dozen settings on validation clips."""

    steps: int = 16
    guidance: float = 2.75  # on emotion; 1 is none
    spread: float = 1.08  # factor on the final latent, against under-dispersion
    overlap: int = 30  # frames that neighbouring windows share


@dataclass(frozen=True)
class Heard:
    """What the model hears in a recording, motion window by motion window."""

    latents: SpeechLatents  # (n, dim) each
    tracks: Float[Tensor, "n frames tracks"]
    filterbank: Float[Tensor, "spoken mels"]  # of the whole recording
    frames: int  # of motion

    def with_emotion(self, emotion: Float[Tensor, " dim"]) -> "Heard":
        """The same speech in another emotion."""
        return replace(
            self, latents=self.latents._replace(emotion=emotion.expand_as(self.latents.emotion))
        )

    def with_style(self, style: Float[Tensor, " dim"]) -> "Heard":
        """The same speech in another speaker's style."""
        return replace(
            self, latents=self.latents._replace(style=style.expand_as(self.latents.style))
        )


class Amuse:
    """The five trained networks and how they work together.

    However long the speech, a network sees `AT_ONCE` windows at a time. What grows is what cannot
    do otherwise: a minute of speech holds 3.8 MB of samples and 0.8 of filterbank, 1.9 of motion,
    and while it is sampled 2.5 of features that have to agree from the first window to the last.

    Args:
        speech: the disentangler.
        prior: the motion prior.
        denoiser: the latent denoiser.
        stress: the listener for stressed vowels.
        face: jaw, lips and the emotion's face.
        sampling: steps, guidance and overlap.
    """

    def __init__(
        self,
        speech: SpeechDisentangler,
        prior: MotionPrior,
        denoiser: LatentDenoiser,
        stress: StressListener,
        face: SpeechFace,
        sampling: Sampling | None = None,
    ):
        self.speech, self.prior = speech.eval(), prior.eval()
        self.denoiser, self.stress, self.face = denoiser.eval(), stress.eval(), face.eval()
        self.sampling = sampling or Sampling()
        self.schedule = NoiseSchedule.scaled_linear(denoiser.config.levels)

    @classmethod
    def load(cls, folder: Path, sampling: Sampling | None = None) -> "Amuse":
        """Read the five checkpoints of a folder.

        Raises:
            FileNotFoundError: if one is missing.
            ValueError: if one is not what it should be.
        """
        return cls(
            load_checkpoint(folder / "amuse-disentangler.safetensors", SpeechDisentangler),
            load_checkpoint(folder / "amuse-prior.safetensors", MotionPrior),
            load_checkpoint(folder / "amuse-denoiser.safetensors", LatentDenoiser),
            load_checkpoint(folder / "amuse-stress.safetensors", StressListener),
            load_checkpoint(folder / "amuse-face.safetensors", SpeechFace),
            sampling,
        )

    @torch.no_grad()
    def hear(self, waveform: Waveform) -> Heard:
        """Encode a recording of any length.

        Each motion window listens to one speech window around it; short recordings have one.

        Raises:
            TypeError: if it is not a Waveform.
            ValueError: if it is empty or not finite.
        """
        if not isinstance(waveform, Waveform):
            raise TypeError(
                f"speech comes as a Waveform, got {type(waveform).__name__}; read a file with "
                "s2glib.audio.load"
            )
        samples = resample(waveform.samples, waveform.sample_rate, SAMPLE_RATE)
        config = self.speech.config
        window = self.prior.config.frames
        frames = max(1, int(len(samples) / SAMPLE_RATE * MOTION_FPS))
        starts = window_starts(frames, window, self.sampling.overlap)
        seconds = config.frames * config.pool / 100
        ends = len(samples) / SAMPLE_RATE
        lead = (seconds - window / MOTION_FPS) / 2
        begins = torch.tensor(
            [max(0.0, min(start / MOTION_FPS - lead, ends - seconds)) for start in starts],
            dtype=torch.float64,
        )
        offsets = torch.tensor(starts) / MOTION_FPS - begins.float()
        moments = offsets[:, None] + frame_moments(window)
        latents, tracks, _ = in_batches(
            partial(self._listen, samples), begins, moments, size=AT_ONCE
        )
        latents = latents._replace(style=latents.style.mean(0).expand_as(latents.style))
        whole = speech_input(samples, replace(config, frames=_frames_of(ends, config.pool)))
        return Heard(latents, tracks, whole, frames)

    def _listen(
        self,
        samples: Float[np.ndarray, " samples"],
        begins: Float[Tensor, " n"],
        moments: Float[Tensor, "n frames"],
    ) -> SpeechCondition:
        """What a few motion windows hear in the speech windows that begin at these seconds."""
        config = self.speech.config
        heard = torch.stack(
            [speech_input(samples[int(begin * SAMPLE_RATE) :], config) for begin in begins.tolist()]
        )
        latents = self.speech.encode(heard)
        tracks = time_tracks(heard_rhythm(heard, self.stress), latents.content, moments, config)
        return SpeechCondition(latents, tracks, torch.zeros(len(heard), 3, dtype=torch.bool))

    @torch.no_grad()
    def sample_windows(
        self, condition: SpeechCondition, *, generator: torch.Generator, agree: bool = False
    ) -> Float[Tensor, "n frames features"]:
        """Sample one window of motion features for each row of a condition.

        The networks see `AT_ONCE` rows at a time, but the rows take every step of the denoising
        together, so that agreement passes from window to window over any length.

        Args:
            condition: what the speech asks of each window.
            generator: source of the noise.
            agree: whether the rows are overlapping windows of one recording.
        """
        network: Callable[..., Tensor] = self.denoiser
        if self.denoiser.config.prediction == "noise":
            network = from_noise_prediction(network, self.schedule)
        scale = float(self.sampling.guidance)

        def denoise_rows(xt: Tensor, wish: SpeechCondition, t: int) -> Tensor:
            return guided(network, wish, wish.without_emotion(), scale)(xt, t)

        def denoise_all(xt: Tensor, t: int) -> Tensor:
            return in_batches(partial(denoise_rows, t=t), xt, condition, size=AT_ONCE)

        denoise: Callable[[Tensor, int], Tensor] = denoise_all
        if agree:
            denoise = agreeing(denoise, self.prior, self.denoiser, self.sampling.overlap)
        config = self.denoiser.config
        count = len(condition.tracks)
        noise = torch.randn(count, config.tokens, config.token_dim, generator=generator)
        levels = timesteps(config.levels, self.sampling.steps, "linspace")
        *_, x0 = sample_ddim(denoise, noise, self.schedule, timesteps=levels, generator=generator)
        latents = self.denoiser.restore(self.sampling.spread * x0)
        windows = in_batches(self.prior.decode, latents, size=AT_ONCE)
        return mend_joins(windows, windows.shape[1] // (config.tokens - config.global_tokens))

    @torch.no_grad()
    def gesture(self, heard: Heard, *, generator: torch.Generator) -> Motion:
        """Sample a motion for what was heard."""
        nothing = torch.zeros(len(heard.tracks), 3, dtype=torch.bool)
        condition = SpeechCondition(heard.latents, heard.tracks, nothing)
        windows = self.sample_windows(condition, generator=generator, agree=True)
        track = blend(windows, self.sampling.overlap)[: heard.frames]
        return self._embody(track, heard)

    def _embody(self, track: Float[Tensor, "frames features"], heard: Heard) -> Motion:
        """Stand the body up and give it a face that speaks."""
        features = self.prior.features
        poses, trans = in_batches(features.to_poses, track, size=1024), features.pelvis(track)
        emotion = self.speech.emotion_head(heard.latents.emotion.mean(0)).softmax(-1)
        jaw, curves = self.face(heard.filterbank, emotion)
        rate = 100 / self.speech.config.pool
        places = frame_moments(len(poses)) * rate - 0.5
        face = sample_track(torch.cat([jaw[:, None], curves], dim=1)[None], places[None])[0]
        poses[:, joint("jaw")] = F.pad(face[:, :1], (0, 2))
        expression = poses.new_zeros(len(poses), 100)
        expression[:, : curves.shape[1]] = face[:, 1:]
        return Motion(poses, trans, expression, MOTION_FPS)

    def generate(self, waveform: Waveform, *, generator: torch.Generator) -> Motion:
        """Gestures for a recording, in its own emotion and style."""
        return self.gesture(self.hear(waveform), generator=generator)

    def edit(
        self,
        source: Waveform,
        *,
        emotion: Waveform | int | None = None,
        style: Waveform | None = None,
        generator: torch.Generator,
    ) -> Motion:
        """Gestures for `source` with the emotion, the style, or both taken from elsewhere.

        Args:
            source: whose words and rhythm stay.
            emotion: a donor recording, or the number of an emotion (its mean latent is used).
            style: a donor recording.
            generator: source of the noise.

        Raises:
            ValueError: if there is nothing to edit, or no such emotion.
            TypeError: if a donor is neither a recording nor, for the emotion, a number.
        """
        if emotion is None and style is None:
            raise ValueError("an edit takes an emotion, a style, or both; got neither")
        heard = self.hear(source)
        if isinstance(emotion, Waveform):
            heard = heard.with_emotion(self.hear(emotion).latents.emotion.mean(0))
        elif emotion is not None:
            heard = heard.with_emotion(self.emotion_centre(emotion))
        if style is not None:
            heard = heard.with_style(self.hear(style).latents.style.mean(0))
        return self.gesture(heard, generator=generator)

    def emotion_centre(self, number: int) -> Float[Tensor, " dim"]:
        """The mean emotion latent of a class.

        Raises:
            TypeError: if the class is not given by its number.
            ValueError: if there is no such class.
        """
        count = self.speech.config.emotions
        if not isinstance(number, Integral):
            raise TypeError(
                f"an emotion is a number from 0 to {count - 1} or a Waveform, got {number!r}; "
                "s2glib.corpus.EMOTIONS.index gives the number of a name"
            )
        if not 0 <= number < count:
            raise ValueError(f"emotions are numbered 0 to {count - 1}, got {number}")
        return self.speech.emotion_centres[number]


def _frames_of(seconds: float, pool: int) -> int:
    return max(1, int(np.ceil(seconds * 100 / pool)))
