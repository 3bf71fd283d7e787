"""``skin report``: a run, or several side by side, as one page for a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.output import console


def report(
    runs: Annotated[
        list[Path], typer.Argument(metavar="RUN...", help="Run directories, or trajectories.")
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
) -> None:
    """Write a page that shows a run, or several side by side, in any browser."""
    from lammps_skin.report.page import report as write  # MDAnalysis takes a second to import

    with console.status("reading"):
        path = write(runs, output, frames, dermis)
    console.print(f"{path}: {path.stat().st_size / 1e6:.1f} MB, opens in any browser")
