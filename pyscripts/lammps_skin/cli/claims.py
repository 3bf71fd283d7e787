"""``skin claims``: what ensembles say of the paper's claims."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.output import console, print_table


def claims(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Folder of an ensemble, with its tables.")
    ],
    output: Annotated[
        list[Path] | None,
        typer.Option(
            "-o", "--output", metavar="FILE",
            help="Also write what was found, as .md, .csv or .json; may be repeated.",
        ),
    ] = None,
) -> None:  # fmt: skip
    """Test the paper's claims on the tables of an ensemble."""
    from lammps_skin.study.claims.report import check_names, reports, verdicts_table, write

    check_names(output or ())
    found = reports(folder)
    for report in found:
        console.print(f"{report.title}:")
        for remark in report.remarks:
            console.print(f"  {remark}")
        heads, rows = verdicts_table(report)
        print_table(heads[:4], [row[:4] for row in rows], fold=True, whole=[0])
        console.print()
    for path in output or ():
        write(found, folder, path)
        console.print(str(path))
