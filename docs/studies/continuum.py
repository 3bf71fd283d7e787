"""The continuum equation beside runs, for docs/studies/continuum.md.

Each run has a seed of its own, and frames every 5 time units:

    skin run quarter-random --seed 1 --until 600 --set output.dump_interval=5.0 -o runs/random-1
    skin run quarter-random --seed 2 --until 600 --set output.dump_interval=5.0 -o runs/random-2
    python docs/studies/continuum.py runs/random-1 runs/random-2 -o continuum

Writes tables into the folder, prints their means over seeds with 95 % intervals, and draws them as
continuum.png. Without runs it reads the tables of the folder.
"""

from __future__ import annotations

import argparse
import csv
from collections import defaultdict
from pathlib import Path

import numpy as np
from lammps_skin import open_trajectory
from lammps_skin.analysis.pressure import LateralPressure
from lammps_skin.analysis.statistics import mean
from lammps_skin.figures.snapshot import save
from lammps_skin.files import atomic_write
from lammps_skin.kinds import is_cell
from lammps_skin.study.continuum.comparison import (
    Fields,
    coefficients,
    growth,
    likeness,
    skewness,
)
from lammps_skin.study.continuum.equation import Continuum
from lammps_skin.study.continuum.response import measure
from lammps_skin.study.ranges import Window
from lammps_skin.style import plain
from matplotlib.axes import Axes
from matplotlib.figure import Figure

MODES = np.array([1, 2, 3, 4, 6, 8, 10, 12, 16, 20])  # of L_x, pushed
PUSH = 0.002
QUIET, ONSET = Window(100, 150), Window(250, 300)
WINDOWS = [ONSET, Window(300, 350), Window(350, 400), Window(400, 500), Window(500, 600)]
WAYS = ((50.0, 0), (5.0, 0), (5.0, 2))  # intervals, and how many of them instruments lie before
LONG = (0.0, 1.0)  # wave numbers of waves longer than two cells
BANDS = [(k, k + 0.25) for k in np.arange(0.25, 2.25, 0.25).tolist()]
BEGIN, TIMES = 200.0, np.array([200.0, 250.0, 300.0, 350.0])


def study(run: str) -> dict[str, list[dict[str, float]]]:
    """Rows of each table, of one run."""
    universe = open_trajectory(run)
    scene, seed = universe.trajectory.scene, float(universe.trajectory.seed)
    interval = universe.trajectory.dt
    found = LateralPressure(universe).run(start=round(QUIET.start / interval)).results
    sides = scene.box_sides[:2]
    area = sides[0] * sides[1]
    fields = Fields(found.time, found.height, found.pressure, sides)
    universe.trajectory[round(ONSET.start / interval)]
    cells = int(is_cell(universe.trajectory.ts.data["species"]).sum())

    answer = measure(scene, MODES, PUSH)
    mobility, rate = answer.fitted()
    particles = np.prod(scene.membrane.lattice) / area
    drag = particles / mobility[answer.wave_numbers < LONG[1]].mean() + cells / area
    known = np.concatenate([[0.0], answer.wave_numbers])
    resists = np.concatenate([[0.0], particles * rate / mobility])

    def restoring(k: np.ndarray) -> np.ndarray:
        beyond = resists[-1] * (k / known[-1]) ** 2
        return np.where(k > known[-1], beyond, np.interp(k, known, resists))

    continuum = Continuum(drag, scene.cells.radius, restoring)
    within = (found.time >= ONSET.start) & (found.time <= ONSET.end)
    pull = float(found.mean[within].mean())
    tables: dict[str, list[dict[str, float]]] = {"numbers": [
        {"seed": seed, "drag": drag, "pull": pull, "roughness": fields.within(ONSET).height.std()}
    ]}  # fmt: skip
    tables["response"] = [
        dict(zip(("seed", "k", "mobility", "rate", "relaxed"), row, strict=True))
        for row in np.column_stack(
            [np.full(len(rate), seed), answer.wave_numbers, mobility, rate, answer.relaxed()]
        ).tolist()
    ]
    grown = growth(fields, QUIET, ONSET, BANDS)
    tables["waves"] = []
    for band, seen in zip(BANDS, grown.tolist(), strict=True):
        k = sum(band) / 2
        parts = coefficients(fields.within(ONSET), continuum, 25.0, band)
        expected = float(continuum.growth(np.array([k]), pull)[0])
        tables["waves"].append({"seed": seed, "k": k, "growth": seen, "expected": expected,
                                **parts._asdict()})  # fmt: skip
    tables["terms"] = [
        {"seed": seed, "start": window.start, "end": window.end, "interval": interval,
         "earlier": earlier,
         **coefficients(fields.within(window), continuum, interval, LONG, earlier)._asdict()}
        for window in WINDOWS for interval, earlier in WAYS
    ]  # fmt: skip
    coarse = fields.coarse(2 * scene.cells.radius)
    begin = int(np.searchsorted(coarse.time, BEGIN))
    tables["solution"] = []
    above = scene.cells.radius + scene.membrane.radius
    for lever in (0.0, scene.cells.radius, above):
        lifted = Continuum(drag, lever, restoring)
        solved = lifted.solve(coarse.height[begin], coarse.pull_at, sides, TIMES)
        for time, height in zip(TIMES.tolist(), solved, strict=True):
            there = coarse.height[int(np.searchsorted(coarse.time, time))]
            tables["solution"].append(
                {"seed": seed, "lever": lever, "time": time, "likeness": likeness(height, there),
                 "roughness": height.std(), "roughness_seen": there.std(),
                 "skewness": skewness(height), "skewness_seen": skewness(there)}
            )  # fmt: skip
    return tables


def averaged(rows: list[dict[str, float]], by: str, column: str) -> np.ndarray:
    """Mean over seeds and 95 % interval (n, 4) of a column, in order of another: first that."""
    groups = defaultdict(list)
    for row in rows:
        groups[row[by]].append(row[column])
    means = [(key, mean(np.array(values))) for key, values in sorted(groups.items())]
    return np.array([(key, found.value, found.low, found.high) for key, found in means])


def tell(rows: list[dict[str, float]], by: str, columns: dict[str, str]) -> None:
    """Print a table in Markdown, a row for each value of a column, with means of others."""
    print("| " + " | ".join(columns) + " |")
    print("|" + " --- |" * len(columns))
    found = [averaged(rows, by, column) for column in columns.values()]
    for n, (key, *_) in enumerate(found[0]):
        cells = [f"{key:.3g}"]
        cells += [f"{value:.2g} [{low:.2g}, {high:.2g}]" for _, value, low, high in
                  (means[n] for means in found[1:])]  # fmt: skip
        print("| " + " | ".join(cells) + " |")
    print()


def tell_all(tables: dict[str, list[dict[str, float]]]) -> None:
    """Print what the page shows."""
    tell(tables["response"], "k",
         {"wave number": "k", "mobility": "mobility", "rate, pushed": "rate",
          "rate, let go": "relaxed"})  # fmt: skip
    tell(tables["waves"], "k",
         {"wave number": "k", "growth in runs": "growth", "of the equation": "expected",
          "first term": "first", "second term": "second", "explained": "explained"})  # fmt: skip
    for interval, earlier in WAYS:
        chosen = [row for row in tables["terms"]
                  if (row["interval"], row["earlier"]) == (interval, earlier)]  # fmt: skip
        columns = {"t from": "start", "first term": "first", "second term": "second"}
        tell(chosen, "start", columns if earlier else columns | {"explained": "explained"})
    for lever in sorted({row["lever"] for row in tables["solution"]}):
        chosen = [row for row in tables["solution"] if row["lever"] == lever]
        tell(chosen, "time",
             {"t": "time", "likeness": "likeness", "roughness": "roughness",
              "roughness in runs": "roughness_seen", "skewness": "skewness",
              "skewness in runs": "skewness_seen"})  # fmt: skip
    pull = averaged([row | {"all": 0.0} for row in tables["numbers"]], "all", "pull")[0]
    drag = averaged([row | {"all": 0.0} for row in tables["numbers"]], "all", "drag")[0]
    print(f"K_a: {pull[1]:.2g} [{pull[2]:.2g}, {pull[3]:.2g}]")
    print(f"tau: {drag[1]:.3g} [{drag[2]:.3g}, {drag[3]:.3g}]")


@plain
def draw(tables: dict[str, list[dict[str, float]]]) -> Figure:
    """Rates against wave number, coefficients against wave number and against time."""
    figure = Figure(figsize=(13, 4), layout="constrained")
    rates, waves, course = figure.subplots(1, 3)
    for name, table, column in (("growth, equation", "waves", "expected"),
                                ("growth, runs", "waves", "growth"),
                                ("relaxation of the membrane", "response", "rate")):  # fmt: skip
        bars(rates, averaged(tables[table], "k", column), name)
    rates.set(xlabel="wave number", ylabel="rate, 1/time", ylim=(-0.005, 0.07), xlim=(0, 2.2))
    rates.legend(frameon=False)
    for name, column in (("first term (equation: 1)", "first"),
                         ("second term (equation: 1.4)", "second")):  # fmt: skip
        bars(waves, averaged(tables["waves"], "k", column), name)
        rows = [row | {"middle": (row["start"] + row["end"]) / 2}
                for row in tables["terms"] if row["interval"] == 50.0]  # fmt: skip
        bars(course, averaged(rows, "middle", column), name)
    rows = [row | {"middle": (row["start"] + row["end"]) / 2}
            for row in tables["terms"] if row["earlier"]]  # fmt: skip
    bars(course, averaged(rows, "middle", "second"), "second term, with instruments")
    for axes in (waves, course):
        axes.axhline(1, color="grey", linewidth=0.8)
    waves.set(xlabel="wave number", ylabel="coefficient, t = 250-300", ylim=(-0.2, 4))
    course.set(xlabel="time", ylabel="coefficient, wave numbers below 1", ylim=(0, 1.5))
    course.legend(frameon=False)
    return figure


def bars(axes: Axes, means: np.ndarray, label: str) -> None:
    """Means with intervals."""
    place, value, low, high = means.T
    axes.errorbar(place, value, [value - low, high - value], fmt="o-", capsize=3, label=label)


def write(path: Path, rows: list[dict[str, float]]) -> None:
    """A table of numbers of five digits."""
    with atomic_write(path) as part, part.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: f"{x:.5g}" for key, x in row.items()} for row in rows)


def read(path: Path) -> list[dict[str, float]]:
    """The rows of a table."""
    with path.open(newline="") as file:
        return [{key: float(x) for key, x in row.items()} for row in csv.DictReader(file)]


def main() -> None:
    """Read runs or tables, tell and draw them."""
    parser = argparse.ArgumentParser(description="The continuum equation beside runs.")
    parser.add_argument("runs", nargs="*")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--picture", type=Path)
    asked = parser.parse_args()
    asked.output.mkdir(parents=True, exist_ok=True)
    tables: dict[str, list[dict[str, float]]] = defaultdict(list)
    for run in asked.runs:
        for name, rows in study(run).items():
            tables[name] += rows
    for name, rows in tables.items():
        write(asked.output / f"{name}.csv", rows)
    tables = {path.stem: read(path) for path in sorted(asked.output.glob("*.csv"))}
    tell_all(tables)
    save(draw(tables), asked.picture or asked.output / "continuum.png")


if __name__ == "__main__":
    main()
