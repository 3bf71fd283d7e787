"""``skin report``: a run, several side by side, or a study, as one page for a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.output import console
from lammps_skin.errors import SkinError


def report(
    runs: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN...", help="Run directories, or trajectories; or the folder or the file "
            "of a study.",
        ),
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="The page.")
    ] = Path("report.html"),
    frames: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Most frames to draw [default: as many as keep the page small]."
        ),
    ] = None,
    dermis: Annotated[
        bool, typer.Option("--dermis", help="Draw the particles of the dermis, too.")
    ] = False,
) -> None:  # fmt: skip
    """Write a page that shows a run, several side by side, or a study, in any browser."""
    from lammps_skin.report import page  # MDAnalysis takes a second to import
    from lammps_skin.report.study import is_study

    studies = [path for path in runs if path.suffix == ".toml" or is_study(path)]
    if studies and len(runs) > 1:
        raise SkinError(f"{studies[0]}: is a study, which has a page of its own")
    with console.status("reading"):
        if studies:
            written = page.report_study(_folder_of(runs[0]), output, frames, dermis)
        else:
            written = page.report(runs, output, frames, dermis)
    console.print(f"{written}: {written.stat().st_size / 1e6:.1f} MB, opens in any browser")


def _folder_of(study: Path) -> Path:
    """The folder of a study; of a file the one in which it runs, its tables up to date."""
    if study.is_dir():
        return study
    from lammps_skin.cli.study import opened
    from lammps_skin.study.studies.tables import write_tables

    asked = opened(study, None)
    if asked.folder.is_dir():
        write_tables(asked)
    return asked.folder
