"""``skin figure``: the figures of the paper, from runs that are there or that it starts."""

from __future__ import annotations

import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lammps_skin.cli.ensemble import run_members
from lammps_skin.cli.options import Accuracy, Jobs, Parameters, Settings, scene_from
from lammps_skin.cli.output import console, counted, duration, print_table
from lammps_skin.cli.snapshot import Print
from lammps_skin.engine.machine import cores
from lammps_skin.errors import FigureError
from lammps_skin.study.ranges import seeds_of

if TYPE_CHECKING:
    from lammps_skin.figures.paper import Request


def figure(
    number: Annotated[
        int | None, typer.Argument(metavar="N", help="Number; the figures are listed without it.")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Scenes of a quarter of the paper's size.")
    ] = False,
    data: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder of an ensemble, for tables and runs.")
    ] = Path("ensemble"),
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder for the figure.")
    ] = Path("figures"),
    seeds: Annotated[
        str | None,
        typer.Option(metavar="SEEDS", help="Such as 1-8; those of the tables if not given."),
    ] = None,
    jobs: Jobs = None,
    for_print: Print = False,
    yes: Annotated[bool, typer.Option("--yes", help="Start missing runs without asking.")] = False,
    parameters: Parameters = None,
    accuracy: Accuracy = None,
    settings: Settings = None,
) -> None:
    """Draw a figure of the paper; what has not been run is run after a question."""
    from lammps_skin.figures import paper  # MDAnalysis takes a second to import
    from lammps_skin.figures.snapshot import check_output, save
    from lammps_skin.style import printed

    wanted = None if seeds is None else seeds_of(seeds)
    size = "quarter" if quick else "paper"

    def request(number: int) -> Request:
        scenes = {
            name: scene_from(f"{size}-{name}", parameters, settings, accuracy)
            for name in paper.figure_of(number).scenes
        }
        return paper.Request(number, scenes, wanted, data)

    if number is None:
        _list([request(number) for number in paper.FIGURES])
        return
    asked = request(number)
    suffix = "pdf" if for_print else "png"
    path = output / f"figure-{number}{'-quick' if quick else ''}.{suffix}"
    check_output(path)
    if asked.missing:
        _run(asked, jobs, yes)
    with printed() if for_print else nullcontext():
        written = save(asked.draw(), path)
    console.print(f"{written}: {asked.figure.title}")


def _list(requests: list[Request]) -> None:
    from lammps_skin.study.ensemble import expected_seconds

    rows = []
    for request in requests:
        missing = request.missing
        rows.append((
            str(request.number), request.figure.title, ", ".join(request.scenes),
            counted(len(missing), "run") if missing else "nothing",
            duration(expected_seconds(missing)) if missing else "",
        ))  # fmt: skip
    print_table(["", "figure", "scenes", "to be run", "expected"], rows, whole=[0, 3, 4], fold=True)


def _run(request: Request, jobs: int | None, yes: bool) -> None:
    """Say what is missing and what it costs, ask, run."""
    from lammps_skin.study.ensemble import expected_seconds

    missing = request.missing
    seconds = expected_seconds(missing) / min(jobs or cores(), len(missing))
    names = ", ".join(dict.fromkeys(member.scene.name for member in missing))
    runs = counted(len(missing), "run")
    need = f"figure {request.number} needs {runs} of {names}, {duration(seconds)}"
    if not yes:
        if not sys.stdin.isatty():
            raise FigureError(f"{need}; --yes starts them")
        if not typer.confirm(f"{need}. Start them?"):
            raise FigureError(f"{need}; none was started")
    failed = run_members(missing, jobs, request.figure.of == "run")
    for member, text in failed.items():
        raise FigureError(f"figure {request.number}: {member.label}: {text}")
