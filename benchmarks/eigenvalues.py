"""The largest eigenvalue of the second derivatives of the energy, in frames of a run.

skin run quarter-ring -o runs/quarter-ring
python benchmarks/eigenvalues.py runs/quarter-ring 300 600 1000
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.study.stability.hessian import largest_eigenvalue


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path, help="run directory with a trajectory")
    parser.add_argument("times", type=float, nargs="+", help="of its frames")
    options = parser.parse_args()

    print("| t | largest eigenvalue | Euler stable up to |\n| --- | --- | --- |")
    for time in options.times:
        scene = Scene.load(str(options.run / "scene.toml")).replace(
            **{"start.from": str(options.run), "start.time": time, "end_time": time + 1.0,
               "interventions": [], "numerics": {"accuracy": "reference", "largest_move": 0.0}}
        )  # fmt: skip
        with Simulation.begin(scene) as simulation:
            found = largest_eigenvalue(simulation, np.ones(len(simulation.forces().ids)))
        print(f"| {time:g} | {found:.1f} | {2 / found:.3f} |", flush=True)


if __name__ == "__main__":
    main()
