"""Classification: how often a judge hears, or sees, the right emotion or speaker.

Paper:    AM B.2 (EA, SA), AM E (gesture emotion accuracy)
Notebook: notebooks/17_motion_distances.ipynb
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int


class ClassificationReport(NamedTuple):
    """What a judge got right, over all clips and class by class."""

    accuracy: float
    precision: Float[np.ndarray, " classes"]  # of what was called so, the share that is
    recall: Float[np.ndarray, " classes"]  # of what is so, the share that was called so
    f1: Float[np.ndarray, " classes"]
    macro_f1: float  # mean over all classes
    confusion: Int[np.ndarray, "classes classes"]  # rows: label, columns: prediction


def classification_report(
    labels: Int[np.ndarray, " n"], predicted: Int[np.ndarray, " n"], num_classes: int
) -> ClassificationReport:
    """Compare the classes that a judge predicted with the true ones.

    A class that was never predicted has precision 0, one that never occurs has recall 0, and both
    count in the macro mean: a test set should hold every class.

    Args:
        labels: true class of each clip, 0 to `num_classes` - 1.
        predicted: predicted class of each clip.
        num_classes: how many classes there are.

    Raises:
        TypeError, ValueError: for classes that are no integers or out of range, no clips, or arrays
            of different length.
    """
    _check("labels", labels, num_classes)
    _check("predicted", predicted, num_classes)
    if len(labels) != len(predicted):
        raise ValueError(f"{len(labels)} labels for {len(predicted)} predictions; give one each")
    confusion = np.bincount(labels * num_classes + predicted, minlength=num_classes**2)
    confusion = confusion.reshape(num_classes, num_classes)
    right, called, true = np.diag(confusion), confusion.sum(axis=0), confusion.sum(axis=1)
    f1 = _share(2 * right, called + true)
    return ClassificationReport(
        accuracy=float(right.sum() / len(labels)),
        precision=_share(right, called),
        recall=_share(right, true),
        f1=f1,
        macro_f1=float(f1.mean()),
        confusion=confusion,
    )


def _share(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    return part / np.maximum(whole, 1)  # 0 of 0 is 0


def _check(name: str, classes: np.ndarray, num_classes: int) -> None:
    if not isinstance(classes, np.ndarray) or classes.dtype.kind not in "iu":
        kind = getattr(classes, "dtype", type(classes).__name__)
        raise TypeError(f"{name} must be a numpy array of integer classes, got {kind}; use argmax")
    if classes.ndim != 1 or not len(classes):
        raise ValueError(f"{name} must be one class per clip, got shape {classes.shape}")
    if classes.min() < 0 or classes.max() >= num_classes:
        raise ValueError(
            f"{name} must lie in 0 to {num_classes - 1}, got {classes.min()} to {classes.max()}; "
            "check num_classes"
        )
