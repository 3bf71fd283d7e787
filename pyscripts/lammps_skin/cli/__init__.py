"""The command ``skin``: each subcommand parses, calls the package and prints."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib import import_module
from io import TextIOWrapper
from typing import Annotated

import typer
from typer.exceptions import TyperException

from lammps_skin.engine.world import check_alone, place_in_world
from lammps_skin.errors import SkinError, one_line

COMMANDS = {
    "scenes": "List the built-in scenes and the parameter sets.",
    "check": "Show what a scene has and what it will cost, without running it.",
    "build": "Write a scene as LAMMPS input: scripts, tables, data file.",
    "run": "Run a scene, or a directory that `skin build` has made.",
    "convert": "Write the trajectory of a run, skin.dump, as an H5MD file that MDAnalysis reads.",
    "export": "Write the trajectory of a run for ParaView, OVITO, VMD, or as a dump of LAMMPS.",
    "evaluate": "Print energies by term and the force on every particle of a text file.",
    "stats": "Show the observables of a run: over time, averaged, with events and energies.",
    "report": "Write a page that shows a run, several side by side, or a study, in any browser.",
    "watch": "Watch a run as it goes on, in the terminal and in a browser.",
    "ensemble": "Run scenes with many seeds, and store the observables of each run.",
    "compare": "Show runs or ensembles side by side, with tests between them.",
    "study": "Vary a scene, with many seeds of each point: from a question to an answer.",
    "claims": "Test the paper's claims on the tables of ensembles.",
    "snapshot": (
        "Draw a run at a time: in three dimensions, as maps, as a vertical section, as a tree."
    ),
    "movie": "Write a movie of a run: the snapshot of every frame, from one camera.",
    "figure": "Draw a figure of the paper; what has not been run is run after a question.",
    "tradeoff": "Compare choices of numerics: error against time.",
    "stability": "Map the longest stable timesteps, by bisection, beside estimates.",
    "doctor": "Check the installation, and say what to do where it does not work.",
}
"""The subcommands, in modules of their names, and what `skin --help` says of them."""

COMPLETING = "_SKIN_COMPLETE"
"""Variable by which a shell asks for completions of what has been typed."""


def application(*names: str) -> typer.Typer:
    """The command; of its subcommands only those named are loaded, which may take a second."""
    app = typer.Typer(rich_markup_mode=None, pretty_exceptions_enable=False)
    app.callback(invoke_without_command=True)(help_alone)
    for name, summary in COMMANDS.items():
        module = import_module(f"{__name__}.{name}") if name in names else None
        command = getattr(module, name, _not_loaded)
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=name, help=summary)
        else:
            app.command(name, help=summary)(command)
    return app


def _not_loaded() -> None:
    """Stands for a subcommand that is not called."""


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        print(f"lammps-skin {version('lammps-skin')}, LAMMPS {version('lammps')}")
        raise typer.Exit


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
        words = sys.argv[1:] if arguments is None else arguments
        typed = os.environ.get("COMP_WORDS") or os.environ.get("_TYPER_COMPLETE_ARGS") or ""
        said = typed.split()[1:] if COMPLETING in os.environ else words
        called = next((word for word in said if not word.startswith("-")), "")
        code = application(called)(words, standalone_mode=False, prog_name="skin")
    except (SkinError, TyperException) as error:
        text = error.format_message() if isinstance(error, TyperException) else str(error)
        print(f"error: {one_line(text)}", file=sys.stderr)
        code = 2
    except OSError as error:
        place = "" if error.filename is None else f"{error.filename}: "
        print(f"error: {one_line(f'{place}{error.strerror or error}')}", file=sys.stderr)
        code = 2
    sys.exit(code or 0)
