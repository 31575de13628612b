import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from s2glib.metrics import diversity, l1_variation, sample_variance

quick = settings(deadline=None, max_examples=25)
seeds = st.integers(0, 2**32 - 1)


@pytest.mark.parametrize("p", [1, 2, 3])
def test_all_pairs_agree_with_the_double_loop(rng, p):
    features = rng.normal(size=(9, 5))
    distances = [
        (np.abs(a - b) ** p).sum() ** (1 / p) for a, b in itertools.combinations(features, 2)
    ]
    assert diversity(features, p=p) == pytest.approx(np.mean(distances), rel=1e-12)


@quick
@given(seeds, st.sampled_from(["all", "permutation", 5]), st.floats(0.1, 10))
def test_diversity_scales_with_the_features(seed, pairs, scale):
    features = np.random.default_rng(seed).normal(size=(8, 3))
    small, large = (
        diversity(x, pairs=pairs, rng=np.random.default_rng(1))
        for x in (features, scale * features)
    )
    assert large == pytest.approx(scale * small, rel=1e-9)


def test_a_permutation_lets_vectors_meet_themselves_and_so_lies_below_all_pairs(rng):
    features = rng.normal(size=(6, 4))
    draws = [diversity(features, p=1, pairs="permutation", rng=rng) for _ in range(2000)]
    assert np.mean(draws) == pytest.approx(diversity(features, p=1) * 5 / 6, rel=0.02)


def test_random_pairs_are_drawn_without_repetition(rng):
    features = np.array([[0.0], [1.0]])
    draws = {diversity(features, pairs=2, rng=rng) for _ in range(40)}
    assert draws == {0.0, 1.0}


def test_the_same_rng_gives_the_same_pairs(rng):
    features = rng.normal(size=(30, 4))
    first, second = (diversity(features, pairs=10, rng=np.random.default_rng(3)) for _ in range(2))
    assert first == second


def test_sample_variance_agrees_with_the_loop_over_joints(rng):
    positions = rng.normal(size=(4, 6, 3, 3))
    frames = []
    for t in range(6):
        variances = [np.cov(positions[:, t, j].T).diagonal() for j in range(3)]
        frames.append(sum(np.sqrt((v**2).sum()) for v in variances))
    assert sample_variance(positions) == pytest.approx(np.mean(frames), rel=1e-12)


def test_equal_samples_have_no_variance(rng):
    assert sample_variance(np.repeat(rng.normal(size=(1, 5, 2, 3)), 3, axis=0)) < 1e-30


def test_l1_variation_is_a_sum_over_coordinates_and_leaves_its_input_alone():
    motion = np.array([[[0.0, 1.0]], [[2.0, 5.0]]])
    before = motion.copy()
    assert l1_variation(motion) == pytest.approx(1 + 2)
    assert np.array_equal(motion, before)


@quick
@given(seeds)
def test_l1_variation_ignores_where_the_body_stands(seed):
    motion = np.random.default_rng(seed).normal(size=(7, 4, 3))
    assert l1_variation(motion + 100.0) == pytest.approx(l1_variation(motion), rel=1e-9)


@pytest.mark.parametrize(
    ("features", "options", "says"),
    [
        (np.ones((1, 3)), {}, "at least 2"),
        (np.ones((3, 3)), {"pairs": 2}, "rng"),
        (np.ones((3, 3)), {"pairs": 4, "rng": np.random.default_rng(0)}, "1 to 3"),
        (np.ones((3, 3)), {"pairs": "some", "rng": np.random.default_rng(0)}, "some"),
        (np.ones((3, 3)), {"p": 0}, "at least 1"),
        (np.full((3, 3), np.inf), {}, "infinite"),
    ],
)
def test_diversity_refuses_what_it_cannot_pair(unhooked, features, options, says):
    with pytest.raises(ValueError, match=says):
        diversity(features, **options)


def test_one_sample_has_no_variance_and_is_refused():
    with pytest.raises(ValueError, match="at least 2 samples"):
        sample_variance(np.zeros((1, 5, 2, 3)))
