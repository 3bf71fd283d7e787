"""What several subcommands share: options, the scene they describe, the console."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from lammps_skin.errors import SceneError
from lammps_skin.results import holds_results
from lammps_skin.scene import Scene

# nothing that a user gave is markup, and nothing is wrapped
console = Console(markup=False, highlight=False, emoji=False, soft_wrap=True)

Source = Annotated[
    str, typer.Argument(metavar="SCENE", help="Name of a built-in scene, or a .toml file.")
]
Parameters = Annotated[
    str | None, typer.Option("--parameters", metavar="SET", help="Named parameter set.")
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Change a key of the scene, such as cells.seed=3."
    ),
]


def keep_results(directory: Path, remedy: str) -> None:
    """Raise `SceneError` if a directory holds results of a run."""
    if holds_results(directory):
        raise SceneError(f"directory {directory}: holds results of a run; {remedy}")


def scene_from(source: str, parameters: str | None, settings: Iterable[str] | None) -> Scene:
    """The scene that a command line describes."""
    changes = changes_from(parameters, settings)
    scene = Scene.load(source)
    return scene.replace(**changes) if changes else scene


def changes_from(parameters: str | None, settings: Iterable[str] | None) -> dict[str, Any]:
    """Dotted scene keys and their values."""
    changes: dict[str, Any] = {} if parameters is None else {"parameters": parameters}
    for setting in settings or ():
        key, equals, text = setting.partition("=")
        if not equals or not key.strip():
            raise SceneError(f"--set {setting}: must be KEY=VALUE, such as cells.seed=3")
        changes[key.strip()] = _value(text.strip())
    return changes


def _value(text: str) -> Any:
    """A TOML value; what is none is a string."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if parsed.keys() == {"value"} else text


def duration(seconds: float) -> str:
    """Seconds in the unit in which they are read most easily."""
    for limit, unit, name in ((120, 1, "s"), (7200, 60, "min"), (172_800, 3600, "h")):
        if seconds < limit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds / 86_400:.3g} days"
