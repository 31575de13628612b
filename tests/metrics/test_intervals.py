import numpy as np
import pytest
import scipy.stats

from s2glib.metrics import bootstrap_interval


def test_interval_agrees_with_scipys_percentile_bootstrap(rng):
    values = rng.gamma(2.0, size=200)
    ours = bootstrap_interval(values, rng=rng, resamples=4000)
    scipys = scipy.stats.bootstrap(
        (values,), np.mean, method="percentile", n_resamples=4000, rng=rng
    ).confidence_interval
    assert ours.value == values.mean()
    assert ours[1:] == pytest.approx(scipys, abs=0.01)


def test_an_interval_covers_the_truth_about_as_often_as_it_says(rng):
    covered = 0
    for _ in range(200):
        _, low, high = bootstrap_interval(rng.normal(size=60), rng=rng, level=0.8, resamples=150)
        covered += low < 0 < high
    assert 0.7 < covered / 200 < 0.88


def test_pairs_stay_together(rng):
    real = rng.uniform(1, 9, size=50)
    found = bootstrap_interval(
        2 * real, real, statistic=lambda a, b: a.mean() / b.mean(), rng=rng, resamples=50
    )
    assert found == pytest.approx((2, 2, 2))


def test_rows_of_features_can_be_resampled(rng):
    features = rng.normal(size=(40, 3))
    found = bootstrap_interval(
        features, statistic=lambda x: np.linalg.det(np.cov(x.T)), rng=rng, resamples=50
    )
    assert found.low < found.value < found.high


def test_a_higher_level_gives_a_wider_interval(rng):
    values = rng.normal(size=30)
    narrow, wide = (
        bootstrap_interval(values, rng=np.random.default_rng(1), level=level)
        for level in (0.5, 0.99)
    )
    assert wide.low < narrow.low < narrow.high < wide.high


def test_clips_without_a_value_are_refused_unless_the_statistic_skips_them(rng):
    values = np.append(rng.normal(size=20), np.nan)
    with pytest.raises(ValueError, match="not finite"):
        bootstrap_interval(values, rng=rng, resamples=20)
    assert np.isfinite(bootstrap_interval(values, rng=rng, statistic=np.nanmean)).all()


@pytest.mark.parametrize(
    ("values", "options", "error", "says"),
    [
        ((np.ones(1),), {}, ValueError, "2 or more clips"),
        ((np.ones(3), np.ones(4)), {}, ValueError, "2 or more clips"),
        ((), {}, TypeError, "numpy arrays"),
        (([1.0, 2.0],), {}, TypeError, "numpy arrays"),
        ((np.ones(3),), {"level": 95}, ValueError, "level"),
        ((np.ones(3),), {"resamples": 0}, ValueError, "resamples"),
    ],
)
def test_unusable_samples_are_refused_in_one_sentence(unhooked, rng, values, options, error, says):
    with pytest.raises(error, match=says):
        bootstrap_interval(*values, rng=rng, **options)
