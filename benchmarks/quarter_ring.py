"""The `quarter-ring` scene to its end time: what its membrane and its cells do.

Every 50 time units: numbers of cells, coverage, height of the membrane, papillae and the order
parameters of the paper. Writes one CSV file for each seed, and prints the means of all seeds as
a table.

    python benchmarks/quarter_ring.py --seeds 1 2 --jobs 2 -o docs/data

With ``--show`` it only prints the table of the files that are there.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from lammps_skin import lattice
from lammps_skin.analysis.coverage import coverage
from lammps_skin.analysis.curvature import curvature
from lammps_skin.analysis.order import order
from lammps_skin.analysis.papillae import blocks, find_papillae, skewness
from lammps_skin.analysis.surface import height_field, smooth
from lammps_skin.kinds import Kind
from lammps_skin.scene import Scene
from lammps_skin.simulation import Simulation

EVERY = 50.0
GRID = 0.5  # of the height field
SMOOTHING = 0.7  # half a cell radius, also the least prominence of a papilla


def measure(simulation: Simulation) -> dict[str, float]:
    """Observables of the current state."""
    scene, particles = simulation.scene, simulation.forces()
    box = scene.box_sides[:2]
    membrane = particles.positions[particles.types == Kind.MEMBRANE]
    cells = simulation.cells()
    bent = curvature(membrane, lattice.triangles(scene.membrane.lattice), box)
    below = cells.partner - 1  # the membrane comes first in a built scene
    orders = order(
        cells.types, cells.positions, bent.mean[below], bent.gaussian[below], box,
        scene.cells.radius,
    )  # fmt: skip
    height = height_field(membrane, lattice.triangles(scene.membrane.lattice), box, GRID)
    papillae = find_papillae(smooth(height, box, SMOOTHING), box, SMOOTHING)
    reach = scene.cells.adhesion_range * scene.contact
    return {
        "time": simulation.time,
        "stem": int((particles.types == Kind.STEM).sum()),
        "TA": int((particles.types == Kind.TA).sum()),
        "exhausted": int((particles.types == Kind.EXHAUSTED).sum()),
        "coverage": coverage(membrane, cells.positions, box, reach),
        "height": float(membrane[:, 2].mean()),
        "height_std": float(membrane[:, 2].std()),
        "skewness": skewness(blocks(height, 5)).value,
        "papillae": len(papillae.height),
        "papilla_height": float(papillae.height.mean()) if len(papillae.height) else np.nan,
        "chi_H": orders.chi_H,
        "zeta": orders.zeta,
        "sigma": orders.sigma,
    }


def run(seed: int, folder: Path, largest_move: float) -> Path:
    """One seed, from the beginning to the end time; stops with an error if the run does."""
    quiet = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
    scene = Scene.load("quarter-ring").replace(
        seed=seed, **quiet, **{"numerics.largest_move": largest_move}
    )
    path = folder / f"quarter-ring-{seed}.csv"
    with Simulation(scene) as simulation, path.open("w", encoding="utf-8") as file:
        rows = measured(simulation, scene.end_time)
        writer = csv.DictWriter(file, list(first := next(rows)))
        writer.writeheader()
        writer.writerow(first)
        for row in rows:
            writer.writerow({name: f"{value:.6g}" for name, value in row.items()})
            file.flush()
    return path


def measured(simulation: Simulation, until: float) -> Iterator[dict[str, float]]:
    """Observables every `EVERY` time units."""
    yield measure(simulation)
    for time in np.arange(EVERY, until + EVERY / 2, EVERY):
        simulation.run(until=float(time))
        yield measure(simulation)


def show(paths: list[Path]) -> None:
    """Means over seeds, as a Markdown table."""
    tables = [np.genfromtxt(path, delimiter=",", names=True) for path in paths]
    shortest = min(len(table) for table in tables)
    names = tables[0].dtype.names or ()
    mean = {name: np.mean([table[name][:shortest] for table in tables], axis=0) for name in names}
    print("| " + " | ".join(names) + " |")
    print("|" + " --- |" * len(names))
    for n in range(shortest):
        print("| " + " | ".join(f"{mean[name][n]:.4g}" for name in names) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(description="the quarter-ring scene to its end time")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("-o", dest="folder", type=Path, default=Path("docs/data"))
    parser.add_argument("--largest-move", type=float, default=0.05, help="0: plain Euler")
    parser.add_argument("--show", action="store_true")
    options = parser.parse_args()

    options.folder.mkdir(parents=True, exist_ok=True)
    if not options.show:
        with ProcessPoolExecutor(options.jobs) as pool:
            more = (
                [options.folder] * len(options.seeds),
                [options.largest_move] * len(options.seeds),
            )
            list(pool.map(run, options.seeds, *more))
    show([options.folder / f"quarter-ring-{seed}.csv" for seed in options.seeds])


if __name__ == "__main__":
    main()
