"""What `skin check` expects of runs, beside what they cost, and the rates of which it is made.

Seconds are CPU time of the thread that runs LAMMPS, output and checkpoints included, so that they
hardly depend on how busy the machine is. `runs` runs scenes to their end, piece by piece. `samples`
runs short pieces that begin with states of a run that is there: for runs that would take too long.
`fit` makes rates (`lammps_skin.study.rates`) of all pieces; `table` compares what was measured with
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
from dataclasses import fields
from itertools import groupby
from pathlib import Path

import numpy as np
from lammps_skin.arrays import Floats
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.accuracy import LEVELS
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.counts import first_counts
from lammps_skin.study.cost import estimate, work
from lammps_skin.study.growth import growth
from lammps_skin.study.rates import SHIPPED, Rates
from scipy.optimize import nnls

DATA = Path(__file__).resolve().parent.parent / "docs" / "data" / "run-costs.csv"
PIECES = 20  # of a run
SAMPLES = 5  # of a run
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


def works() -> list[tuple[Row, Floats]]:
    """Pieces, and what is done in each, in the order of the rates, by `study.cost`."""
    found = []
    for (name, parameters, level), group in groupby(stored(), case):
        scene = chosen(Scene.load(str(name)), str(level), str(parameters))
        times = np.linspace(scene.begins, scene.end_time, 201)
        first = first_counts(scene)
        grown = growth(scene, {kind.label: n for kind, n in first.items() if is_cell(kind)}, times)
        for row in group:
            begin, end, cells, evaluations, frames = (
                float(row[name]) for name in ("begin", "end", "cells", "evaluations", "frames")
            )
            divisions = np.interp([(begin + end) / 2], times, grown.divisions)
            particles = float(row["membrane"]), float(row["dermal"])
            done = work(scene, *particles, np.array([cells]), divisions)[0]
            done[:4] *= evaluations / done[0]
            done[4] *= end - begin
            done[5] = frames
            found.append((row, done))
    return found


def fit() -> None:
    """Rates by which all pieces take the time that was measured, but for relative errors."""
    found = works()
    seconds = np.array([float(row["seconds"]) for row, _ in found])
    done = np.array([one for _, one in found])
    rates, _ = nnls(done / seconds[:, None], np.ones(len(seconds)))
    for field, rate in zip(fields(Rates), rates, strict=False):
        print(f"    {field.name}: float = {rate:.2e}")


def table() -> None:
    """Seconds of whole runs, those of samples from their mean, and their share of the expected."""
    print(f"| scene | parameters | cells | {' | '.join(LEVELS)} |")
    print("| --- | --- | --- | --- | --- | --- |")
    for (name, parameters), of_scene in groupby(stored(), lambda row: case(row)[:2]):
        told: dict[str, str] = {}
        for level, group in groupby(of_scene, lambda row: str(row["level"])):
            rows = list(group)
            scene = chosen(Scene.load(str(name)), level, str(parameters))
            cost = estimate(scene, SHIPPED)
            measured = sum(float(row["seconds"]) for row in rows)
            length = sum(float(row["end"]) - float(row["begin"]) for row in rows)
            measured *= (scene.end_time - scene.begins) / length
            sampled = "" if rows[0]["how"] == "run" else "about "
            told[level] = f"{sampled}{measured:.3g}, {measured / (cost.seconds - cost.start):.2f}"
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
