"""``skin convert``: the trajectory of a run as HDF5."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.output import console, counted
from lammps_skin.run.directory_lock import DirectoryLock
from lammps_skin.trajectory.convert import convert as convert_directory


def convert(
    directory: Annotated[
        Path, typer.Argument(metavar="DIR", help="Directory of a scene that was run.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT", help="File to write instead of DIR/skin.h5."),
    ] = None,
) -> None:
    """Write the trajectory of a run, skin.dump, as an H5MD file that MDAnalysis reads."""
    with DirectoryLock(directory), console.status("converting"):
        path, frames, slots = convert_directory(directory, output)
    console.print(f"{path}: {counted(frames, 'frame')}, {counted(slots, 'particle')} in all")
