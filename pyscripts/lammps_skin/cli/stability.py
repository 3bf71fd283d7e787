"""``skin stability``: the longest stable timesteps of a scene."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lammps_skin.cli.cores import warn_of_crowding
from lammps_skin.cli.ensemble import INTERRUPTED
from lammps_skin.cli.options import (
    Accuracy,
    Jobs,
    Parameters,
    Seed,
    Settings,
    Source,
    scene_from,
)
from lammps_skin.cli.output import console, counted, print_table
from lammps_skin.cli.progress import Progress
from lammps_skin.engine.machine import cores
from lammps_skin.errors import SceneError, SimulationError
from lammps_skin.model.scene_keys import near

if TYPE_CHECKING:
    from lammps_skin.study.stability.methods import Method
    from lammps_skin.study.stability.report import Row
    from lammps_skin.study.stability.trials import Limits, Point, Trials

LIMIT = 100.0  # of stiffness, where the scene has none


def stability(
    source: Source,
    start: Annotated[
        Path | None,
        typer.Option("--from", metavar="RUN", help="Run directory or restart file to begin from."),
    ] = None,
    vary: Annotated[
        str,
        typer.Option(
            metavar="NAMES",
            help="Of stiffness, stretch, bending, adhesion, spring, division, crowding.",
        ),
    ] = "stretch,bending,adhesion,spring,division,crowding",
    factors: Annotated[str, typer.Option(metavar="NUMBERS", help="By which it is scaled.")] = (
        "0.1,1,10"
    ),
    only: Annotated[
        str | None,
        typer.Option("--methods", metavar="NAMES", help="Such as euler,rkl1-limit; all of them."),
    ] = None,
    interval: Annotated[float, typer.Option(help="Length in time units of a run.")] = 4.0,
    stages: Annotated[
        int, typer.Option(min=3, max=99, help="Force evaluations in a step of rkl1 and rkl2.")
    ] = 7,
    tolerance: Annotated[
        float, typer.Option(help="Relative, of a timestep; at least 0.001.")
    ] = 0.05,
    jobs: Jobs = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder for tables and plot.")
    ] = Path("stability"),
    parameters: Parameters = None,
    accuracy: Accuracy = None,
    seed: Seed = None,
    settings: Settings = None,
) -> None:
    """Map the longest stable timesteps, by bisection, beside estimates."""
    from lammps_skin.study.stability.methods import SCALED, methods
    from lammps_skin.study.stability.trials import points as points_of

    for name, value, least, most in (
        ("interval", interval, 0.0, 1000.0), ("tolerance", tolerance, 0.0009, 1.0),
    ):  # fmt: skip
        if not least < value <= most:
            raise SceneError(f"--{name} {value:g}: must be above {least:g} and at most {most:g}")
    scene = scene_from(source, parameters, settings, accuracy, seed)
    limit = scene.numerics.stiffness_limit or LIMIT
    found = methods(stages, limit)
    chosen = _chosen("--methods", only, [method.name for method in found])
    names = _chosen("--vary", vary, list(SCALED))
    points, left_out = points_of(
        scene, start, names, _factors(factors), output / "measured", interval, limit
    )
    for reason in left_out:
        console.print(f"left out: {reason}")
    if not points:
        raise SceneError(f"--vary {vary}: nothing of it can be varied in this scene")
    try:
        rows = _measure(points, [m for m in found if m.name in chosen], tolerance, jobs)
    except KeyboardInterrupt:
        console.print("interrupted; the same command goes on with what is missing")
        raise typer.Exit(INTERRUPTED) from None
    _show(rows, scene.name, start, interval, output)


def _chosen(option: str, text: str | None, allowed: list[str]) -> list[str]:
    """Names of a list, all of them without one."""
    names = allowed if text is None else [name.strip() for name in text.split(",")]
    for name in names:
        if name not in allowed:
            raise SceneError(
                f"{option} {text}: {name!r} must be one of {', '.join(allowed)}"
                f"{near(name, allowed)}"
            )
    return names


def _factors(text: str) -> list[float]:
    try:
        numbers = sorted({float(part) for part in text.split(",")})
    except ValueError:
        numbers = []
    if not numbers or not 0 < numbers[0] <= numbers[-1] <= 1e6:
        raise SceneError(
            f"--factors {text}: must be numbers above 0 and up to 1e6, such as 0.1,1,10"
        )
    return numbers


def _measure(
    trials: dict[Point, Trials], found: list[Method], tolerance: float, jobs: int | None
) -> list[Row]:
    """All limits; those that are missing are found on workers, a point at a time on each."""
    from lammps_skin.study.runner import run_all
    from lammps_skin.study.stability.report import row
    from lammps_skin.study.stability.trials import Limits

    todo: dict[str, Limits] = {}  # by what they depend on: points may be the same
    for point, one in trials.items():
        if not one.done(found, tolerance):
            todo.setdefault(one.key, Limits(point, one, tuple(found), tolerance))
    together = min(jobs or cores(), len(todo))
    warn_of_crowding(together, "run")
    total = sum(job.length for job in todo.values())
    reached: dict[Limits, float] = {}
    with Progress(total) as progress:

        def show(job: Limits, done: float) -> None:
            reached[job] = done
            limits = counted(round(total), "limit")
            progress.show(sum(reached.values()), f"{sum(reached.values()):g} of {limits}")

        failures = run_all(list(todo.values()), together, progress=show)
    rows = []
    for point, one in trials.items():
        for method in found:
            if not one.done([method], tolerance):
                console.print(f"left out: {point}: {failures[todo[one.key]]}")
                break
            limit = one.limit(method, tolerance)
            rows.append(row(*point, method, limit, one.eigenvalues(method.stiffness_limit)))
    if not rows:
        raise SimulationError("nothing could be measured")
    return rows


def _show(rows: list[Row], name: str, start: Path | None, interval: float, output: Path) -> None:
    """Print the table, write it and the plot."""
    from lammps_skin.figures.snapshot import save
    from lammps_skin.study.stability.plot import draw
    from lammps_skin.study.stability.report import rows_table, write

    whence = "its start" if start is None else str(start)
    note = f"Runs of {interval:g} time units from {whence}; no step is divided."
    print_table(*rows_table(rows))
    for path in write(rows, name, [note], output):
        console.print(str(path))
    console.print(str(save(draw(rows, name), output / f"{name}.png")))
