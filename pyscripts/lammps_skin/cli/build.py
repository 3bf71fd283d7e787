"""``skin build``: a directory in which ``lmp -in skin.in`` runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lammps_skin.cli.options import (
    Accuracy,
    At,
    From,
    Parameters,
    Seed,
    Settings,
    Source,
    keep_results,
    scene_from,
)
from lammps_skin.cli.output import console
from lammps_skin.model.scene import Scene
from lammps_skin.run.directory_lock import DirectoryLock
from lammps_skin.start.build import build as build_scene
from lammps_skin.start.configuration import Configuration


def build(
    scene: Source,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Where to write it.")
    ],
    parameters: Parameters = None,
    accuracy: Accuracy = None,
    seed: Seed = None,
    settings: Settings = None,
    run: From = None,
    at: At = None,
) -> None:
    """Write a scene as LAMMPS input: scripts, tables, data file."""
    described = scene_from(scene, parameters, settings, accuracy, seed, run, at)
    with DirectoryLock(output, make=True), console.status("building"):
        keep_results(output, "its inputs belong to them; give another")
        configuration = build_scene(described, output)
    counts = particles(described, configuration)
    console.print(f"{described.name}: {counts}; box {sides(configuration)}")
    console.print(f"built in {output}; run it there with: lmp -in skin.in")


def particles(scene: Scene, configuration: Configuration) -> str:
    """Numbers of particles by kind."""
    counts = [(int((configuration.kinds == kind).sum()), kind.label) for kind in scene.kinds]
    return ", ".join(f"{count} {label}" for count, label in counts if count)


def sides(configuration: Configuration) -> str:
    """Sides of the box."""
    return " x ".join(f"{side:.6g}" for side in configuration.box)
