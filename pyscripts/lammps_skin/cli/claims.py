"""``skin claims``: what ensembles say of the paper's claims."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.output import console, print_table


def claims(
    folders: Annotated[
        list[Path],
        typer.Argument(
            metavar="FOLDER...",
            help="Folder of an ensemble, with its tables; several are compared as readings.",
        ),
    ],
    output: Annotated[
        list[Path] | None,
        typer.Option(
            "-o", "--output", metavar="FILE",
            help="Also write what was found, as .md, .csv or .json; of several folders as .md, or "
            "their figure as .png; may be repeated.",
        ),
    ] = None,
) -> None:  # fmt: skip
    """Test the paper's claims on tables of ensembles."""
    if len(folders) > 1:
        _compare(folders, output or [])
    else:
        _judge(folders[0], output or [])


def _judge(folder: Path, output: list[Path]) -> None:
    from lammps_skin.study.claims.report import check_names, reports, verdicts_table, write

    check_names(output)
    found = reports(folder)
    for report in found:
        console.print(f"{report.title}:")
        for remark in report.remarks:
            console.print(f"  {remark}")
        heads, rows = verdicts_table(report)
        print_table(heads[:4], [row[:4] for row in rows], fold=True, whole=[0])
        console.print()
    for path in output:
        write(found, folder, path)
        console.print(str(path))


def _compare(folders: list[Path], output: list[Path]) -> None:
    from lammps_skin.figures.snapshot import save
    from lammps_skin.study.claims import readings_page, readings_plot
    from lammps_skin.study.claims.readings import named, read, stiffness_series
    from lammps_skin.study.claims.report import check_names, write_text

    check_names(output, (".md", ".png"))
    found = read(folders)
    print_table(*readings_page.rule_table(named(found)))
    console.print()
    console.print(readings_page.outcome(named(found)))
    for path in output:
        if path.suffix == ".png":
            save(readings_plot.draw(stiffness_series(found)), path)
        else:
            write_text(path, readings_page.markdown(found))
        console.print(str(path))
