"""Means and their intervals: by hand, and how often they hold the truth."""

import numpy as np
import pytest
import scipy.stats
from lammps_skin.analysis.statistics import mean, mean_in_time


def test_mean_by_hand():
    found = mean(np.array([1.0, np.nan, 2.0, 6.0]))
    assert found.value == 3 and found.n == 3
    assert found.error == pytest.approx(np.sqrt(7 / 3))
    low, high = scipy.stats.t(2, 3, np.sqrt(7 / 3)).interval(0.95)
    assert (found.low, found.high) == pytest.approx((low, high))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("of", [mean, mean_in_time])
def test_too_few_values(of):
    assert np.isnan(of(np.array([]))[:4]).all()
    assert np.isnan(of(np.array([np.nan]))[:4]).all()
    one = of(np.array([5.0, np.nan]))
    assert one.value == 5 and np.isnan(one[1:4]).all() and one.n == 1


@pytest.mark.filterwarnings("error")
def test_a_constant_series():
    assert mean_in_time(np.full(30, 16.0)) == (16, 0, 16, 16, 30)


def series(random, n, correlation):
    """Stationary series of mean 0 whose correlation falls as exp(-frames/correlation)."""
    memory = np.exp(-1 / correlation)
    values = np.empty(n)
    values[0] = random.normal()
    for k in range(1, n):
        values[k] = memory * values[k - 1] + np.sqrt(1 - memory**2) * random.normal()
    return values


def test_intervals_respect_correlation():
    random, trials = np.random.default_rng(1), 300
    hits, plain = 0, 0
    for _ in range(trials):
        values = series(random, 120, 3.0)
        one, other = mean_in_time(values), mean(values)
        assert one.value == other.value == values.mean()
        hits += one.low < 0 < one.high
        plain += other.low < 0 < other.high
    assert plain / trials < 0.75
    assert hits / trials > 0.95 - 3 * np.sqrt(0.95 * 0.05 / trials)


def test_intervals_of_independent_values_are_not_much_too_wide():
    random = np.random.default_rng(2)
    drawn = random.normal(size=(200, 100))
    wide = [mean_in_time(values).high - values.mean() for values in drawn]
    assert np.mean(wide) < 1.7 * 1.984 / 10
