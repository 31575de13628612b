import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.metrics import pck, semantic_relevant_gesture_recall

quick = settings(deadline=None, max_examples=25)
seeds = st.integers(0, 2**32 - 1)


@quick
@given(seeds, st.floats(0.01, 3))
def test_recall_lies_between_nothing_and_the_mean_score(seed, threshold):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 6, 4, 3))
    semantic = rng.uniform(size=6)
    assert 0 <= pck(a, b, threshold=threshold) <= 1
    recall = semantic_relevant_gesture_recall(a, b, semantic, threshold=threshold)
    assert 0 <= recall <= semantic.mean() + 1e-12


@quick
@given(seeds)
def test_perfect_motion_is_recalled_in_full(seed):
    rng = np.random.default_rng(seed)
    motion, semantic = rng.normal(size=(6, 4, 3)), rng.uniform(size=6)
    assert pck(motion, motion) == 1
    found = semantic_relevant_gesture_recall(motion, motion, semantic, mean_score=0.165)
    assert found == pytest.approx(semantic.mean() / 0.165)


def test_recall_agrees_with_the_printed_double_sum(rng):
    a, b = rng.normal(size=(2, 6, 4, 3))
    semantic = rng.uniform(size=6)
    for norm, length in (("l1", lambda x: abs(x).sum()), ("l2", lambda x: (x @ x) ** 0.5)):
        total = 0.0
        for t in range(6):
            for j in range(4):
                total += semantic[t] * (length(a[t, j] - b[t, j]) < 2.0)
        found = semantic_relevant_gesture_recall(a, b, semantic, threshold=2.0, norm=norm)
        assert found == pytest.approx(total / 24)


def test_the_l1_norm_recalls_less(rng):
    a, b = rng.normal(size=(2, 50, 4, 3))
    scores = [
        semantic_relevant_gesture_recall(a, b, np.ones(50), threshold=2.0, norm=norm)
        for norm in ("l1", "l2")
    ]
    assert scores[0] < scores[1]


def test_frames_without_meaning_do_not_count():
    target = np.zeros((2, 3, 3))
    predicted = target + np.array([0.0, 9.0])[:, None, None]
    assert semantic_relevant_gesture_recall(predicted, target, np.array([1.0, 0.0])) == 0.5
    assert semantic_relevant_gesture_recall(predicted, target, np.array([0.0, 1.0])) == 0.0


def test_a_joint_exactly_at_the_threshold_is_missed():
    target = np.zeros((1, 1, 2))
    assert pck(target + np.array([0.5, 0.0]), target, threshold=0.5) == 0
    assert pck(target + np.array([0.4999, 0.0]), target, threshold=0.5) == 1


def test_scale_makes_recall_independent_of_size(rng):
    a, b = rng.normal(size=(2, 20, 4, 2))
    box = np.ptp(b, axis=1).max(axis=-1)
    small = pck(a, b, threshold=0.2, scale=box)
    assert pck(7 * a, 7 * b, threshold=0.2, scale=7 * box) == small
    assert 0 < small < 1


def test_hidden_joints_are_left_out_and_joints_count_equally():
    target = np.zeros((4, 3, 2))
    predicted = target.copy()
    predicted[0, 1] = predicted[:, 2] = 9.0
    visible = np.ones((4, 3), bool)
    visible[2:, 1] = visible[:, 2] = False
    assert pck(predicted, target, visible=visible) == pytest.approx((1 + 0.5) / 2)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"threshold": 0.0}, "threshold must be a positive"),
        ({"scale": np.zeros(4)}, "scale must be positive"),
        ({"scale": np.ones(3)}, "scale must have axes"),
        ({"visible": np.zeros((4, 3), bool)}, "visible"),
        ({"visible": np.ones((3, 3), bool)}, "visible"),
    ],
)
def test_pck_refuses_settings_without_a_meaning(unhooked, options, says):
    with pytest.raises(ValueError, match=says):
        pck(np.zeros((4, 3, 2)), np.zeros((4, 3, 2)), **options)


@pytest.mark.parametrize(
    ("semantic", "options", "says"),
    [
        (np.ones(3), {}, "semantic must have axes"),
        (-np.ones(4), {}, "negative"),
        (np.full(4, np.nan), {}, "NaN"),
        (np.ones(4), {"norm": "l3"}, "norm"),
        (np.ones(4), {"mean_score": 0.0}, "mean_score"),
    ],
)
def test_semantic_recall_refuses_scores_without_a_meaning(unhooked, semantic, options, says):
    motion = np.zeros((4, 3, 2))
    with pytest.raises(ValueError, match=says):
        semantic_relevant_gesture_recall(motion, motion, semantic, **options)
