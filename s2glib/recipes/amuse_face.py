"""Fit the face that generated gestures wear: least squares for the mouth, means for the emotions.

Paper:    -
Notebook: notebooks/14_emotion_swap_studio.ipynb
"""

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from s2glib.body import FACE_CURVES
from s2glib.corpus.build import render_motion, timing_of
from s2glib.corpus.face import mouth_shapes
from s2glib.corpus.script import EMOTIONS, Cell, split
from s2glib.papers.amuse.config import SPEECH_PRESETS, SpeechConfig
from s2glib.papers.amuse.speech_face import FaceConfig, SpeechFace
from s2glib.recipes.amuse_disentangler import factor_table
from s2glib.recipes.stage import Stage

_CLIPS = 800  # enough for 321 x 4 coefficients
_LIPS = 3


def true_mouths(cells: list[Cell], config: SpeechConfig) -> Float[Tensor, "n frames 4"]:
    """Jaw and lips at the frames of speech windows, from the phoneme clock."""
    moments = (np.arange(config.frames) + 0.5) * config.pool / 100
    shapes = [mouth_shapes(timing_of(cell), moments) for cell in cells]
    return torch.from_numpy(np.stack(shapes)).float()


def mean_faces(cells: list[Cell]) -> Float[Tensor, "emotions curves"]:
    """The mean face of each emotion, without the lips that speak."""
    faces = torch.zeros(len(EMOTIONS), len(FACE_CURVES))
    for number, emotion in enumerate(EMOTIONS):
        shown = [render_motion(cell).motion for cell in cells if cell.emotion == emotion]
        faces[number] = torch.cat([motion.expression for motion in shown]).mean(0)[
            : len(FACE_CURVES)
        ]
    faces[:, -_LIPS:] = 0.0
    return faces


def mouth_error(face: SpeechFace, heard: Tensor, true: Tensor) -> float:
    """Mean absolute error of jaw opening and lips, in shares of their range."""
    return float((face.mouth(heard) - true).abs().mean())


def train_face(stage: Stage) -> None:
    """Fit and publish `amuse-face`."""
    config = SPEECH_PRESETS[stage.preset]
    table, cells = factor_table("train", config), split("train")
    chosen = np.random.default_rng(stage.seed).permutation(len(cells))[:_CLIPS]
    fitted = [cells[number] for number in chosen]
    face = SpeechFace(FaceConfig(n_mels=config.n_mels))
    face.fit_mouth(table.clips(chosen), true_mouths(fitted, config))
    face.emotion_faces.copy_(mean_faces(fitted[:160]))
    held_out = factor_table("validation", config)
    true = true_mouths(split("validation"), config)
    figures = {"mouth error": mouth_error(face, held_out.windows.float(), true)}
    record = {"course": {"steps": 0}, "seconds": 0.0, "curve": []}
    stage.publish("amuse-face", face, record, figures)
