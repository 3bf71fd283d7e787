"""Means with confidence intervals, of independent values and of correlated series, and trends."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.special import expit, logit, ndtri, stdtr, stdtrit

from lammps_skin.arrays import Floats, Ints

FEWEST = 5  # values of a series
FEWEST_BLOCKS = 20
CONFIDENCE = 0.95
POWER = 0.8  # probability with which a difference is to be seen
TREND_LEVEL = 0.01  # probability above which a trend may be chance
MEMORIES = np.linspace(0.0, 0.99, 100)  # correlations of successive values


class Mean(NamedTuple):
    """A mean, its standard error, and its confidence interval.

    Attributes
    ----------
    value : float
        Of the values that are defined (not NaN); NaN if there are none.
    error : float
        Standard error; NaN, as the interval, of too few values.
    low, high : float
    n : int
        Number of values that are defined.
    """

    value: float
    error: float
    low: float
    high: float
    n: int


def mean(
    values: Floats, confidence: float = CONFIDENCE, fraction: bool = False, least: float = -np.inf
) -> Mean:
    """Mean of independent values (n,), such as those of several seeds, after Student's t.

    With `fraction` the values are fractions, and the interval is within [0, 1]: that of the logit.
    None of the values can be below `least`, and the interval does not reach further.
    """
    values = np.asarray(values, float)
    values = values[~np.isnan(values)]
    n = len(values)
    if n < 2:
        return Mean(float(values.mean()) if n else np.nan, np.nan, np.nan, np.nan, n)
    error = float(values.std(ddof=1)) / np.sqrt(n)
    half = float(stdtrit(n - 1, (1 + confidence) / 2)) * error
    return _around(float(values.mean()), error, half, n, fraction, least)


def difference(one: Floats, other: Floats, confidence: float = CONFIDENCE) -> Mean:
    """Difference of the means of independent values (n,) and (m,), after Welch.

    `n` is the smaller number of defined values; the interval needs two of each.
    """
    first, second = mean(one), mean(other)
    value, n = first.value - second.value, min(first.n, second.n)
    if n < 2:
        return Mean(value, np.nan, np.nan, np.nan, n)
    squares = np.array([first.error, second.error]) ** 2
    error = float(np.sqrt(squares.sum()))
    if not error:
        return Mean(value, 0.0, value, value, n)
    freedom = squares.sum() ** 2 / (squares**2 / np.array([first.n - 1, second.n - 1])).sum()
    half = float(stdtrit(freedom, (1 + confidence) / 2)) * error
    return Mean(value, error, value - half, value + half, n)


def holm(chances: Floats) -> Floats:
    """Probabilities (n,) of n tests, corrected for their number after Holm; NaN stays NaN.

    With all below 0.05 taken for real, one or more is so by chance in at most 5 % of cases,
    whether the tests are independent or not.
    """
    chances = np.asarray(chances, float)
    corrected = np.full(len(chances), np.nan)
    order = np.argsort(chances, kind="stable")[: np.count_nonzero(~np.isnan(chances))]
    factors = np.arange(len(order), 0, -1)
    corrected[order] = np.minimum(np.maximum.accumulate(factors * chances[order]), 1.0)
    return corrected


def seeds_needed(noise: float, size: float) -> float:
    """Seeds of each of two conditions with which a difference of their means is seen.

    Parameters
    ----------
    noise : float
        Standard deviation, over seeds, of the difference between a run of one condition and a run
        of the other: with the same seed, if they are compared seed by seed.
    size : float
        The difference to be seen.

    Returns
    -------
    float
        With `CONFIDENCE` and `POWER`, by a t test of normal values (Guenther 1981); NaN without
        a difference.
    """
    if not size > 0 or np.isnan(noise):
        return np.nan
    level, power = float(ndtri((1 + CONFIDENCE) / 2)), float(ndtri(POWER))
    return float(np.ceil(((level + power) * noise / size) ** 2 + level**2 / 2))


def pseudo_values(statistic: Callable[[Ints], float], n: int) -> Floats:
    """Values (n,) whose mean is a statistic of n independent members, after the jackknife.

    Their mean and its interval, as `mean` gives them, are those of the statistic.

    Parameters
    ----------
    statistic : callable
        Value of the members whose indices (m,) it is given; smooth in what they contribute.
    n : int
        Number of members.
    """
    members = np.arange(n)
    if n < 2:
        return np.array([statistic(members)] * n)
    without = np.array([statistic(np.delete(members, k)) for k in members])
    return n * statistic(members) - (n - 1) * without


def first_time(times: Floats, values: Floats, level: float) -> float:
    """Time at which a series first comes to a level from below, interpolated.

    Parameters
    ----------
    times, values : (n,) ndarray
        Values that are not defined are left out.
    level : float

    Returns
    -------
    float
        The first time if the level is reached there already; NaN if it never is.
    """
    defined = ~np.isnan(values)
    times, values = times[defined], values[defined]
    reached = np.flatnonzero(values >= level)
    if not len(reached):
        return np.nan
    n = int(reached[0])
    return float(np.interp(level, values[max(n - 1, 0) : n + 1], times[max(n - 1, 0) : n + 1]))


def mean_in_time(
    values: Floats, confidence: float = CONFIDENCE, fraction: bool = False, least: float = -np.inf
) -> Mean:
    """Mean of a stationary series (n,), evenly spaced in time, whose values are correlated.

    The series is taken for a first-order autoregression. What is not known, its correlation and
    its variance, is integrated over: for each correlation phi of a grid from 0 to 0.99 the mean
    has a t distribution (generalised least squares), with a weight from the likelihood and the
    prior (1 - phi^2)^(-1/2). The interval is that of their mixture. So that noise from frame to
    frame does not hide slow changes, averages of 2, 4, ... values are taken, too, while there are
    `FEWEST_BLOCKS` of them, and of these intervals the widest.

    Parameters
    ----------
    values : (n,) array
        NaN is left out. An interval needs `FEWEST` values.
    confidence : float
    fraction : bool
        Whether the values are fractions: the interval is then within [0, 1].
    least : float
        What no value can be below: the interval does not reach further.
    """
    values = np.asarray(values, float)
    values = values[~np.isnan(values)]
    n = len(values)
    middle = float(values.mean()) if n else np.nan
    if n < FEWEST:
        return Mean(middle, np.nan, np.nan, np.nan, n)
    if not np.ptp(values):
        return Mean(middle, 0.0, middle, middle, n)
    half = _widest(values, confidence)
    error = half / float(stdtrit(n - 1, (1 + confidence) / 2))
    return _around(middle, error, half, n, fraction, least)


def _widest(values: Floats, confidence: float) -> float:
    """The widest half width, of a series (n,) and of its averages."""
    n, length, half = len(values), 1, 0.0
    while length == 1 or n // length >= FEWEST_BLOCKS:
        blocks = n // length
        averages = values[n - blocks * length :].reshape(blocks, length).mean(axis=1)
        half = max(half, _half_width(averages, confidence))
        length *= 2
    return half


def _half_width(values: Floats, confidence: float) -> float:
    """Half width of the interval around the mean of a first-order autoregression (n,)."""
    from scipy.optimize import brentq  # which takes a tenth of a second to import

    n, deviations = len(values), values - values.mean()
    squares, products = deviations @ deviations, deviations[1:] @ deviations[:-1]
    first, last = deviations[0], deviations[-1]
    phi = MEMORIES
    # generalised least squares for each phi: information of the mean, the mean, what remains
    information = (1 - phi) * (n - (n - 2) * phi)
    shift = (1 - phi) * phi * (first + last) / information
    rest = (1 + phi**2) * squares - phi**2 * (first**2 + last**2) - 2 * phi * products
    rest = np.maximum(rest - shift**2 * information, np.finfo(float).tiny)
    # of the posterior, the prior cancels the determinant of the covariance
    likelihood = -(np.log(information) + (n - 1) * np.log(rest)) / 2
    weight = np.exp(likelihood - likelihood.max())
    weight /= weight.sum()
    spread = np.sqrt(rest / ((n - 1) * information))

    def outside(half: float) -> float:
        tails = stdtr(n - 1, (-half - shift) / spread) + stdtr(n - 1, (shift - half) / spread)
        return float(weight @ tails) - (1 - confidence)

    most = float(np.abs(shift).max() + stdtrit(n - 1, (3 + confidence) / 4) * spread.max())
    return float(brentq(outside, 0.0, most))


def trend(values: Floats) -> str:
    """Whether a series (n,), evenly spaced in time, ``"rises"``, ``"falls"`` or neither.

    A straight line is fitted to a first-order autoregression, whose correlation and variance are
    integrated over as by `mean_in_time`. A slope that has the other sign with a probability of
    more than `TREND_LEVEL` / 2 is none, so that slow fluctuations are not taken for a trend. It
    is unclear if the interval of the mean reaches further than the values are apart: so few values
    may be a piece of a slow change. Else it is ``"none"``, as of fewer than `FEWEST` values; NaN
    is left out.
    """
    values = np.asarray(values, float)
    values = values[~np.isnan(values)]
    n = len(values)
    if n < FEWEST or not np.ptp(values):
        return "none"
    phi = MEMORIES[:, None]
    line = np.linspace(-1.0, 1.0, n)

    def whitened(series: Floats) -> Floats:
        first = np.sqrt(1 - phi**2) * series[0]
        return np.concatenate([first, series[1:] - phi * series[:-1]], axis=1)

    # generalised least squares for each phi: the slope beside a constant, and what remains
    level, slope = whitened(np.ones(n)), whitened(line)
    rest = whitened((values - values.mean()) / values.std())
    information = (level**2).sum(axis=1)
    for series in (slope, rest):
        series -= ((series * level).sum(axis=1) / information)[:, None] * level
    steepness = (slope**2).sum(axis=1)
    found = (slope * rest).sum(axis=1) / steepness
    remains = ((rest - found[:, None] * slope) ** 2).sum(axis=1)
    remains = np.maximum(remains, np.finfo(float).tiny)
    # of the posterior, the prior cancels the determinant of the covariance
    likelihood = -(np.log(information * steepness) + (n - 2) * np.log(remains)) / 2
    weight = np.exp(likelihood - likelihood.max())
    weight /= weight.sum()
    falls = float(weight @ stdtr(n - 2, -found * np.sqrt((n - 2) * steepness / remains)))
    if min(falls, 1 - falls) <= TREND_LEVEL / 2:
        return "falls" if falls > 0.5 else "rises"
    return "unclear" if _widest(values, CONFIDENCE) > np.ptp(values) else "none"


def _around(value: float, error: float, half: float, n: int, fraction: bool, least: float) -> Mean:
    """A mean and its interval; of a fraction symmetric in the logit, so within [0, 1]."""
    if not fraction or not 0 < value < 1:
        return Mean(value, error, max(value - half, least), value + half, n)
    center, reach = logit(value), half / (value * (1 - value))
    return Mean(value, error, float(expit(center - reach)), float(expit(center + reach)), n)
