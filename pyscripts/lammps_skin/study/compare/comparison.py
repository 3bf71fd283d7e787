"""What differs between conditions, and whether more than by chance: seeds are what is counted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.stats import ttest_1samp, ttest_ind

from lammps_skin.analysis.derived import COUNTS, average, course, parts, statistic
from lammps_skin.analysis.observables import REACHES
from lammps_skin.analysis.statistics import Mean, difference, holm, mean, seeds_needed
from lammps_skin.arrays import Floats
from lammps_skin.errors import SkinError
from lammps_skin.study.compare.conditions import Condition
from lammps_skin.study.ranges import Window
from lammps_skin.study.tradeoff.bias import EFFECT, MEANS

ON_TIPS = ("stem_on_tips-stem_tips_expected", "nd_on_tips-nd_tips_expected")
USUAL = (*MEANS, *ON_TIPS, *COUNTS)  # columns that are compared if none are named
PAIRED, WELCH = "paired", "Welch"
SIGNIFICANT = 0.05


class Difference(NamedTuple):
    """Of the means of two conditions.

    Attributes
    ----------
    value : Mean
        With its interval; without one where one of them has one seed.
    test : str
        `PAIRED` by seed, `WELCH`, or nothing where there can be none.
    chance : float
        Probability of a difference so large where there is none, two-sided; NaN without a test.
    needed : float
        Seeds of each with which a difference of the size seen would be seen.
    needed_usual : float
        The same for one of `EFFECT` standard deviations over seeds.
    """

    value: Mean
    test: str
    chance: float
    needed: float
    needed_usual: float


class Row(NamedTuple):
    """One column of one condition in one window.

    Attributes
    ----------
    column : str
    window : Window
    condition : str
    value : Mean
        Over seeds.
    difference : Difference or None
        From the first condition; None of the first one itself.
    corrected : float
        The probability of its test, corrected for the number of all tests.
    """

    column: str
    window: Window
    condition: str
    value: Mean
    difference: Difference | None = None
    corrected: float = np.nan


def usual_columns(conditions: Sequence[Condition]) -> list[str]:
    """Those of `USUAL` that all conditions have, and in which one of them has values."""
    return [
        name
        for name in USUAL
        if all(set(parts(name)) <= set(one.columns) for one in conditions)
        and any(not np.isnan(course(one.table, name)).all() for one in conditions)
    ]


def compare(
    conditions: Sequence[Condition], columns: Sequence[str], windows: Sequence[Window]
) -> list[Row]:
    """All columns in all windows, each condition beside the first.

    Parameters
    ----------
    conditions : sequence of Condition
        With what these columns are made of, see `Condition.check`.
    columns : sequence of str
    windows : sequence of Window
        Columns that count events, births and deaths, are counted during each; of others the mean
        is taken.

    Raises
    ------
    SkinError
        If nothing has a value.
    """
    cases = [(name, window) for name in columns for window in windows]
    rows = [row for name, window in cases for row in _rows(conditions, name, window)]
    if not rows:
        raise SkinError(
            f"columns {', '.join(columns)}: have no values in t = {', '.join(map(str, windows))}"
        )
    chances = [row.difference.chance if row.difference else np.nan for row in rows]
    together = zip(rows, holm(np.array(chances)), strict=True)
    return [row._replace(corrected=float(chance)) for row, chance in together]


def _rows(conditions: Sequence[Condition], column: str, window: Window) -> Iterator[Row]:
    """Of one column in one window; none of a condition that has no value."""
    values = [
        {seed: statistic(table, column, window) for seed, table in one.by_seed.items()}
        for one in conditions
    ]
    for number, (one, by_seed) in enumerate(zip(conditions, values, strict=True)):
        value = average(_defined(by_seed), column)
        if not value.n:
            continue
        apart = contrast(by_seed, values[0]) if number else None
        yield Row(column, window, one.name, value, apart)


def contrast(one: Mapping[int, float], other: Mapping[int, float]) -> Difference:
    """Difference of the means of a statistic, from its values by seed.

    Seed by seed where both have the same seeds, at least two; after Welch where they have not.
    """
    first, second = _defined(one), _defined(other)
    if one.keys() == other.keys() and len(one) > 1:
        apart = _defined({seed: one[seed] - other[seed] for seed in one})
        value, test, noise = mean(apart), PAIRED, _spread(apart)
    else:
        value, test = difference(first, second), WELCH
        noise = float(np.hypot(_spread(first), _spread(second)))
    usual = EFFECT * float(np.hypot(_spread(first), _spread(second)) / np.sqrt(2))
    needed = seeds_needed(noise, abs(value.value)), seeds_needed(noise, usual)
    if np.isnan(value.error):
        return Difference(value, "", np.nan, *needed)
    if not value.error:  # it never varies, and there is no chance
        return Difference(value, test, np.nan, *needed)
    if test == PAIRED:
        chance = ttest_1samp(apart, 0.0).pvalue
    else:
        chance = ttest_ind(first, second, equal_var=False).pvalue
    return Difference(value, test, float(chance), *needed)


def _defined(by_seed: Mapping[int, float]) -> Floats:
    values = np.array([by_seed[seed] for seed in sorted(by_seed)])
    return values[~np.isnan(values)]


def _spread(values: Floats) -> float:
    """Standard deviation over seeds; NaN of fewer than two."""
    return float(values.std(ddof=1)) if len(values) > 1 else np.nan


def remarks(conditions: Sequence[Condition], rows: Sequence[Row]) -> list[str]:
    """How conditions were compared, and what to make of many tests."""
    first, lines = conditions[0], []
    ways = {PAIRED: "seed by seed", WELCH: "after Welch, since not all seeds are the same"}
    for test, how in ways.items():
        names = dict.fromkeys(
            row.condition for row in rows if row.difference and row.difference.test == test
        )
        if names:
            lines.append(f"{', '.join(names)}: compared with {first.name} {how}")
    single = [one.name for one in conditions if one.seeds == 1]
    if single:
        of = "each" if len(single) == len(conditions) else f"of {', '.join(single)}"
        lines.append(
            f"one seed {of}: differences are shown without a test, since nothing tells how much "
            "of them is chance; run several seeds"
        )
    told = {(row.column, row.window, row.condition) for row in rows}
    for column, window in dict.fromkeys((row.column, row.window) for row in rows):
        without = [one.name for one in conditions if (column, window, one.name) not in told]
        if without:
            lines.append(f"{column}, t = {window}: has no value in {', '.join(without)}")
    seeds = {one.name: one.seeds for one in conditions}
    levels = [row for row in rows if REACHES in row.column and row.value.n < seeds[row.condition]]
    if levels:
        lines.append(
            f"{', '.join(dict.fromkeys(row.column for row in levels))}: a run that never comes to "
            "the level has no value, so that the mean over the others is too early"
        )
    tests = sum(not np.isnan(row.corrected) for row in rows)
    if tests > 1:
        lines.append(
            f"{tests} tests: where there is no difference at all, about {SIGNIFICANT * tests:.2g} "
            f"of them have p below {SIGNIFICANT:g}; the corrected p (Holm) allows for all of them"
        )
    return lines
