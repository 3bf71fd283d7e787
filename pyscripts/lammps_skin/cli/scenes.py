"""``skin scenes``: what is built in."""

from __future__ import annotations

from rich.table import Table

from lammps_skin.cli.options import console
from lammps_skin.parameters import DEFAULT, SUMMARIES
from lammps_skin.scene import Scene
from lammps_skin.scenes import BUILT_IN


def scenes() -> None:
    """List the built-in scenes and the parameter sets."""
    table = Table("scene", "what it is", "membrane", "stem", "ND", "until", box=None)
    for name in BUILT_IN:
        scene = Scene.load(name)
        nx, ny = scene.membrane.lattice
        table.add_row(
            name, scene.description, f"{nx} x {ny}", str(scene.cells.stem), str(scene.cells.nd),
            f"{scene.end_time:g}",
        )  # fmt: skip
    console.print(table)

    table = Table("parameter set", "what it is", box=None)
    for name, summary in SUMMARIES.items():
        table.add_row(name, summary)
    console.print()
    console.print(table)
    console.print(f"\nThe default parameter set is {DEFAULT}. Run one with: skin run demo")
