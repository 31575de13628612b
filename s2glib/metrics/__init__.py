"""Metrics: how good a generated motion is, measured in the ways the three papers do."""

from s2glib.metrics.beat_presets import (
    BEAT_PRESETS,
    BeatPreset,
    beat_score,
    mean_speeds,
    preset_beats,
)
from s2glib.metrics.beats import (
    ShuffledAlignment,
    beat_alignment,
    kinematic_beats,
    shuffled_alignment,
)
from s2glib.metrics.classification import ClassificationReport, classification_report
from s2glib.metrics.diversity import diversity, l1_variation, sample_variance
from s2glib.metrics.error import (
    landmark_velocity_difference,
    mean_absolute_error,
    mean_joint_error,
    mean_squared_error,
)
from s2glib.metrics.frechet import frechet_distance, frechet_from_statistics
from s2glib.metrics.intervals import Interval, bootstrap_interval
from s2glib.metrics.recall import pck, semantic_relevant_gesture_recall
from s2glib.metrics.smoothness import acceleration, derivative_sizes, jerk

__all__ = [
    "BEAT_PRESETS",
    "BeatPreset",
    "ClassificationReport",
    "Interval",
    "ShuffledAlignment",
    "acceleration",
    "beat_alignment",
    "beat_score",
    "bootstrap_interval",
    "classification_report",
    "derivative_sizes",
    "diversity",
    "frechet_distance",
    "frechet_from_statistics",
    "jerk",
    "kinematic_beats",
    "l1_variation",
    "landmark_velocity_difference",
    "mean_absolute_error",
    "mean_joint_error",
    "mean_speeds",
    "mean_squared_error",
    "pck",
    "preset_beats",
    "sample_variance",
    "semantic_relevant_gesture_recall",
    "shuffled_alignment",
]
