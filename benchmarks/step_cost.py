"""Cost of a step against stock LAMMPS styles, on one configuration, side by side.

The configuration is that of a scene (by default `paper-ring`) at a time at which it has about
3,000 cells. Three simulations take turns, so that all see the same state of the machine:

- ours: the scene at the level of accuracy `reference`;
- without the fix: the same without ``fix skin/cells``, to know what that costs;
- without cores: ours without ``pair_style skin/core``;
- stock: ``bond_style table``, ``dihedral_style multi/harmonic``, one ``pair_style table
  linear`` for all pairs, ``neighbor multi``, ``fix brownian``, and no ``fix skin/cells``.

    python benchmarks/step_cost.py [--scene quarter-ring] [--time 275] [--steps 200] [--rounds 7]
"""

from __future__ import annotations

import argparse
import re
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from lammps_skin.engine.engine import open_lammps
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.model.tables import Table, pair_grid
from lammps_skin.model.terms import Terms, stretch_table
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import ghost_cutoff
from lammps_skin.start.configuration import Configuration

STEPS, ROUNDS, POINTS = 200, 7, 10_000


def grown(scene: Scene, until: float) -> Configuration:
    """The scene's state at a time, as a configuration."""
    start = Configuration.from_scene(scene)
    with Simulation.begin(scene, configuration=start) as simulation:
        simulation.run(until=until)
        particles, cells = simulation.forces(), simulation.cells()
        reached = simulation.time
    number = {int(id_): n for n, id_ in enumerate(particles.ids)}
    at = np.array([number[int(id_)] for id_ in cells.ids])
    state = Configuration(
        box=start.box, kinds=particles.types, positions=particles.positions,
        links=start.links, hinges=start.hinges, time=reached,
    )  # fmt: skip
    state.divisions_left[at] = cells.divisions_left
    state.next_division[at] = cells.next_division
    state.pair[at] = [number.get(int(other), -1) + 1 for other in cells.pair]
    state.pair_start[at] = np.where(cells.pair > 0, reached - 10.0, 0.0)
    return state


def stock(scene: Scene, configuration: Configuration, folder: Path) -> Any:
    """The same particles in stock styles."""
    terms, tables = Terms.of(scene), stock_tables(scene)
    for table in [*tables.values(), stretch_table(scene)]:
        table.write(folder / f"{table.keyword}.table")
    configuration.write_data(folder / "stock.data", scene.kinds)
    engine = open_lammps(["-log", str(folder / "log.stock")])
    cells = " ".join(kind.label for kind in scene.cell_kinds)
    points = len(stretch_table(scene).distances)
    properties = "i_a i_b i_c i_d d_e d_f d_g d_h"
    engine.commands_string(f"""
        units lj
        atom_style molecular
        newton on
        processors * * 1
        boundary p p f
        fix state all property/atom {properties}
        read_data {folder}/stock.data fix state NULL state
        special_bonds lj/coul 0.0 1.0 1.0
        pair_style table linear {POINTS}
        bond_style table linear {points}
        bond_coeff 1 {folder}/STRETCH.table STRETCH
        dihedral_style multi/harmonic
        dihedral_coeff 1 {half(scene)} {2 * half(scene)} {half(scene)} 0 0
        group cells type {cells}
        variable own atom id
        set group cells mol v_own
        neigh_modify every 1 delay 0 check yes exclude molecule/intra cells
        neighbor {scene.numerics.neighbor_skin} multi
        comm_modify cutoff {ghost_cutoff(terms, configuration)}
        group dermis type dermal
        fix wall dermis wall/lj126 zlo 0.0 {terms.wall}
        fix motion all brownian 1.0 1 gamma_t 1.0 rng none
        timestep {scene.numerics.timestep}
        thermo 1000
    """)
    for younger, older in enumerate(configuration.pair, 1):
        if older:
            engine.command(f"set atom {younger} mol {min(younger, older)}")
    for (first, second), table in tables.items():
        engine.command(
            f"pair_coeff {first} {second} {folder}/{table.keyword}.table {table.keyword} "
            f"{table.outer:.17g}"
        )
    return engine


def uncored(scene: Scene) -> dict[str, object]:
    """Variables with which nobody watches how close particles come."""
    return {"has_cores": 0, "pair_styles": " ".join(term.style for term in Terms.of(scene).pairs)}


def half(scene: Scene) -> float:
    return scene.membrane.bending_stiffness / 2


def stock_tables(scene: Scene) -> dict[tuple[int, int], Table]:
    """One table for each pair of types: the sum of its terms; nothing at all as zeros."""
    shapes = Terms.of(scene).pair_potentials
    kinds = scene.kinds
    tables = {}
    for i, first in enumerate(kinds, 1):
        for j, second in enumerate(kinds[i - 1 :], i):
            names = between(first, second)
            terms = [shapes[name] for name in names]
            contact = terms[0].contact if terms else 0.5
            reach = max((shape.range for shape in terms), default=1.0)

            def energy(r: Any, terms: Any = terms) -> Any:
                return sum((s.stiffness * s.energy(r / s.contact) for s in terms), 0 * r)

            def force(r: Any, terms: Any = terms) -> Any:
                slopes = (s.stiffness * s.slope(r / s.contact) / s.contact for s in terms)
                return sum((-slope for slope in slopes), 0 * r)

            grid = pair_grid(contact, 0.2, reach, POINTS)
            grid = np.sqrt(np.linspace(grid[0] ** 2, grid[-1] ** 2, POINTS))
            tables[i, j] = Table(f"PAIR_{i}_{j}", energy, force, grid, squared=True)
    return tables


def between(first: Kind, second: Kind) -> list[str]:
    """Names of the pair terms between two kinds, in the order of their numbers."""
    if second == Kind.DERMAL:
        return ["dermis_dermis"]
    if second == Kind.MEMBRANE:
        return ["dermis_membrane" if first == Kind.DERMAL else "membrane_exclusion"]
    if first == Kind.DERMAL:
        return []
    if first == Kind.MEMBRANE:
        return ["cell_membrane_exclusion"]
    return ["cell_cell_exclusion", "cell_cell_adhesion"]


def cost(engine: Any, log: Path, steps: int) -> tuple[float, float]:
    """Milliseconds per step of a run, and those in fixes, as LAMMPS' own timers have it.

    The first is the time of this thread: other processes on the machine do not count.
    """
    start = time.thread_time()
    engine.command(f"run {steps} pre no")
    spent = 1000 * (time.thread_time() - start) / steps
    text = log.read_text(encoding="utf-8")
    whole = float(re.findall(r"Loop time of (\S+)", text)[-1])
    fixes = float(re.findall(r"Modify +\| *\S+ *\| *(\S+)", text)[-1])
    return spent, spent * fixes / whole


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="paper-ring")
    parser.add_argument("--time", type=float, default=275.0)
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    options = parser.parse_args()

    quiet = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
    scene = Scene.load(options.scene).replace(**quiet)
    configuration = grown(scene.replace(**{"numerics.accuracy": "balanced"}), options.time)
    scene = scene.replace(**{"numerics.accuracy": "reference"})
    cells = int(configuration.is_cell.sum())
    print(f"{scene.name} at t = {configuration.time:g}: {len(configuration.kinds)} particles, "
          f"{len(configuration.links)} links, {cells} cells")  # fmt: skip

    with (
        tempfile.TemporaryDirectory() as folder,
        Simulation.begin(scene, configuration=configuration) as ours,
        Simulation.begin(scene, configuration=configuration) as without,
        Simulation.begin(scene, configuration=configuration, variables=uncored(scene)) as bare,
    ):
        without.command("unfix cells")
        for column in ("thermo_style one", "thermo 1000"):
            for simulation in (ours, without, bare):
                simulation.command(column)
        baseline = stock(scene, configuration, Path(folder))
        engines = {
            "ours": ours, "without the fix": without, "without cores": bare, "stock": baseline,
        }  # fmt: skip
        logs = {
            "ours": ours.directory / "log.lammps",
            "without the fix": without.directory / "log.lammps",
            "without cores": bare.directory / "log.lammps",
            "stock": Path(folder) / "log.stock",
        }
        for engine in engines.values():
            engine.command(f"run {options.steps // 4}")
        costs: dict[str, list[tuple[float, float]]] = {name: [] for name in engines}
        for _ in range(options.rounds):
            for name, engine in engines.items():
                costs[name].append(cost(engine, logs[name], options.steps))
        baseline.close()
    report({name: np.array(rows).T for name, rows in costs.items()})


def report(costs: dict[str, Any]) -> None:
    """Print medians, and medians of the ratios of each round."""
    for name, (step, _) in costs.items():
        print(f"{name:16} {np.median(step):8.3f} ms per step")
    (ours, fixes), (without, other_fixes), (bare, _), (stock, _) = costs.values()
    print(f"ours without the fix / stock: {np.median(without / stock):.3f} (target 0.6)")
    print(f"ours / stock:                 {np.median(ours / stock):.3f}")
    print(
        f"the fix's share of a step:    {np.median((fixes - other_fixes) / ours):.3f} (target 0.1)"
    )
    forced = np.median(1 - without / ours - (fixes - other_fixes) / ours)
    print(f"neighbor builds it asks for:  {forced:.3f} of a step, at births and removals")
    print(f"ours / without cores:         {np.median(ours / bare):.3f}")


if __name__ == "__main__":
    main()
