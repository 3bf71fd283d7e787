"""What several subcommands share: options, and the scene they describe."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

from lammps_skin.errors import SceneError
from lammps_skin.model.accuracy import LEVELS
from lammps_skin.model.parameters import SETS
from lammps_skin.model.scene import Scene
from lammps_skin.model.scene_keys import keys_of, shown
from lammps_skin.model.scenes import BUILT_IN
from lammps_skin.run.results import holds_results


def beginning(incomplete: str, words: Iterable[str]) -> list[str]:
    """Words that begin with what has been typed, for a shell that completes it."""
    return [word for word in words if word.startswith(incomplete)]


def scenes_beginning(incomplete: str) -> list[str]:
    """Built-in scenes whose names begin with what has been typed; a shell adds files."""
    return beginning(incomplete, BUILT_IN)


Source = Annotated[
    str,
    typer.Argument(
        metavar="SCENE", help="Name of a built-in scene, or a .toml file.",
        autocompletion=scenes_beginning,
    ),
]  # fmt: skip
Parameters = Annotated[
    str | None,
    typer.Option(
        "--parameters", metavar="SET", help="Named parameter set.",
        autocompletion=lambda incomplete: beginning(incomplete, SETS),
    ),
]  # fmt: skip
Seed = Annotated[
    int | None, typer.Option("--seed", metavar="N", help="Of all that is random in the scene.")
]
Jobs = Annotated[
    int | None,
    typer.Option(min=1, max=4096, help="Runs at a time [default: as many as cores]."),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Of a scheduler of dask, whose workers run them [default: processes of this machine].",
    ),
]
Accuracy = Annotated[
    str | None,
    typer.Option(
        "--accuracy", metavar="LEVEL", help=f"{', '.join(LEVELS)}.",
        autocompletion=lambda incomplete: beginning(incomplete, LEVELS),
    ),
]  # fmt: skip
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Change a key of the scene, such as cells.seed=3.",
        autocompletion=lambda incomplete: beginning(incomplete, (f"{k}=" for k in keys_of(Scene))),
    ),
]  # fmt: skip


From = Annotated[
    str | None,
    typer.Option("--from", metavar="RUN", help="Begin with the state of a run: a directory."),
]
At = Annotated[
    float | None, typer.Option("--at", metavar="TIME", help="Of that state [default: its last].")
]


def keep_results(directory: Path, remedy: str) -> None:
    """Raise `SceneError` if a directory holds results of a run."""
    if holds_results(directory):
        raise SceneError(f"directory {directory}: holds results of a run; {remedy}")


def scene_from(
    source: str, parameters: str | None, settings: Iterable[str] | None,
    accuracy: str | None = None, seed: int | None = None,
    run: str | None = None, at: float | None = None,
) -> Scene:  # fmt: skip
    """The scene that a command line describes."""
    changes = changes_from(parameters, settings, accuracy, seed)
    if run is not None or at is not None:
        # what the scene may say of another state does not count
        changes |= {"start.time": at, "start.content": None, "start.versions": None}
        changes |= {} if run is None else {"start.from": str(Path(run).absolute())}
    scene = Scene.load(source)
    if changes:
        scene = scene.replace(**changes)
    if seed is not None and scene.cells.seed is not None:
        raise SceneError(
            f"--seed {seed}: would not change the cells, whose seed is given: cells.seed = "
            f"{scene.cells.seed}; give --set cells.seed={seed}"
        )
    return scene


def changes_from(
    parameters: str | None, settings: Iterable[str] | None,
    accuracy: str | None = None, seed: int | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Dotted scene keys and their values; raises `SceneError` for a key that is given twice."""
    options = {"parameters": parameters, "numerics.accuracy": accuracy, "seed": seed}
    changes = {key: value for key, value in options.items() if value is not None}
    for setting in settings or ():
        key, equals, text = setting.partition("=")
        key = key.strip()
        if not equals or not key:
            raise SceneError(f"--set {setting}: must be KEY=VALUE, such as cells.seed=3")
        if key in changes:
            raise SceneError(f"--set {setting}: {key} = {shown(changes[key])} is given, too")
        changes[key] = _value(text.strip())
    return changes


def _value(text: str) -> Any:
    """A TOML value; what is none is a string."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if parsed.keys() == {"value"} else text
