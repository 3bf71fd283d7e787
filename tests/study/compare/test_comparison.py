"""Made-up tables of known answers: chance is as often taken for real as it says, no more."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.analysis.derived import course
from lammps_skin.analysis.statistics import first_time, holm, seeds_needed
from lammps_skin.errors import SkinError
from lammps_skin.study.compare.comparison import (
    PAIRED,
    WELCH,
    compare,
    contrast,
    remarks,
    usual_columns,
)
from lammps_skin.study.compare.conditions import Condition
from lammps_skin.study.ranges import Window

TIMES = np.arange(0.0, 100.0, 2.0)
MEMORY = 0.95  # correlation of successive frames


def condition(
    name: str, seeds: list[int], level: float = 0.0, random: int = 0, shared: float = 0.0
) -> Condition:
    """Series of zeta with a long memory; a part of each is that of its seed, whatever the name."""
    parts = []
    for seed in seeds:
        own = np.random.default_rng([random, seed, *name.encode()])
        walk = [own.normal()]
        for _ in TIMES[1:]:
            walk.append(MEMORY * walk[-1] + np.sqrt(1 - MEMORY**2) * own.normal())
        part = np.zeros(len(TIMES), [("seed", float), ("time", float), ("zeta", float)])
        common = shared * np.random.default_rng([random, seed]).normal()
        part["seed"], part["time"], part["zeta"] = seed, TIMES, level + common + np.array(walk)
        parts.append(part)
    return Condition(name, np.concatenate(parts), None, Path(name))


def compared(*conditions: Condition):
    return compare(conditions, ["zeta"], [Window(0, 100)])


@pytest.mark.parametrize(("others", "test"), [(range(1, 7), PAIRED), (range(11, 16), WELCH)])
def test_false_positives(others: range, test: str) -> None:
    """Of 400 comparisons of equals 5 % have p below 0.05, though frames are correlated."""
    chances = []
    for n in range(400):
        one = condition("one", list(range(1, 7)), random=n)
        _, row = compared(one, condition("other", list(others), random=n))
        assert row.difference.test == test
        chances.append(row.difference.chance)
        low, high = row.difference.value.low, row.difference.value.high
        assert (row.difference.chance < 0.05) == (low > 0 or high < 0)
    assert 0.02 < np.mean(np.array(chances) < 0.05) < 0.08
    assert 0.4 < np.mean(np.array(chances) < 0.5) < 0.6


def test_power_is_that_of_the_seeds_needed() -> None:
    """With as many seeds as are said to be needed, four of five experiments see a difference."""
    size, spread, trials = 1.0, 1.0, 2000
    needed = int(seeds_needed(np.sqrt(2) * spread, size))
    random = np.random.default_rng(1)
    for paired in (True, False):
        others = range(needed) if paired else range(needed, 2 * needed)
        seen = [
            contrast(
                dict(zip(others, size + random.normal(size=needed), strict=True)),
                dict(zip(range(needed), random.normal(size=needed), strict=True)),
            ).chance
            < 0.05
            for _ in range(trials)
        ]
        assert 0.77 < np.mean(seen) < 0.88


def test_seeds_needed() -> None:
    """As tables of the power of t tests have it: Cohen (1988), 0.2, 0.5 and 0.8 deviations."""
    found = [seeds_needed(1.0, size) for size in (0.2, 0.5, 0.8)]
    assert found == [199, 34, 15]
    assert seeds_needed(0.0, 1.0) == 2
    assert np.isnan([seeds_needed(1.0, 0.0), seeds_needed(np.nan, 1.0)]).all()


def test_pairs_gain_what_seeds_have_in_common() -> None:
    """A difference that the spread over seeds hides is seen seed by seed, with fewer seeds."""
    seeds = list(range(1, 9))
    one, other = (
        condition("one", seeds, 0.0, shared=5.0),
        condition("other", seeds, 3.0, shared=5.0),
    )
    paired = compared(one, other)[1].difference
    apart = condition("apart", [seed + 10 for seed in seeds], 3.0, shared=5.0)
    welch = compared(one, apart)[1].difference
    assert (paired.test, welch.test) == (PAIRED, WELCH)
    assert paired.chance < 0.001 and paired.value.low > 0
    assert paired.value.error < welch.value.error / 3
    assert paired.needed < welch.needed / 5 and paired.needed_usual < welch.needed_usual / 5


def test_one_seed_has_a_difference_but_no_test() -> None:
    one, other = condition("one", [1]), condition("other", [1], 2.0)
    first, second = compared(one, other)
    assert first.value.value == pytest.approx(one.table["zeta"].mean())
    apart = second.difference
    assert apart.value.value == pytest.approx(second.value.value - first.value.value)
    assert apart.test == "" and np.isnan([apart.chance, apart.value.low, apart.needed]).all()
    (line,) = remarks([one, other], [first, second])
    assert line.startswith("one seed each: differences are shown without a test")


def test_what_never_varies() -> None:
    apart = contrast({1: 3.0, 2: 3.0}, {1: 2.0, 2: 2.0})
    assert (apart.value.value, apart.value.low, apart.value.high) == (1.0, 1.0, 1.0)
    assert np.isnan([apart.chance, apart.needed_usual]).all()


def test_a_seed_without_a_value_is_left_out() -> None:
    full = contrast({1: 3.0, 2: 4.0, 4: 7.0}, {1: 1.0, 2: 2.5, 4: 3.0})
    apart = contrast({1: 3.0, 2: 4.0, 3: np.nan, 4: 7.0}, {1: 1.0, 2: 2.5, 3: 5.0, 4: 3.0})
    assert apart.test == PAIRED and apart.value == full.value and apart.chance == full.chance


def test_correction_for_many_tests() -> None:
    assert holm(np.array([0.01, 0.04, 0.03, np.nan])) == pytest.approx(
        [0.03, 0.06, 0.06, np.nan], nan_ok=True
    )
    random, wrong = np.random.default_rng(1), 0
    for _ in range(1000):
        wrong += (holm(random.uniform(size=20)) < 0.05).any()
    assert 0.03 < wrong / 1000 < 0.07
    conditions = condition("one", [1, 2, 3]), condition("other", [1, 2, 3], 1.0)
    rows = compare(conditions, ["zeta"], [Window(0, 50), Window(50, 100)])
    chances = [row.difference.chance for row in rows if row.difference]
    assert [row.corrected for row in rows if row.difference] == pytest.approx(holm(chances))
    assert remarks(conditions, rows)[-1].startswith("2 tests: ")


def test_columns_and_windows() -> None:
    one, other = condition("one", [1, 2]), condition("other", [1, 2])
    assert usual_columns([one, other]) == ["zeta"]
    with pytest.raises(SkinError, match=r"--columns zetta: one .* did you mean zeta\?"):
        one.check(["zeta", "zetta"])
    with pytest.raises(SkinError, match="have no values in t = 200-300"):
        compare([one, other], ["zeta"], [Window(200, 300)])
    with pytest.raises(SkinError, match="'zeta-zeta-zeta' must be the difference of two"):
        one.check(["zeta-zeta-zeta"])
    one.check(["zeta-zeta", "zeta-zeta>0.5"])
    nothing = course(one.table, "zeta-zeta")
    assert not nothing.any() and nothing.shape == one.table.shape


def test_when_a_level_is_reached() -> None:
    """On a straight line between frames; at once where it is reached already, else never."""
    times = np.array([0.0, 10.0, 20.0, 30.0])
    assert first_time(times, np.array([0.0, 1.0, np.nan, 3.0]), 2.5) == 10.0 + 20.0 * 0.75
    assert first_time(times, np.array([5.0, 4.0, 3.0, 2.0]), 2.5) == 0.0
    assert np.isnan(first_time(times, np.array([0.0, 1.0, 2.0, 2.4]), 2.5))
    one = condition("one", [1])
    one.table["zeta"] = one.table["time"] / 50
    other = replace(one, name="other", table=one.table.copy())
    other.table["zeta"] *= 2
    rows = compare([one, other], ["zeta>1.5"], [Window(20, 98)])
    assert [row.value.value for row in rows] == pytest.approx([55.0, 17.5])
    assert not remarks([one, other], rows)[1:]
    flat = replace(condition("flat", [1, 2]), table=condition("flat", [1, 2]).table.copy())
    flat.table["zeta"] = np.where(flat.table["seed"] == 1, flat.table["time"] / 50, 0.0)
    rows = compare([one, flat], ["zeta>1.5"], [Window(20, 98)])
    assert [(row.value.value, row.value.n) for row in rows] == [(55.0, 1), (55.0, 1)]
    assert "zeta>1.5: a run that never comes to the level" in " ".join(remarks([one, flat], rows))
    with pytest.raises(SkinError, match=r"zeta>high: one .*: 'high' must be a number"):
        one.check(["zeta>high"])
