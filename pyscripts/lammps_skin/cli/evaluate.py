"""``skin evaluate``: energies and forces of one configuration."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.options import Parameters, Settings, changes_from
from lammps_skin.errors import ConfigurationError
from lammps_skin.files import atomic_write
from lammps_skin.model.parameters import DEFAULT
from lammps_skin.run import evaluate as single_point


def evaluate(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="Lines 'lattice NX NY Lx Ly time', 'kind x y z [m]', 'pair i j L'."
        ),
    ],
    parameters: Parameters = None,
    settings: Settings = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT", help="Output file instead of stdout."),
    ] = None,
) -> None:
    """Print energies by term and the force on every particle of a text file."""
    changes = changes_from(parameters, settings)
    name = changes.pop("parameters", DEFAULT)
    text = "\n".join(single_point.evaluate(file, name, changes).lines()) + "\n"
    if output is None:
        print(text, end="")
        return
    try:
        with atomic_write(output) as place:
            place.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"output {output}: {error.strerror}") from None
