"""Means with confidence intervals: of independent values, and of a correlated time series."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.stats import t as student

from lammps_skin.analysis.geometry import Floats

FEWEST_BLOCKS = 5


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


def mean(values: Floats, confidence: float = 0.95) -> Mean:
    """Mean of independent values (n,), such as those of several seeds, after Student's t."""
    values = np.asarray(values, float)
    values = values[~np.isnan(values)]
    return _mean(values, len(values), confidence)


def mean_in_time(values: Floats, confidence: float = 0.95) -> Mean:
    """Mean of a stationary series (n,), evenly spaced in time, by block averages.

    The series is cut into blocks; the means of blocks that are longer than the correlation are
    independent, and Student's t holds for them. The length of the blocks is doubled from a
    single value while at least `FEWEST_BLOCKS` are left, and the widest of the intervals is
    taken. So it is too narrow only where correlation is longer than a sixth of the series.

    Parameters
    ----------
    values : (n,) array
        NaN is left out. An interval needs `FEWEST_BLOCKS` values.
    confidence : float
    """
    values = np.asarray(values, float)
    values = values[~np.isnan(values)]
    n, length = len(values), 1
    widest = Mean(float(values.mean()) if n else np.nan, np.nan, np.nan, np.nan, n)
    while n // length >= FEWEST_BLOCKS:
        blocks = n // length
        averages = values[n - blocks * length :].reshape(blocks, length).mean(axis=1)
        found = _mean(averages, n, confidence)
        if not found.high - found.low <= widest.high - widest.low:
            shift = widest.value - found.value  # of the values that fill no block
            widest = found._replace(
                value=widest.value, low=found.low + shift, high=found.high + shift
            )
        length *= 2
    return widest


def _mean(values: Floats, n: int, confidence: float) -> Mean:
    """Mean of independent values that stand for n."""
    if not len(values):
        return Mean(np.nan, np.nan, np.nan, np.nan, n)
    value = float(values.mean())
    if len(values) < 2:
        return Mean(value, np.nan, np.nan, np.nan, n)
    error = float(values.std(ddof=1)) / np.sqrt(len(values))
    half = float(student.ppf((1 + confidence) / 2, len(values) - 1)) * error
    return Mean(value, float(error), value - half, value + half, n)
