"""Cost of a whole run with stock styles and at the levels of accuracy, from several of its ages.

A finished run gives the states. From each of them the levels take turns in one process, so that
all see the same machine; seconds are of this thread. The cost of the run is the integral over its
ages.

- stock: ``bond_style table``, ``dihedral_style multi/harmonic``, ``pair_style table``, forward
  Euler with a timestep of 0.01 (``fix skin/motion``, since ``fix brownian`` does not survive the
  folds of a crowded membrane), and ``fix skin/cells``;
- reference, balanced, fast: those levels, with the styles of this package.

    skin run quarter-ring -o runs/quarter-ring
    python benchmarks/whole_run.py runs/quarter-ring [--ages 0 100 ...] [--rounds 3]
"""

from __future__ import annotations

import argparse
import time
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from lammps_skin.kinds import is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.start.configuration import Configuration
from lammps_skin.trajectory.frame import Frame
from lammps_skin.trajectory.frames import open_frames
from step_cost import uncored

AGES = (0, 100, 200, 300, 400, 500, 600, 800, 1000)
SPANS = {"stock": 1.0, "reference": 2.0, "balanced": 20.0, "fast": 40.0}  # of turns alike in cost
QUIET = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}


def configuration_of(frame: Frame, scene: Scene) -> Configuration:
    """The state of a frame, its particles numbered anew without gaps."""
    number = np.zeros(frame.ids.max() + 1, int)
    number[frame.ids] = np.arange(len(frame.ids)) + 1
    links, hinges = lattice.links_and_hinges(scene.membrane.lattice)
    state = Configuration(
        box=np.array(scene.box_sides), kinds=frame.kinds, positions=frame.positions,
        links=links, hinges=hinges, time=frame.time,
    )  # fmt: skip
    cells = is_cell(frame.kinds)
    for name in ("divisions_left", "next_division", "birth_time"):
        getattr(state, name)[cells] = frame.state[name][cells]
    paired = np.flatnonzero(cells & (frame.state["pair"] > 0))
    other = number[frame.state["pair"][paired]]
    state.pair[paired] = other
    born = frame.state["birth_time"]
    state.pair_start[paired] = np.maximum(born[paired], born[other - 1])
    return state


def simulations(scene: Scene, state: Configuration, stack: ExitStack) -> dict[str, Simulation]:
    """The same state with stock styles and at each level."""
    levels = {
        "stock": {"numerics.accuracy": "reference", "numerics.pair_form": "table"},
        "reference": {"numerics.accuracy": "reference"},
        "balanced": {"numerics.accuracy": "balanced"},
        "fast": {"numerics.accuracy": "fast"},
    }
    started = {}
    for name, changes in levels.items():
        level = scene.replace(**QUIET, **changes)
        plain = uncored(level) if name == "stock" else {}  # no styles of this package
        started[name] = stack.enter_context(
            Simulation.begin(level, configuration=state, variables=plain)
        )
    half = scene.membrane.bending_stiffness / 2
    # (1 - cos)^2 with the angle of multi/harmonic, which is pi in a flat sheet
    for command in (
        "dihedral_style multi/harmonic",
        f"dihedral_coeff * {half} {2 * half} {half} 0 0",
    ):
        started["stock"].command(command)
    return started


def costs(scene: Scene, state: Configuration, rounds: int) -> dict[str, list[float]]:
    """Seconds of a time unit at each level, one value for each round."""
    spent: dict[str, list[float]] = {name: [] for name in SPANS}
    with ExitStack() as stack:
        started = simulations(scene, state, stack)
        for turn in range(rounds + 1):
            for name, simulation in started.items():
                until = simulation.time + SPANS[name]
                began = time.thread_time()
                simulation.run(until=until)
                if turn:  # the first sets up
                    spent[name].append((time.thread_time() - began) / SPANS[name])
    return spent


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path, help="run directory with a trajectory")
    parser.add_argument("--ages", type=float, nargs="+", default=AGES)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()

    scene = Scene.load(options.run / "scene.toml")
    frames = open_frames(options.run)
    times = np.array([frames[n].time for n in range(len(frames))])
    ages, table = [], []
    print("| t | particles | cells | " + " | ".join(f"{name}, s" for name in SPANS) + " |")
    print("| " + "--- | " * (3 + len(SPANS)))
    for age in options.ages:
        frame = frames[int(np.abs(times - age).argmin())]
        spent = costs(scene, configuration_of(frame, scene), options.rounds)
        ages.append(frame.time)
        table.append([spent[name] for name in SPANS])
        cells = int(is_cell(frame.kinds).sum())
        medians = " | ".join(f"{np.median(spent[name]):.3g}" for name in SPANS)
        print(f"| {frame.time:g} | {len(frame.ids)} | {cells} | {medians} |", flush=True)

    whole = np.trapezoid(np.array(table), ages, axis=0)  # (levels, rounds)
    for name, seconds in zip(SPANS, whole, strict=True):
        ratios = whole[0] / seconds
        print(
            f"{name:10} {np.median(seconds):8.1f} s from {ages[0]:g} to {ages[-1]:g}, "
            f"{np.median(ratios):.2f} ({ratios.min():.2f} to {ratios.max():.2f}) "
            "times faster than with stock styles"
        )


if __name__ == "__main__":
    main()
