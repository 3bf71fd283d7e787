"""Cost of a neighbor build against stock LAMMPS styles, on one configuration, side by side.

All particles stand still. On every other step one sphere of the dermis is moved to and fro by more
than half of the neighbor skin, which makes LAMMPS build everything anew: what such a step costs
more than one without is the build, with what the styles and fixes do after it. Simulations take
turns in one process; seconds are of this thread.

- stock: as in step_cost.py: one ``pair_style table`` for all pairs, all special neighbors up to the
  third, dividing pairs excluded as molecules;
- analytic: ``numerics.pair_form = "analytic"``, the lists of LAMMPS for lj/cut and tables;
- skin: ``numerics.pair_form = "skin"``, the lists of the plugin.

    python benchmarks/rebuild_cost.py --run runs/paper-ring [--age 1000] [--rounds 15]
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory.frames import open_frames
from step_cost import stock
from whole_run import QUIET, configuration_of

FORMS = ("analytic", "skin")
FAR = 0.3  # more than half of a neighbor skin
STILL = {"numerics.accuracy": "reference", "numerics.timestep": 1e-9, "output.thermo_interval": 1.0}


class Bench:
    """A simulation whose neighbor lists can be built at will."""

    def __init__(self, command: Callable[[str], None], particle: int, x: float) -> None:
        self._command, self._particle, self._x = command, particle, x
        self._away = False
        for text in ("thermo_style one", "thermo 1000000", "timestep 1e-9", "run 2"):
            command(text)

    def milliseconds(self, build: bool) -> float:
        """Of a step, with a build or without."""
        if build:
            self._away = not self._away
            self._command(f"set atom {self._particle} x {self._x + FAR * self._away:.17g}")
        began = time.thread_time()
        self._command("run 1 pre no post no")
        return 1000 * (time.thread_time() - began)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--run", type=Path, required=True, help="run directory with a trajectory")
    parser.add_argument("--age", type=float, default=1000.0)
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()

    scene = Scene.load(options.run / "scene.toml").replace(**QUIET, **STILL)
    frames = open_frames(options.run)
    times = np.array([frames[n].time for n in range(len(frames))])
    state = configuration_of(frames[int(np.abs(times - options.age).argmin())], scene)
    low = np.where(state.kinds == Kind.DERMAL, state.positions[:, 2], np.inf)
    lowest = int(low.argmin())
    place = lowest + 1, float(state.positions[lowest, 0])
    print(f"t = {state.time:g}: {len(state.kinds)} particles, {state.is_cell.sum()} cells")

    benches, opened = {}, []
    with tempfile.TemporaryDirectory() as folder:
        engine = stock(scene, state, Path(folder))
        benches["stock"] = Bench(engine.command, *place)
        for form in FORMS:
            simulation = Simulation.begin(
                scene.replace(**{"numerics.pair_form": form}), configuration=state
            )
            opened.append(simulation)
            benches[form] = Bench(simulation.command, *place)
        found: dict[str, list[tuple[float, float]]] = {name: [] for name in benches}
        for _ in range(options.rounds):
            for name, bench in benches.items():
                without, within = bench.milliseconds(False), bench.milliseconds(True)
                found[name].append((without, within))
        engine.close()
    for simulation in opened:
        simulation.close()

    builds = {name: np.diff(np.array(rows), axis=1)[:, 0] for name, rows in found.items()}
    print("| styles | step without, ms | build, ms | least | over stock |\n" + "| --- " * 5 + "|")
    for name, rows in found.items():
        step = np.median([without for without, _ in rows])
        ratio = np.median(builds[name] / builds["stock"])
        build = builds[name]
        print(f"| {name} | {step:.3g} | {np.median(build):.3g} | {build.min():.3g} | {ratio:.2f} |")


if __name__ == "__main__":
    main()
