"""``skin compare``: runs, ensembles and points of studies side by side."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lammps_skin.cli.output import console, print_table
from lammps_skin.errors import SkinError

if TYPE_CHECKING:
    from lammps_skin.study.compare.report import Report

ACROSS = 3  # panels of a figure side by side
CONDITION = "condition"  # against which means are drawn: one below the other


def compare(
    sources: Annotated[
        list[str],
        typer.Argument(
            metavar="[NAME=]PATH...",
            help="Run directories, folders of ensembles, tables; the first is what others are "
            "compared with.",
        ),
    ],
    columns: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,...",
            help="Columns of the table of observables, differences of two, such as "
            "stem_on_tips-stem_tips_expected, or 'coverage>0.9': when it comes to this level "
            "[default: about 20].",
        ),
    ] = None,
    windows: Annotated[
        str | None,
        typer.Option(
            metavar="A-B,...",
            help="Times to average over [default: those of the study, or two of the run].",
        ),
    ] = None,
    output: Annotated[
        list[Path] | None,
        typer.Option(
            "-o", "--output", metavar="FILE",
            help="Also write the table, as .md, .csv or .json; may be repeated.",
        ),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw the columns over time: .pdf, .svg, .png."),
    ] = None,
    against: Annotated[
        str | None,
        typer.Option(
            metavar="KEY",
            help="Draw their means against a key of the scenes, or against condition, instead.",
        ),
    ] = None,
) -> None:  # fmt: skip
    """Show runs, ensembles or points of studies side by side, with tests between them."""
    from lammps_skin.figures.snapshot import check_output
    from lammps_skin.study.claims.report import check_names
    from lammps_skin.study.compare.comparison import usual_columns
    from lammps_skin.study.compare.conditions import read, windows_of_all
    from lammps_skin.study.compare.report import FORMATS, Report, table, write

    check_names(output or [], FORMATS)
    if against is not None and plot is None:
        raise SkinError(f"--against {against}: says what to draw; give --plot FILE, too")
    if plot is not None:
        check_output(plot)
    with console.status("reading"):
        found = read(sources)
    of_a_key = against is not None and against != CONDITION
    places = {one.name: one.value_of(str(against)) for one in found} if of_a_key else {}
    names = usual_columns(found) if columns is None else columns.split(",")
    for one in found:
        one.check(names)
    report = Report.of(found, names, windows_of_all(found, windows))
    for line in report.settings:
        console.print(line)
    print_table(*table(report.rows), whole=range(9))
    console.print()
    for line in report.remarks:
        console.print(line)
    for path in output or ():
        write(report, path)
        console.print(str(path))
    if plot is not None:
        _draw(report, plot, against, places)


def _draw(report: Report, path: Path, against: str | None, places: dict[str, float]) -> None:
    from lammps_skin.analysis.observables import REACHES
    from lammps_skin.figures.comparison import draw_against, draw_conditions
    from lammps_skin.figures.snapshot import save
    from lammps_skin.figures.time_courses import draw_courses

    columns = list(dict.fromkeys(row.column for row in report.rows))
    across = min(ACROSS, len(columns))
    if against == CONDITION:
        figure = draw_conditions(report.rows, across)
    elif against is not None:
        figure = draw_against(report.rows, against, places, across)
    else:
        courses = {one.name: one.table for one in report.conditions}
        names = list(dict.fromkeys(column.partition(REACHES)[0] for column in columns))
        figure = draw_courses(courses, names, min(across, len(names)))
    console.print(str(save(figure, path)))
