"""The command ``skin``: each subcommand parses, calls the package and prints."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from io import TextIOWrapper
from typing import Annotated

import typer
from typer.exceptions import TyperException

from lammps_skin.cli.build import build
from lammps_skin.cli.check import check
from lammps_skin.cli.convert import convert
from lammps_skin.cli.ensemble import ensemble
from lammps_skin.cli.evaluate import evaluate
from lammps_skin.cli.export import export
from lammps_skin.cli.figure import figure
from lammps_skin.cli.run import run
from lammps_skin.cli.scenes import scenes
from lammps_skin.cli.snapshot import snapshot
from lammps_skin.cli.stability import stability
from lammps_skin.cli.stats import stats
from lammps_skin.cli.tradeoff import tradeoff
from lammps_skin.engine.ranks import check_alone, place_in_world
from lammps_skin.errors import SkinError, one_line

app = typer.Typer(
    help="Epidermal stem cells on a deformable basement membrane and dermis, on LAMMPS.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
for command in (
    scenes, check, build, run, convert, export, evaluate, stats, ensemble, snapshot, figure,
    tradeoff, stability,
):  # fmt: skip
    app.command()(command)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"lammps-skin {version('lammps-skin')}, LAMMPS {version('lammps')}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def help_alone(
    context: typer.Context,
    _: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Show versions."),
    ] = False,
) -> None:
    """Epidermal stem cells on a deformable basement membrane and dermis, on LAMMPS."""
    if context.invoked_subcommand is None:
        print(context.get_help())


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point: what the user can mend ends as one line on stderr, with exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # what the terminal has no letters for is no error
            stream.reconfigure(errors="backslashreplace")
    os.environ["MPLBACKEND"] = "agg"  # a notebook names one that is not installed here
    rank, _ = place_in_world()
    if rank:
        sys.exit(2)  # the first one tells why
    try:
        check_alone()
        code = app(arguments, standalone_mode=False, prog_name="skin")
    except (SkinError, TyperException) as error:
        text = error.format_message() if isinstance(error, TyperException) else str(error)
        print(f"error: {one_line(text)}", file=sys.stderr)
        code = 2
    except OSError as error:
        place = "" if error.filename is None else f"{error.filename}: "
        print(f"error: {one_line(f'{place}{error.strerror or error}')}", file=sys.stderr)
        code = 2
    sys.exit(code or 0)
