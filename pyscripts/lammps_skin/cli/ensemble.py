"""``skin ensemble``: scenes with many seeds, reduced to tables of observables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lammps_skin.cli.cores import warn_of_crowding
from lammps_skin.cli.options import (
    Accuracy,
    Jobs,
    Parameters,
    Scheduler,
    Settings,
    scene_from,
    scenes_beginning,
)
from lammps_skin.cli.output import console, counted, duration
from lammps_skin.cli.progress import Progress
from lammps_skin.engine.machine import cores
from lammps_skin.errors import SceneError, SkinError
from lammps_skin.model.remarks import remarks
from lammps_skin.study.ranges import seeds_of

if TYPE_CHECKING:
    from lammps_skin.study.ensemble import Member

FAILED = 1
INTERRUPTED = 130


def ensemble(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE...",
            help="Built-in scenes or .toml files.",
            autocompletion=scenes_beginning,
        ),
    ] = None,
    seeds: Annotated[str, typer.Option(metavar="SEEDS", help="Such as 1-8 or 1,3,10-12.")] = "1-8",
    jobs: Jobs = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of the ensemble.")
    ] = Path("ensemble"),
    runs: Annotated[
        list[Path] | None,
        typer.Option("--from", metavar="RUN", help="Directory of a finished run to take in."),
    ] = None,
    scheduler: Scheduler = None,
    keep: Annotated[bool, typer.Option("--keep", help="Keep the run directories.")] = False,
    parameters: Parameters = None,
    accuracy: Accuracy = None,
    settings: Settings = None,
) -> None:
    """Run scenes with many seeds, and store the observables of each run."""
    import numpy as np

    from lammps_skin.analysis.basal_layer import last_remark
    from lammps_skin.analysis.observables import read_table
    from lammps_skin.study import ensemble as ensembles

    if not scenes and not runs:
        raise SceneError("scene: give at least one, or runs to take in with --from")
    described = [scene_from(scene, parameters, settings, accuracy) for scene in scenes or ()]
    for one in described:
        for remark in remarks(one):
            console.print(f"{one.name}: {remark}")
    numbers = seeds_of(seeds)
    members = ensembles.members(described, numbers, output)
    failures: dict[str, str] = {}
    for directory in runs or ():
        try:
            member = ensembles.member_of(directory, output)
            if not member.done:
                member.store(directory)
            members.append(member)
        except SkinError as error:
            failures[str(directory)] = str(error)

    todo = [member for member in members if not member.done]
    console.print(f"{counted(len(members), 'run')}, {len(members) - len(todo)} of them there")
    activity = ensembles.provenance(output, described, numbers)
    try:
        if todo:
            output.mkdir(parents=True, exist_ok=True)
            activity.begin()
            failed = run_members(todo, jobs, keep, scheduler)
            failures |= {member.label: text for member, text in failed.items()}
    except KeyboardInterrupt:
        console.print("interrupted; the same command goes on with what is missing")
        raise typer.Exit(INTERRUPTED) from None
    finally:
        plain = {member.gathered for member in members}
        for path in ensembles.gather(members):
            table = read_table(path)
            runs_of = [table[table["seed"] == seed] for seed in np.unique(table["seed"])]
            why = "" if path in plain else "; the name without the key is that of another table"
            console.print(f"{path}: {counted(len(runs_of), 'seed')}{why}")
            if heaps := [line for run in runs_of if (line := last_remark(run))]:
                console.print(f"{path}: {len(heaps)} of them, the first: {heaps[0]}")
        activity.error = f"{counted(len(failures), 'run')} failed" if failures else ""
        activity.end()
    for label, text in failures.items():
        console.print(f"failed: {label}: {text}")
    if failures:
        raise typer.Exit(FAILED)


def run_members(
    todo: Sequence[Member], jobs: int | None, keep: bool, scheduler: str | None = None
) -> dict[Member, str]:
    """Run with a progress bar, by default as many at a time as cores; what failed, and why."""
    from lammps_skin.study.ensemble import expected_seconds
    from lammps_skin.study.runner import run_all

    together = min(jobs or cores(), len(todo))
    seconds = expected_seconds(todo)
    if scheduler is None:
        warn_of_crowding(together, "run")
        seconds /= min(together, cores())
        where = f"{together} at a time: about {duration(seconds)} on idle cores"
    else:
        where = f"by the workers of {scheduler}: about {duration(seconds)} of one core"
    console.print(f"{len(todo)} to do, {where}")
    reached: dict[Member, float] = {}
    with Progress(sum(member.scene.end_time for member in todo)) as progress:

        def show(member: Member, time: float) -> None:
            reached[member] = time
            ended = sum(time >= member.scene.end_time for member, time in reached.items())
            progress.show(sum(reached.values()), f"{ended} of {counted(len(todo), 'run')}")

        return run_all(todo, together, keep, show, scheduler)
