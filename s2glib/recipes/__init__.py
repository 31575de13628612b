"""Training: the loop, the data it draws from, and one file per stage."""

from s2glib.recipes.fit import Chance, Course, StepLog, Training
from s2glib.recipes.motion_data import MotionWindows, SpeechOfClips, speech_row
from s2glib.recipes.speech_data import FactorBatch, FactorTable, QuadrupleBatch
from s2glib.recipes.stage import Stage

__all__ = [
    "Chance",
    "Course",
    "FactorBatch",
    "FactorTable",
    "MotionWindows",
    "QuadrupleBatch",
    "SpeechOfClips",
    "Stage",
    "StepLog",
    "Training",
    "speech_row",
]
