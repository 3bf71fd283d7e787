"""``skin export``: the trajectory of a run for other programs."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.output import console


class Form(StrEnum):
    """What can be written."""

    VTK = "vtk"
    XYZ = "xyz"
    VMD = "vmd"
    DUMP = "dump"


def export(
    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="Directory of a scene that was run, or skin.h5.")
    ],
    to: Annotated[Form, typer.Option("--to", help="For ParaView, OVITO, VMD, LAMMPS.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT",
            help="Instead of the directory RUN/vtk or RUN/vmd, or of RUN/skin.xyz or skin.dump.",
        ),
    ] = None,
) -> None:
    """Write the trajectory of a run for ParaView, OVITO, VMD, or as a dump of LAMMPS."""
    from lammps_skin.figures.export import export_dump, export_vmd, export_vtk, export_xyz

    directory = run if run.is_dir() else run.parent
    with console.status("exporting"):
        if to == Form.VTK:
            written = export_vtk(run, output or directory / "vtk")
        elif to == Form.VMD:
            written = export_vmd(run, output or directory / "vmd")
        elif to == Form.XYZ:
            written = [export_xyz(run, output or directory / "skin.xyz")]
        else:
            written = [export_dump(run, output or directory / "skin.dump")]
    for path in written:
        console.print(f"{path}")
