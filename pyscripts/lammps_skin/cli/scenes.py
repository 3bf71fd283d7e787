"""``skin scenes``: what is built in."""

from __future__ import annotations

from lammps_skin.cli.output import console, print_table
from lammps_skin.model.parameters import DEFAULT, SUMMARIES
from lammps_skin.model.scene import Scene
from lammps_skin.model.scenes import BUILT_IN


def scenes() -> None:
    """List the built-in scenes and the parameter sets."""
    heads = ["scene", "what it is", "membrane", "stem", "ND", "until"]
    print_table(heads, map(_row, BUILT_IN), whole=[0, 2, 3, 4, 5], fold=True)
    print_table(["parameter set", "what it is"], SUMMARIES.items(), whole=[0], fold=True)
    console.print(f"\nThe default parameter set is {DEFAULT}. Run one with: skin run demo")


def _row(name: str) -> tuple[str, ...]:
    scene = Scene.load(name)
    nx, ny = scene.membrane.lattice
    return (
        name, scene.description, f"{nx} x {ny}", str(scene.cells.stem), str(scene.cells.nd),
        f"{scene.end_time:g}",
    )  # fmt: skip
