"""``skin snapshot``: pictures of a run at a time."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.output import console


def snapshot(
    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="Directory of a run, its skin.h5 or skin.dump.")
    ],
    time: Annotated[
        float | None, typer.Option("--time", help="Of the frame [default: the last].")
    ] = None,
    view: Annotated[str, typer.Option(help="3d, below, height, section or all.")] = "3d",
    show: Annotated[
        str | None,
        typer.Option(help="Kinds of cells to draw, such as stem,ta,nd [default: all]."),
    ] = None,
    y: Annotated[
        float | None,
        typer.Option("--y", help="Of the section [default: through the highest stem cell]."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="[default: in the run's directory]"),
    ] = None,
) -> None:
    """Draw a run at a time: in three dimensions, as a map of heights, as a vertical section."""
    from lammps_skin.figures import snapshot as pictures  # MDAnalysis takes a second to import
    from lammps_skin.figures.moments import read_moments

    shown = None if time is None else read_moments(run, [time])[0].time
    at = "last" if shown is None else f"t{shown:g}"
    folder = run if run.is_dir() else run.parent
    path = output or folder / f"snapshot-{view}-{at}.png"
    words = show and [word.strip().lower() for word in show.split(",") if word.strip()]
    nearest = "" if shown == time else f": the frame at t = {shown:g}"
    console.print(f"{pictures.snapshot(run, shown, path, view, words, y)}{nearest}")
