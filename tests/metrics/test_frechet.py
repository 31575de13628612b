import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import ortho_group

from s2glib.metrics import frechet_distance, frechet_from_statistics

quick = settings(deadline=None, max_examples=25)
seeds = st.integers(0, 2**32 - 1)


def clouds(seed, n=12, m=9, d=4):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, d)) * rng.uniform(0.1, 3, d), rng.normal(rng.normal(), 1, (m, d))


def by_sqrtm(mean_a, cov_a, mean_b, cov_b):
    root = scipy.linalg.sqrtm(cov_a @ cov_b)
    return np.square(mean_a - mean_b).sum() + np.trace(cov_a + cov_b - 2 * root).real


@quick
@given(seeds)
def test_distance_is_symmetric_and_never_negative(seed):
    a, b = clouds(seed)
    forth, back = frechet_distance(a, b), frechet_distance(b, a)
    assert forth >= 0
    assert forth == pytest.approx(back, rel=1e-9)


@quick
@given(seeds, st.integers(2, 20))
def test_distance_of_a_set_to_itself_is_zero_with_fewer_samples_than_features_too(seed, n):
    a, _ = clouds(seed, n=n, d=8)
    assert frechet_distance(a, a) <= 1e-7 * np.square(a).sum()


@quick
@given(seeds, st.integers(2, 12))
def test_a_common_rotation_changes_nothing(seed, n):
    a, b = clouds(seed, n=n, d=6)
    rotation = ortho_group.rvs(6, random_state=seed)
    rotated = frechet_distance(a @ rotation, b @ rotation)
    assert rotated == pytest.approx(frechet_distance(a, b), rel=1e-6, abs=1e-6)


@quick
@given(seeds, st.floats(-5, 5))
def test_a_shift_costs_its_squared_length(seed, shift):
    a, _ = clouds(seed)
    assert frechet_distance(a, a + shift) == pytest.approx(4 * shift**2, abs=1e-6)


def test_commuting_covariances_have_the_closed_form(rng):
    spread_a, spread_b = rng.uniform(0.5, 2, (2, 7))
    found = frechet_from_statistics(
        np.zeros(7), np.diag(spread_a**2), np.ones(7), np.diag(spread_b**2)
    )
    assert found == pytest.approx(7 + np.square(spread_a - spread_b).sum(), rel=1e-12)


def test_distance_agrees_with_scipys_sqrtm(rng):
    a, b = rng.normal(size=(300, 40)), rng.normal(0.1, 1.4, (200, 40)) @ rng.normal(size=(40, 40))
    statistics = [f(x) for x in (a, b) for f in (lambda x: x.mean(0), lambda x: np.cov(x.T))]
    assert frechet_distance(a, b) == pytest.approx(by_sqrtm(*statistics), rel=1e-10)
    assert frechet_from_statistics(*statistics) == pytest.approx(by_sqrtm(*statistics), rel=1e-10)


def test_fewer_samples_than_features_agree_with_the_singular_values_of_the_data(rng):
    """tr (C_a C_b)^½ is the sum of singular values of A B^T: no covariance is ever formed."""
    a, b = rng.normal(size=(10, 64)), rng.normal(size=(7, 64))
    A, B = ((x - x.mean(0)) / np.sqrt(len(x) - 1) for x in (a, b))
    overlap = np.linalg.svd(A @ B.T, compute_uv=False).sum()
    mean_gap = np.square(a.mean(0) - b.mean(0)).sum()
    expected = mean_gap + np.square(A).sum() + np.square(B).sum() - 2 * overlap
    assert frechet_distance(a, b) == pytest.approx(expected, rel=1e-7)


def test_one_feature_is_legal_where_the_releases_report_ten_billion(rng):
    a, b = rng.normal(size=(50, 1)), rng.normal(2, 3, (50, 1))
    expected = (a.mean() - b.mean()) ** 2 + (a.std(ddof=1) - b.std(ddof=1)) ** 2
    assert frechet_distance(a, b) == pytest.approx(expected, rel=1e-10)


def test_constant_features_leave_only_the_means():
    assert frechet_distance(np.zeros((3, 5)), np.ones((4, 5))) == pytest.approx(5)


def test_float32_features_lose_nothing_to_a_large_offset(rng):
    a = rng.normal(size=(100, 3)).astype(np.float32) + np.float32(1000)
    assert frechet_distance(a, a.copy()) < 1e-9


@pytest.mark.parametrize(("samples", "expected"), [(40, 14.8), (100, 5.9), (400, 1.45)])
def test_two_draws_of_one_gaussian_are_far_apart_when_few(rng, samples, expected):
    draws = [frechet_distance(*rng.normal(size=(2, samples, 32))) for _ in range(10)]
    assert np.mean(draws) == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(
    ("a", "error", "says"),
    [
        (np.ones((1, 3)), ValueError, "at least 2 samples, got 1"),
        (np.ones((0, 3)), ValueError, "at least 2 samples"),
        (np.ones(3), ValueError, "axes"),
        (np.ones((4, 2)), ValueError, "2 and 3 features"),
        (np.full((4, 3), np.nan), ValueError, "NaN"),
        ([[1.0, 2.0, 3.0]] * 4, TypeError, "numpy array"),
        (np.full((4, 3), "x"), TypeError, "numpy array"),
    ],
)
def test_unusable_features_are_refused_in_one_sentence(unhooked, a, error, says):
    with pytest.raises(error, match=says):
        frechet_distance(a, np.ones((4, 3)))


@pytest.mark.parametrize(
    "cov", [np.array([[1.0, 2.0], [2.0, 1.0]]), np.array([[1.0, 0.5], [0, 1]])]
)
def test_a_matrix_that_is_no_covariance_is_refused(cov):
    with pytest.raises(ValueError, match=r"covariance|symmetric"):
        frechet_from_statistics(np.zeros(2), cov, np.zeros(2), np.eye(2))
