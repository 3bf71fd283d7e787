"""``skin movie``: a run as a movie."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.output import console
from lammps_skin.cli.progress import Progress
from lammps_skin.cli.snapshot import (
    Azimuth,
    ColourBy,
    Dpi,
    Elevation,
    Run,
    ScaleBar,
    Shift,
    Show,
    Size,
    View,
    Y,
    Zoom,
    look_of,
    words_of,
)


def movie(
    run: Run,
    view: View = "3d",
    show: Show = None,
    y: Y = None,
    azimuth: Azimuth = -62.0,
    elevation: Elevation = None,
    zoom: Zoom = 1.0,
    size: Size = 750,
    dpi: Dpi = 100,
    shift: Shift = "0,0",
    colour_by: ColourBy = "kind",
    scale_bar: ScaleBar = False,
    rate: Annotated[float, typer.Option("--fps", help="Pictures per second.")] = 12.0,
    every: Annotated[int, typer.Option(help="Show each of so many frames.")] = 1,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE",
            help="An .mp4, .webp or .gif [default: movie-VIEW.webp in the run's directory]",
        ),
    ] = None,
) -> None:  # fmt: skip
    """Write a movie of a run: the snapshot of every frame, from one camera."""
    from lammps_skin.figures.movie import movie as write  # MDAnalysis takes a second to import
    from lammps_skin.trajectory.frames import open_frames

    look = look_of(azimuth, elevation, zoom, size, dpi, shift, colour_by, scale_bar)
    folder = run if run.is_dir() else run.parent
    path = output or folder / f"movie-{view}.webp"
    count = -(-len(open_frames(run)) // max(every, 1))
    with Progress(count) as progress:
        written = write(
            run, path, view, words_of(show), y, look, rate, every,
            lambda done, time: progress.show(done, f"t = {time:g}"),
        )  # fmt: skip
    console.print(f"{written}: {count} pictures, {count / rate:.3g} s")
