"""``skin export``: the trajectory of a run for ParaView, or as a dump of LAMMPS."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.output import console


class Form(StrEnum):
    """What can be written."""

    VTK = "vtk"
    DUMP = "dump"


def export(
    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="Directory of a scene that was run, or skin.h5.")
    ],
    to: Annotated[Form, typer.Option("--to", help="ParaView's files, or a dump of LAMMPS.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="OUT", help="Instead of the directory RUN/vtk, RUN/skin.dump."
        ),
    ] = None,
) -> None:
    """Write the trajectory of a run for ParaView (--to vtk) or OVITO and LAMMPS (--to dump)."""
    from lammps_skin.figures.export import export_dump, export_vtk

    directory = run if run.is_dir() else run.parent
    with console.status("exporting"):
        if to == Form.VTK:
            written = export_vtk(run, output or directory / "vtk")
        else:
            written = [export_dump(run, output or directory / "skin.dump")]
    for path in written:
        console.print(f"{path}")
