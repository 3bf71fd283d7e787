"""What `skin check` expects of runs, beside what they cost, and the rates of which it is made.

Seconds are CPU time of the thread that runs LAMMPS, output and checkpoints included, so that they
hardly depend on how busy the machine is. `runs` runs scenes to their end, piece by piece. `samples`
runs short pieces that begin with states of a run that is there: for runs that would take too long.
`fit` makes rates (`lammps_skin.study.rates`) of all runs; `table` compares what was measured with
what is expected.

    python benchmarks/run_cost.py runs demo quarter-ring --levels balanced fast --keep runs/costs
    python benchmarks/run_cost.py samples runs/costs/quarter-ring-balanced --levels reference
    python benchmarks/run_cost.py fit
    python benchmarks/run_cost.py table

The pieces are in docs/data/run-costs.csv; a scene that is measured anew replaces its pieces there.
"""

from __future__ import annotations

import argparse
import csv
import tempfile
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from dataclasses import fields, replace
from itertools import groupby
from pathlib import Path

import numpy as np
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.accuracy import LEVELS
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.study.cost import estimate
from lammps_skin.study.rates import SHIPPED, Rates
from scipy.optimize import linprog

DATA = Path(__file__).resolve().parent.parent / "docs" / "data" / "run-costs.csv"
PIECES = 20  # of a run
SAMPLES = 5  # of a run
RATES = 6  # the first of `Rates`, those that a run has after its start
EVALUATION = 4e-6  # seconds that one takes at least, whatever its size
SHARES = (0.75, 1.29)  # of what is measured with `reference` in what is expected
COLUMNS = (
    "scene", "parameters", "level", "how", "begin", "end", "membrane", "dermal", "cells", "steps",
    "evaluations", "frames", "seconds",
)  # fmt: skip
Row = dict[str, str | float]


def pieces(scene: Scene, times: Iterable[float], folder: Path, how: str) -> Iterator[Row]:
    """Costs of a run between times."""
    with Simulation.begin(scene, folder, replace=True) as simulation:
        simulation.run(until=simulation.time)  # the first frame is not of the run
        steps, evaluations, begin = 0.0, 0.0, simulation.time
        for until in times:
            first = numbers(simulation)
            began = time.thread_time()
            simulation.run(until=until)
            seconds = time.thread_time() - began
            last, motion = numbers(simulation), simulation.motion()
            interval = scene.output.dump_interval
            yield {
                "scene": scene.name, "parameters": scene.parameters,
                "level": scene.numerics.accuracy, "how": how,
                "begin": begin, "end": until, "membrane": first[0], "dermal": first[1],
                "cells": (first[2] + last[2]) / 2, "steps": motion.steps - steps,
                "evaluations": motion.evaluations - evaluations,
                "frames": until // interval - begin // interval if interval else 0,
                "seconds": round(seconds, 4),
            }  # fmt: skip
            steps, evaluations, begin = motion.steps, motion.evaluations, until


def numbers(simulation: Simulation) -> tuple[int, int, int]:
    """Membrane particles, dermal particles and cells."""
    types = simulation.forces().types
    membrane, dermal = ((types == kind).sum() for kind in (Kind.MEMBRANE, Kind.DERMAL))
    return int(membrane), int(dermal), int(is_cell(types).sum())


def runs(names: list[str], levels: list[str], parameters: str | None, keep: Path | None) -> None:
    """Whole runs."""
    for name in names:
        for level in levels:
            scene = chosen(Scene.load(name), level, parameters)
            times = np.linspace(scene.begins, scene.end_time, PIECES + 1)[1:]
            with ExitStack() as stack:
                folder = keep and keep / f"{name}-{level}"
                if folder is None:
                    folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
                store(list(pieces(scene, times, folder, "run")))


def samples(run: Path, levels: list[str], parameters: str | None, length: float) -> None:
    """Short pieces that begin with states of a run."""
    whole = Scene.load(run / "scene.toml")
    interval = whole.output.dump_interval
    for level in levels:
        scene = chosen(whole, level, parameters)
        rows: list[Row] = []
        for n in range(SAMPLES):
            begin = (n + 0.5) / SAMPLES * whole.end_time // interval * interval
            given = {"start.from": str(run), "start.time": begin, "end_time": begin + length}
            with tempfile.TemporaryDirectory() as folder:
                rows += pieces(scene.replace(**given), [begin + length], Path(folder), "sample")
        store(rows)


def chosen(scene: Scene, level: str, parameters: str | None) -> Scene:
    changes = {"numerics.accuracy": level, **({"parameters": parameters} if parameters else {})}
    return scene.replace(**changes)


def store(rows: list[Row]) -> None:
    """Put the pieces of a scene in the place of those that are there."""
    key, others = case(rows[0]), [row for row in stored() if case(row) != case(rows[0])]
    with DATA.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n", extrasaction="ignore")
        writer.writeheader()
        writer.writerows(sorted([*others, *rows], key=case))
    print(*key, f"{sum(float(row['seconds']) for row in rows):.1f} s", flush=True)


def case(row: Row) -> tuple[str | float, ...]:
    return row["scene"], row["parameters"], row["level"]


def stored() -> list[Row]:
    if not DATA.exists():
        return []
    with DATA.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def cases() -> Iterator[tuple[Scene, list[Row], float]]:
    """Scenes at their levels, their pieces, and what the whole run takes by these."""
    for (name, parameters, level), group in groupby(stored(), case):
        rows = list(group)
        scene = chosen(Scene.load(str(name)), str(level), str(parameters))
        measured = sum(float(row["seconds"]) for row in rows)
        length = sum(float(row["end"]) - float(row["begin"]) for row in rows)
        yield scene, rows, measured * (scene.end_time - scene.begins) / length


def fit() -> None:
    """Rates with the least largest error of the levels that take rkl1, in parts of what they take.

    The shares of the others in what is expected stay between `SHARES`.
    """
    names = [field.name for field in fields(Rates)][:RATES]
    nothing = Rates(*(0.0 for _ in fields(Rates)))
    parts, plain = [], []
    for scene, _, measured in cases():
        of_each = [estimate(scene, replace(nothing, **{name: 1.0})) for name in names]
        parts.append([(cost.seconds - cost.start) / measured for cost in of_each])
        plain.append(scene.numerics.accuracy == "reference")
    scale = 1 / np.max(parts, axis=0)
    expected, others = np.array(parts) * scale, np.array(plain)
    error = np.where(others, 0.0, -1.0)[:, None]
    low, high = 1 / max(SHARES), 1 / min(SHARES)
    found = linprog(
        np.eye(RATES + 1)[-1],
        A_ub=np.block([[expected, error], [-expected, error]]),
        b_ub=np.concatenate([np.where(others, high, 1.0), np.where(others, -low, -1.0)]),
        bounds=[(EVALUATION / scale[0], None), *[(0.0, None)] * RATES],
    )
    for name, rate in zip(names, found.x * [*scale, 1.0], strict=False):
        print(f"    {name}: float = {rate:.2e}")


def table() -> None:
    """Seconds of whole runs, those of samples from their mean, and their share of the expected."""
    print(f"| scene | parameters | cells | {' | '.join(LEVELS)} |")
    print("| --- | --- | --- | --- | --- | --- |")
    for (name, parameters), of_scene in groupby(
        cases(), lambda one: (one[0].name, one[0].parameters)
    ):
        told: dict[str, str] = {}
        for scene, rows, measured in of_scene:
            cost = estimate(scene, SHIPPED)
            sampled = "" if rows[0]["how"] == "run" else "about "
            share = measured / (cost.seconds - cost.start)
            told[scene.numerics.accuracy] = f"{sampled}{measured:.3g}, {share:.2f}"
            cells = f"{float(rows[-1]['cells']):.0f}, {cost.cells:.0f}"
        levels = " | ".join(told.get(level, "") for level in LEVELS)
        print(f"| `{name}` | {parameters} | {cells} | {levels} |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="what", required=True)
    whole = commands.add_parser("runs")
    whole.add_argument("scenes", nargs="+")
    whole.add_argument("--keep", type=Path, help="folder for the runs")
    sampled = commands.add_parser("samples")
    sampled.add_argument("run", type=Path)
    sampled.add_argument("--length", type=float, default=1.0, help="time units of each")
    for command in (whole, sampled):
        command.add_argument("--levels", nargs="+", default=["balanced"])
        command.add_argument("--parameters")
    for name in ("fit", "table"):
        commands.add_parser(name)
    options = parser.parse_args()
    if options.what == "runs":
        runs(options.scenes, options.levels, options.parameters, options.keep)
    elif options.what == "samples":
        samples(options.run, options.levels, options.parameters, options.length)
    elif options.what == "fit":
        fit()
    else:
        table()


if __name__ == "__main__":
    main()
