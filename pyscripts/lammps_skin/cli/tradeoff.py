"""``skin tradeoff``: what choices of numerics cost and what they change."""

from __future__ import annotations

from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from lammps_skin.cli.ensemble import FAILED, INTERRUPTED, run_members
from lammps_skin.cli.options import (
    Jobs,
    Parameters,
    Seed,
    Settings,
    Source,
    changes_from,
    scene_from,
)
from lammps_skin.cli.output import console, counted, print_table
from lammps_skin.cli.progress import Progress
from lammps_skin.engine.machine import cores
from lammps_skin.errors import SceneError, SimulationError
from lammps_skin.model.stiffness import evaluations
from lammps_skin.study.ranges import Window, seeds_of, windows_of
from lammps_skin.study.tradeoff.grid import Grid, Variant, variants

if TYPE_CHECKING:
    from lammps_skin.study.ensemble import Member
    from lammps_skin.study.tradeoff.bias import Bias
    from lammps_skin.study.tradeoff.measure import Measurements
    from lammps_skin.study.tradeoff.report import Report


def tradeoff(
    source: Source,
    grid: Annotated[
        Grid, typer.Option("--grid", help="The levels of accuracy alone, or variations too.")
    ] = "full",
    more: Annotated[
        list[str] | None,
        typer.Option(
            "--variant", metavar="NAME:KEY=VALUE,...", help="Another choice of keys of numerics."
        ),
    ] = None,
    start: Annotated[
        Path | None,
        typer.Option("--from", metavar="RUN", help="Run directory or restart file to begin from."),
    ] = None,
    interval: Annotated[
        float, typer.Option(help="Length in time units of the runs that are compared.")
    ] = 2.0,
    quick: Annotated[bool, typer.Option("--quick", help="No ensembles.")] = False,
    seeds: Annotated[str, typer.Option(metavar="SEEDS", help="Such as 1-8 or 1,3,10-12.")] = "1-8",
    jobs: Jobs = None,
    everything: Annotated[
        bool, typer.Option("--all", help="Ensembles also of the variations of the grid.")
    ] = False,
    present: Annotated[
        bool, typer.Option("--present", help="Ensembles from tables that are there alone.")
    ] = False,
    windows: Annotated[
        str | None,
        typer.Option(metavar="TIMES", help="Of ensembles, such as 300-600,800-1000."),
    ] = None,
    data: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder of an ensemble, for its tables.")
    ] = Path("ensemble"),
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder for tables and plot.")
    ] = Path("tradeoff"),
    parameters: Parameters = None,
    seed: Seed = None,
    settings: Settings = None,
) -> None:
    """Compare choices of numerics: error against time."""
    from lammps_skin.study.tradeoff import bias, measure  # MDAnalysis takes a second to import

    if not 0 < interval <= 1000:
        raise SceneError(f"--interval {interval:g}: must be above 0 and at most 1000")
    scene = scene_from(source, parameters, settings, seed=seed)
    wanted = [variant_from(text) for text in more or ()]
    found, left_out = variants(scene, interval, grid, wanted)
    for reason in left_out:
        console.print(f"left out: {reason}")
    numbers = seeds_of(seeds)
    times = windows_of(windows, scene.end_time)
    if not quick:
        bias.check_ensemble(found[0], numbers)
    measurements = measure.Measurements(scene, output / "measured", start, interval)
    failures: dict[Member, str] = {}
    try:
        _measure(measurements, found, jobs)
        if not (quick or present):
            members = [
                member
                for one in found if everything or one.chosen
                for member in (bias.member(one, seed, data) for seed in numbers)
                if not member.done
            ]  # fmt: skip
            failures = run_members(members, jobs, False) if members else {}
    except KeyboardInterrupt:
        console.print("interrupted; the same command goes on with what is missing")
        raise typer.Exit(INTERRUPTED) from None

    biases = {} if quick else _biases(found, numbers, data, times)
    report = _report(measurements, found, start, biases)
    _show(report, output, scene.name)
    for member, text in failures.items():
        console.print(f"failed: {member.label}: {text}")
    if failures:
        raise typer.Exit(FAILED)


def variant_from(text: str) -> tuple[str, dict[str, Any]]:
    """Name and keys of numerics of NAME:KEY=VALUE,KEY=VALUE."""
    name, colon, keys = text.partition(":")
    if not colon:
        raise SceneError(
            f"--variant {text}: must be NAME:KEY=VALUE,..., such as slow:timestep=0.002"
        )
    pairs = [pair.strip().removeprefix("numerics.") for pair in keys.split(",")]
    try:
        return name.strip(), changes_from(None, pairs)
    except SceneError:
        raise SceneError(
            f"--variant {text}: {keys!r} must be KEY=VALUE,..., such as timestep=0.002"
        ) from None


def _measure(measurements: Measurements, found: list[Variant], jobs: int | None) -> None:
    """Trajectories and timings that are missing, with a progress bar in force evaluations."""
    from lammps_skin.study.runner import run_all
    from lammps_skin.study.tradeoff.measure import ROUNDS, Trajectory

    trajectories = [
        Trajectory(one, measurements)
        for one in (measurements.finest(), *found)
        if not measurements.end_state_path(one).exists()
    ]
    groups = measurements.timing_groups(found)
    todo = counted(len(trajectories), "run"), counted(len(groups), "round")
    console.print(f"{todo[0]} and {todo[1]} of timing to do")
    if not trajectories and not groups:
        return

    def work(one: Variant) -> float:
        return measurements.interval * evaluations(one.scene) / one.scene.numerics.timestep

    parts = {job.label: work(job.one) for job in trajectories}
    total = sum(parts.values()) + ROUNDS * sum(map(work, chain(*groups)))
    reached: dict[str, float] = {}
    with Progress(total) as progress:

        def advance(job: Trajectory, time: float) -> None:
            reached[job.label] = parts[job.label] * time / job.length
            progress.show(sum(reached.values()), job.label)

        def turn(one: Variant) -> None:
            name = f"time of {one.name}"
            reached[name] = reached.get(name, 0.0) + work(one)
            progress.show(sum(reached.values()), name)

        failures = run_all(trajectories, jobs or cores(), progress=advance)
        if failures:
            job, text = next(iter(failures.items()))
            raise SimulationError(f"{job.label}: {text}")
        for group in groups:  # in this process, while no other run disturbs them
            measurements.time_group(group, turn)


def _biases(
    found: list[Variant], seeds: list[int], data: Path, windows: list[Window]
) -> dict[str, list[Bias]]:
    """Of all variants, the reference apart, that share seeds with it."""
    from lammps_skin.study.tradeoff.bias import biases, tables

    reference, *others = found
    theirs = tables(reference, seeds, data)
    ours = {one.name: tables(one, seeds, data) for one in others}
    return {
        name: biases(of_seeds, theirs, windows)
        for name, of_seeds in ours.items() if of_seeds.keys() & theirs.keys()
    }  # fmt: skip


def _report(
    measurements: Measurements,
    found: list[Variant],
    start: Path | None,
    biases: dict[str, list[Bias]],
) -> Report:
    """All that has been measured."""
    from lammps_skin.study.tradeoff.errors import distance, orders
    from lammps_skin.study.tradeoff.report import Report, row

    truth = measurements.end_state(measurements.finest())
    if truth.problem:
        raise SceneError(f"the finest run, with which all are compared: {truth.problem}")
    reached = {one.name: measurements.end_state(one) for one in found}
    sides = measurements.scene.box_sides
    distances = {name: distance(run, truth, sides) for name, run in reached.items()}
    rows = [
        row(
            one, measurements.interval, reached[one.name], measurements.timing(one),
            distances[one.name], biases.get(one.name, []),
        )
        for one in found
    ]  # fmt: skip
    whence = "its start" if start is None else str(start)
    timestep = measurements.finest().scene.numerics.timestep
    notes = [
        f"Runs of {measurements.interval:g} time units from {whence}. rms, median, largest: "
        "distances of particles, without births and removals, from forward Euler with a timestep "
        f"of {timestep:g}. CPU: over the reference, by turns in one process, with births and "
        "removals."
    ]
    return Report(measurements.scene.name, notes, rows, orders(found, distances), biases)


def _show(report: Report, output: Path, name: str) -> None:
    """Print the tables, write them and the plot."""
    from lammps_skin.figures.snapshot import save
    from lammps_skin.study.tradeoff.plot import draw
    from lammps_skin.study.tradeoff.report import bias_table, orders_table, rows_table

    print_table(*rows_table(report.rows))
    if report.orders:
        print_table(*orders_table(report.orders))
    for variant, found in report.biases.items():
        console.print(f"{variant}:")
        print_table(*bias_table(found))
    for row in report.rows:
        if row.problem:
            console.print(f"{row.variant}: {row.problem}")
    for path in report.write(output, name):
        console.print(str(path))
    console.print(str(save(draw(report), output / f"{name}.png")))
