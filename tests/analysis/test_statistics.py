"""Means and their intervals: by hand, and how often they hold the truth."""

import numpy as np
import pytest
import scipy.stats
from lammps_skin.analysis.statistics import difference, mean, mean_in_time, pseudo_values, trend


def test_mean_by_hand():
    found = mean(np.array([1.0, np.nan, 2.0, 6.0]))
    assert found.value == 3 and found.n == 3
    assert found.error == pytest.approx(np.sqrt(7 / 3))
    low, high = scipy.stats.t(2, 3, np.sqrt(7 / 3)).interval(0.95)
    assert (found.low, found.high) == pytest.approx((low, high))


def test_difference_of_means():
    one, other = np.array([1.0, np.nan, 2.0, 6.0]), np.array([0.5, 0.7, 0.2, 0.1, 0.4])
    found = difference(one, other, 0.9)
    welch = scipy.stats.ttest_ind(one[~np.isnan(one)], other, equal_var=False)
    assert found.value == pytest.approx(3 - 0.38) and found.n == 3
    assert (found.low, found.high) == pytest.approx(tuple(welch.confidence_interval(0.9)))
    assert np.isnan(difference(one, other[:1])[1:4]).all()
    assert difference(np.ones(3), np.zeros(3)) == (1, 0, 1, 1, 3)


def test_pseudo_values():
    """Those of a mean are the values; those of a ratio have the error of the delta method."""
    one = np.random.default_rng(3).normal(2.0, 0.1, 40)
    other = np.random.default_rng(4).normal(1.0, 0.1, 40)
    np.testing.assert_allclose(pseudo_values(lambda members: one[members].mean(), 40), one)
    ratio = mean(pseudo_values(lambda members: one[members].mean() / other[members].mean(), 40))
    assert ratio.value == pytest.approx(one.mean() / other.mean(), rel=1e-3)
    linear = one - other * one.mean() / other.mean()
    assert ratio.error == pytest.approx(mean(linear).error / other.mean(), rel=0.05)
    np.testing.assert_allclose(pseudo_values(lambda members: one[members].mean(), 1), one[:1])


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


def series(random, trials, n, memory, noise=0.0):
    """Stationary series (trials, n) of mean 0, a first-order autoregression, and noise."""
    draws = random.normal(size=(n, trials))
    values = [draws[0]]
    for draw in draws[1:]:
        values.append(memory * values[-1] + np.sqrt(1 - memory**2) * draw)
    return np.array(values).T + noise * random.normal(size=(trials, n))


def coverage(drawn):
    """Share of series whose interval holds the truth, and the standard error of it at 95 %."""
    means = [mean_in_time(values) for values in drawn]
    hits = np.mean([one.low < 0 < one.high for one in means])
    return hits, np.sqrt(0.95 * 0.05 / len(drawn))


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.8, 0.9])
@pytest.mark.parametrize("n", [20, *(pytest.param(n, marks=pytest.mark.slow) for n in (40, 120))])
def test_intervals_of_correlated_series_hold_the_truth(n, memory):
    hits, error = coverage(series(np.random.default_rng(n), 300, n, memory))
    assert hits > 0.95 - 3 * error


def test_noise_does_not_hide_slow_changes():
    hits, error = coverage(series(np.random.default_rng(7), 200, 400, 0.8, noise=0.5))
    assert hits > 0.95 - 3.5 * error


def test_the_interval_that_takes_values_as_independent_does_not():
    drawn = series(np.random.default_rng(1), 300, 120, 0.8)
    assert np.mean([one.low < 0 < one.high for one in map(mean, drawn)]) < 0.75
    assert all(mean_in_time(values).value == values.mean() for values in drawn[:5])


def test_intervals_of_independent_values_are_not_much_too_wide():
    drawn = np.random.default_rng(2).normal(size=(200, 100))
    wide = [mean_in_time(values).high - values.mean() for values in drawn]
    assert np.mean(wide) < 1.7 * 1.984 / 10


@pytest.mark.parametrize("of", [mean, mean_in_time])
@pytest.mark.parametrize("values", [[0.9, 1, 1, 1, 1, 1], [0, 0, 0, 0.1, 0, 0.3], [0.4, 0.6] * 30])
def test_intervals_of_fractions_are_fractions(of, values):
    found = of(np.array(values), fraction=True)
    assert 0 <= found.low < found.value < found.high <= 1
    plain = of(np.array(values))
    middle = plain.low > 0.3 and plain.high < 0.7
    assert middle or plain.low < 0 or plain.high > 1
    if middle:  # there it is the same, to first order
        assert (found.low, found.high) == pytest.approx((plain.low, plain.high), abs=0.01)


@pytest.mark.parametrize("of", [mean, mean_in_time])
@pytest.mark.parametrize("value", [0.0, 1.0])
def test_a_fraction_that_does_not_change(of, value):
    assert of(np.full(6, value), fraction=True) == (value, 0, value, value, 6)


@pytest.mark.parametrize("of", [mean, mean_in_time])
def test_intervals_of_what_cannot_be_negative(of):
    values = np.array([0.0, 0, 1, 0, 9, 18, 20])
    found, free = of(values, least=0.0), of(values)
    assert found.low == 0 > free.low
    assert (found.value, found.error, found.high) == (free.value, free.error, free.high)


@pytest.mark.filterwarnings("error")
def test_trends_by_sight():
    draws, line = np.random.default_rng(3).normal(size=20), np.arange(20.0)
    assert trend(line + draws) == trend(line) == trend(np.exp(line / 4)) == "rises"
    assert trend(-line + draws) == trend(5 * np.exp(-line / 5) + 0.1 * draws) == "falls"
    assert (
        trend(draws) == trend(np.full(20, 3.0)) == trend(line[:4]) == trend(np.array([])) == "none"
    )
    assert trend(np.where(line % 3 == 0, np.nan, line + draws)) == "rises"


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("n", [7, 20, 60])
def test_stationary_series_seldom_have_a_trend(n, memory):
    drawn = series(np.random.default_rng(n), 400, n, memory)
    wrong = np.mean([trend(values) in ("rises", "falls") for values in drawn])
    assert wrong < 0.01 + 3 * np.sqrt(0.01 / 400), wrong


def test_what_changes_slowly_is_not_taken_for_stationary():
    random = np.random.default_rng(5)
    quick = [trend(values) for values in random.normal(size=(100, 40))]
    slow = [trend(values) for values in np.cumsum(random.normal(size=(100, 40)), axis=1)]
    assert quick.count("none") > 95 and slow.count("none") < 40
    late = np.array([1.0, 1, 1, 1, 1, 1, 1, 1.01, 1.1, 1.2])
    assert trend(late) == "unclear"
