"""What the ensembles say of the paper's claims, as Markdown tables.

Reads the gathered tables of `skin ensemble` (SCENE.csv.gz). Means over seeds with 95 % confidence
intervals after Student's t; a value of one seed is its mean over the window.

    python benchmarks/paper_claims.py docs/data > docs/ensembles.md
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from lammps_skin.analysis.statistics import Mean, mean
from lammps_skin.arrays import Floats
from lammps_skin.study.ensemble import Table, load, over_time, window_means
from scipy.stats import f_oneway

ARRANGEMENTS = ("ring", "cluster", "random")
ND_SCENES = ("nd-a", "nd-b", "nd-c", "nd-d")
WINDOWS = ((300, 400), (400, 600), (600, 800), (800, 1000))
LATE = (400, 1000)
ORDERS = ("chi_H", "chi_G", "zeta", "sigma")

HEAD = """\
# Ensembles

`python benchmarks/paper_claims.py docs/data` makes this page from the tables in [data](data).
[Reproduction](reproduction.md) says what follows from it and how the tables were made.

Values are means over seeds of the mean over a window of time, with 95 % confidence intervals
(Student's t over seeds). Where there is one seed there is no interval. Columns are those of
[analysis](analysis.md#table-of-observables).

* `covered to`: first time at which so much of the membrane is covered.
* `> 0 from`: first time from which on the interval stays above 0 for 50 time units.
* `zeta after chi_H by`: difference of the times at which the means over seeds first reach half of
  their mean over t = 400 to 600, after t = 200; the interval is a bootstrap over seeds.
* `F`, `p`: one-way analysis of variance over ring, cluster and random.
"""


def number(value: float, digits: int = 0) -> str:
    return "-" if np.isnan(value) else f"{value:.{digits}f}"


def interval(value: Mean, digits: int = 2) -> str:
    """Mean and confidence interval, or the value alone of one seed."""
    mean = number(value.value, digits)
    if np.isnan(value.low):
        return mean
    return f"{mean} [{number(value.low, digits)}, {number(value.high, digits)}]"


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    head = list(head)
    print("| " + " | ".join(head) + " |")
    print("|" + " --- |" * len(head))
    for row in rows:
        print("| " + " | ".join(map(str, row)) + " |")
    print()


def windows(scenes: dict[str, Table], columns: Iterable[str]) -> None:
    """Window means of columns for each scene."""
    columns = list(columns)
    table(
        ["scene", "seeds", "t", *columns],
        (
            [name, len(np.unique(data["seed"])), f"{start}-{end}",
             *(interval(mean(window_means(data, column, start, end))) for column in columns)]
            for name, data in scenes.items()
            for start, end in (*WINDOWS, LATE)
        ),
    )  # fmt: skip


def differences(scenes: dict[str, Table], pairs: Iterable[tuple[str, str]]) -> None:
    """Means over seeds of the difference of two columns in each window."""
    table(
        ["scene", "difference", *(f"{a}-{b}" for a, b in (*WINDOWS, LATE))],
        (
            [name, f"{first} - {second}",
             *(interval(mean(window_means(data, first, *w) - window_means(data, second, *w)))
               for w in (*WINDOWS, LATE))]
            for name, data in scenes.items()
            for first, second in pairs
        ),
    )  # fmt: skip


def courses(data: Table, column: str) -> tuple[Floats, Floats]:
    """Times (t,) and values (seeds, t) of a column."""
    seeds, times = np.unique(data["seed"]), np.unique(data["time"])
    return times, np.array([data[column][data["seed"] == seed] for seed in seeds])


def onset(data: Table, column: str) -> float:
    """First time from which on the interval of the mean over seeds stays above 0 for 50."""
    times, means = over_time(data, column)
    above = np.array([value.low > 0 for value in means])
    long = [above[n : n + 6].all() for n in range(len(above) - 5)]
    return float(times[int(np.argmax(long))]) if any(long) else np.nan


def half_time(times: Floats, values: Floats) -> float:
    """When a course first reaches half of its mean over t = 400 to 600, after t = 200."""
    plateau = values[(times >= 400) & (times <= 600)].mean()
    reached = (times >= 200) & (values >= plateau / 2)
    return float(times[int(np.argmax(reached))])


def lags(data: Table, draws: int = 2000) -> tuple[float, float, float]:
    """Half time of zeta less that of chi_H, of means over seeds, with a bootstrap interval."""
    times, curvature = courses(data, "chi_H")
    _, height = courses(data, "zeta")
    rng = np.random.default_rng(1)
    everyone = np.arange(len(height))
    samples = [everyone, *(rng.choice(everyone, len(everyone)) for _ in range(draws))]
    lag = [
        half_time(times, height[n].mean(axis=0)) - half_time(times, curvature[n].mean(axis=0))
        for n in samples
    ]
    low, high = np.percentile(lag[1:], [2.5, 97.5]) if len(everyone) > 1 else (np.nan, np.nan)
    return lag[0], float(low), float(high)


def covered(data: Table, level: float) -> Mean:
    """First time at which so much of the membrane is covered, NaN if it never is."""
    times, coverage = courses(data, "coverage")
    reached = coverage >= level
    return mean(np.where(reached.any(axis=1), times[np.argmax(reached, axis=1)], np.nan))


def beginnings(scenes: dict[str, Table]) -> None:
    """When the membrane is covered, and when the order parameters rise."""
    rows = []
    for name, data in scenes.items():
        lag, low, high = lags(data)
        rows.append(
            [name, interval(covered(data, 0.9), 0), interval(covered(data, 0.98), 0),
             *(number(onset(data, column)) for column in ("chi_H", "chi_G", "zeta")),
             number(lag) if np.isnan(low) else f"{lag:.0f} [{low:.0f}, {high:.0f}]"]
        )  # fmt: skip
    head = ["scene", "covered to 0.9", "to 0.98", "chi_H > 0 from", "chi_G > 0 from",
            "zeta > 0 from", "zeta after chi_H by"]  # fmt: skip
    table(head, rows)


def arrangements(scenes: dict[str, Table]) -> None:
    """One-way analysis of variance: does the arrangement matter?"""
    rows = []
    for column in (*ORDERS, "papillae", "skewness"):
        for start, end in ((200, 400), LATE, (800, 1000)):
            groups = [window_means(data, column, start, end) for data in scenes.values()]
            test = f_oneway(*(group[~np.isnan(group)] for group in groups))
            rows.append([column, f"{start}-{end}", f"{test.statistic:.2f}", f"{test.pvalue:.3f}"])
    table(["column", "t", "F", "p"], rows)


def report(folder: Path, size: str) -> None:
    """All tables of the scenes of one size."""

    def of(names: Iterable[str]) -> dict[str, Table]:
        paths = {name: folder / f"{size}-{name}.csv.gz" for name in names}
        return {name: load(path) for name, path in paths.items() if path.exists()}

    ring, nd = of(ARRANGEMENTS), of(ND_SCENES)
    if not ring and not nd:
        return
    print(f"## Scenes of the {size} size\n\n### Stem cells\n")
    windows({**ring, **nd}, ORDERS)
    print("### Coverage, folds\n")
    windows({**ring, **nd}, ("coverage", "skewness", "papillae", "papilla_height"))
    print("### Beginnings\n")
    beginnings({**ring, **nd})
    if len(ring) > 1 and min(len(np.unique(data["seed"])) for data in ring.values()) > 1:
        print("### Does the arrangement matter?\n")
        arrangements(ring)
    print("### Tips\n")
    differences({**ring, **nd}, [("stem_on_tips", "stem_tips_expected")])
    if nd:
        print("### ND cells\n")
        windows(nd, (f"{name}_nd" for name in ORDERS))
        differences(nd, [(f"{name}_nd", name) for name in ORDERS])
        differences(nd, [("nd_on_tips", "nd_tips_expected")])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    options = parser.parse_args()
    print(HEAD)
    for size in ("quarter", "paper"):
        report(options.folder, size)


if __name__ == "__main__":
    main()
