"""Cost of the membrane's stretch and bending per link, against stock LAMMPS styles, side by side.

The membrane of a scene, alone and held still, in two states: flat with a little noise, and, with
the directory of a run, as folded as in its last frame. Each style alone and both together, ours
and stock (``bond_style table``, ``dihedral_style multi/harmonic``), take turns in one process on
one core. Forces alone are computed, no energies. Seconds are of this thread, so other processes
count little; the part of them that is in the styles is that of LAMMPS' own timers ("Bond").

    python benchmarks/membrane_cost.py [--run runs/paper-ring] [--steps 200] [--rounds 15]
"""

from __future__ import annotations

import argparse
import re
import tempfile
import time
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import numpy as np
from lammps_skin.engine.engine import open_lammps
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms, stretch_table
from lammps_skin.start import lattice
from lammps_skin.start.configuration import Configuration
from lammps_skin.trajectory.frames import open_frames

NOISE = 0.02  # of the heights of the flat membrane
CUTOFF = 4.2  # of the pairs of a whole scene: ghost particles and sorting go by it


def flat(scene: Scene) -> Configuration:
    bare = {"dermis.present": False, "cells.stem": 0, "cells.nd": 0, "membrane.noise": NOISE}
    return Configuration.from_scene(scene.replace(**bare))


def folded(scene: Scene, run: Path) -> Configuration:
    """The membrane of the last frame of a run."""
    frames = open_frames(run)
    frame = frames[len(frames) - 1]
    membrane = frame.kinds == Kind.MEMBRANE
    links, hinges = lattice.links_and_hinges(scene.membrane.lattice)
    return Configuration(
        box=np.array(scene.box_sides), kinds=frame.kinds[membrane],
        positions=frame.positions[membrane], links=links, hinges=hinges,
    )  # fmt: skip


def styles(scene: Scene, folder: Path) -> dict[str, list[str]]:
    """Commands that set up each of the variants."""
    table = stretch_table(scene)
    table.write(folder / "stretch.table")
    half = scene.membrane.bending_stiffness / 2
    ours = Terms.of(scene.replace(**{"numerics.pair_form": "analytic"})).stretch
    stretch = ["bond_style skin/stretch", f"bond_coeff 1 {ours.coefficients}"]
    bend = ["dihedral_style skin/bend", f"dihedral_coeff 1 {2 * half}"]
    stock_stretch = [
        f"bond_style table linear {len(table.distances)}",
        f"bond_coeff 1 {folder}/stretch.table {table.keyword}",
    ]
    stock_bend = [
        "dihedral_style multi/harmonic",
        f"dihedral_coeff 1 {half} {2 * half} {half} 0 0",
    ]
    return {
        "skin/stretch": stretch, "skin/bend": bend, "both": stretch + bend,
        "table": stock_stretch, "multi/harmonic": stock_bend,
        "both, stock": stock_stretch + stock_bend,
    }  # fmt: skip


def opened(data: Path, log: Path, commands: list[str]) -> Any:
    """LAMMPS with a membrane that nothing moves."""
    engine = open_lammps(["-log", str(log)])
    bonds = any("bond_style" in command for command in commands)
    dihedrals = any("dihedral_style" in command for command in commands)
    engine.commands_string(f"""
        units lj
        atom_style molecular
        newton on
        processors * * 1
        boundary p p f
        atom_modify sort 1000 {CUTOFF / 2}
        read_data {data}
        pair_style zero {CUTOFF} nocoeff
        pair_coeff * *
        {"" if bonds else "bond_style none"}
        {"" if dihedrals else "dihedral_style none"}
        thermo_style custom step
        neigh_modify delay 1000000
    """)
    engine.commands_list(commands)
    return engine


def nanoseconds(engine: Any, log: Path, steps: int, links: int, first: bool) -> float:
    """Nanoseconds of this thread in bonded forces, for each link and step."""
    start = time.thread_time()
    engine.command(f"run {steps} pre {'yes' if first else 'no'}")
    spent = time.thread_time() - start
    text = log.read_text(encoding="utf-8")
    whole = float(re.findall(r"Loop time of (\S+)", text)[-1])
    bonded = float(re.findall(r"Bond +\| *\S+ *\| *(\S+)", text)[-1])
    return 1e9 * spent * bonded / whole / steps / links


def measure(scene: Scene, state: Configuration, steps: int, rounds: int) -> dict[str, list[float]]:
    """Nanoseconds per link of each variant, one value for each round."""
    links = len(state.links)
    with tempfile.TemporaryDirectory() as name, ExitStack() as stack:
        folder = Path(name)
        state.write_data(folder / "membrane.data", (Kind.MEMBRANE,))
        variants = styles(scene, folder)
        logs = {variant: folder / f"log.{n}" for n, variant in enumerate(variants)}
        engines = {}
        for variant, commands in variants.items():
            engine = opened(folder / "membrane.data", logs[variant], commands)
            engines[variant] = stack.enter_context(closing(engine))
        found: dict[str, list[float]] = {variant: [] for variant in variants}
        for turn in range(rounds + 1):
            for variant, engine in engines.items():
                spent = nanoseconds(engine, logs[variant], steps, links, first=not turn)
                if turn:  # the first sets up
                    found[variant].append(spent)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="paper-ring", help="its membrane, if there is no run")
    parser.add_argument("--run", type=Path, help="run directory with a trajectory")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()

    scene = Scene.load(options.run / "scene.toml" if options.run else options.scene)
    states = {"flat": flat(scene)}
    if options.run:
        states["folded"] = folded(scene, options.run)
    print(f"{len(states['flat'].kinds)} particles, {len(states['flat'].links)} links; ns per link")
    print("| state | styles | median | quartiles | least |\n| --- | --- | --- | --- | --- |")
    for name, state in states.items():
        for variant, values in measure(scene, state, options.steps, options.rounds).items():
            low, middle, high = np.percentile(values, (25, 50, 75))
            print(
                f"| {name} | {variant} | {middle:.1f} | {low:.1f} to {high:.1f} "
                f"| {min(values):.1f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
