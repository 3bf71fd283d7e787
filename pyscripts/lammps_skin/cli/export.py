"""``skin export``: the trajectory of a run for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.options import beginning
from lammps_skin.cli.output import console
from lammps_skin.errors import SkinError
from lammps_skin.model.scene_keys import near

FORMS = {"vtk": "vtk", "xyz": "skin.xyz", "vmd": "vmd", "dump": "skin.dump"}
"""What can be written, and its file or directory in that of the run."""


def export(
    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="Directory of a scene that was run, or skin.h5.")
    ],
    to: Annotated[
        str,
        typer.Option(
            "--to", metavar="FORM", help=f"{', '.join(FORMS)}: for ParaView, OVITO, VMD, LAMMPS.",
            autocompletion=lambda incomplete: beginning(incomplete, FORMS),
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="OUT",
            help="Instead of the directory RUN/vtk or RUN/vmd, or of RUN/skin.xyz or skin.dump.",
        ),
    ] = None,
) -> None:  # fmt: skip
    """Write the trajectory of a run for ParaView, OVITO, VMD, or as a dump of LAMMPS."""
    from lammps_skin.figures import export as exports

    if to not in FORMS:
        raise SkinError(f"--to {to}: must be one of {', '.join(FORMS)}{near(to, FORMS)}")
    place = output or (run if run.is_dir() else run.parent) / FORMS[to]
    with console.status("exporting"):
        written = getattr(exports, f"export_{to}")(run, place)
    for path in written if isinstance(written, list) else [written]:
        console.print(f"{path}")
