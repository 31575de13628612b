import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.metrics import classification_report


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1), st.integers(2, 9), st.integers(1, 40))
def test_report_agrees_with_scikit_learn(seed, classes, clips):
    from sklearn import metrics

    labels, predicted = np.random.default_rng(seed).integers(classes, size=(2, clips))
    everything = {"labels": range(classes), "zero_division": 0}
    expected = metrics.precision_recall_fscore_support(labels, predicted, **everything)
    report = classification_report(labels, predicted, classes)
    assert np.allclose([report.precision, report.recall, report.f1], expected[:3])
    assert report.macro_f1 == pytest.approx(
        metrics.f1_score(labels, predicted, average="macro", **everything)
    )
    assert np.array_equal(
        report.confusion, metrics.confusion_matrix(labels, predicted, labels=range(classes))
    )
    assert report.accuracy == pytest.approx(metrics.accuracy_score(labels, predicted))


def test_confusion_has_labels_in_rows():
    report = classification_report(np.array([0, 0, 1]), np.array([1, 1, 1]), 2)
    assert report.confusion.tolist() == [[0, 2], [0, 1]]


def test_a_lazy_judge_has_high_accuracy_and_low_macro_f1():
    labels = np.array([0] * 90 + [1] * 10)
    report = classification_report(labels, np.zeros(100, int), 2)
    assert report.accuracy == 0.9
    assert report.macro_f1 < 0.5


@pytest.mark.parametrize(
    ("labels", "error", "says"),
    [
        (np.array([0.0, 1.0]), TypeError, "integer"),
        ([0, 1], TypeError, "integer"),
        (np.array([], int), ValueError, "one class per clip"),
        (np.array([[0, 1]]), ValueError, "one class per clip"),
        (np.array([0, 3]), ValueError, "0 to 2"),
        (np.array([-1, 0]), ValueError, "0 to 2"),
        (np.array([0, 1, 2]), ValueError, "3 labels for 2"),
    ],
)
def test_unusable_labels_are_refused_in_one_sentence(unhooked, labels, error, says):
    with pytest.raises(error, match=says):
        classification_report(labels, np.array([0, 1]), 3)
