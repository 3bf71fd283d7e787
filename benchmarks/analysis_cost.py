"""Cost of the observables of a frame, part by part, against the cost of the run.

Takes the last frame of a run on disk. With ``--tile 2`` it is repeated twice in x and y: the
quarter scenes then have the size of the paper's. Every part is timed `ROUNDS` times, in time of
this process alone; the median is printed. For the run as it is, the time to read a frame, and all
of the analysis against the time that the run took, from the loop times in its log.

    python benchmarks/analysis_cost.py runs/quarter-ring --tile 2
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from lammps_skin.analysis.basal_layer import links
from lammps_skin.analysis.geometry import minimum_image
from lammps_skin.analysis.observables import Observables, Run, open_run
from lammps_skin.analysis.state import State, StateAnalysis
from lammps_skin.kinds import Kind
from lammps_skin.start import lattice

ROUNDS = 7
PARTS: dict[str, Callable[[State], Any]] = {  # each uses what those before it have left
    "curvature below the cells": lambda state: state.curvature_below,
    "order parameters": lambda state: (state.order(Kind.STEM), state.order(Kind.ND)),
    "coverage": lambda state: state.coverage,
    "layers and links": lambda state: (state.layering, state.sheet),
    "height field": lambda state: state.height,
    "skewness": lambda state: state.skewness(),
    "papillae": lambda state: state.papillae,
    "cells on tips": lambda state: (state.tips(Kind.STEM), state.tips(Kind.ND)),
}


class LastState(StateAnalysis):
    """``state`` of the last frame that was looked at."""

    def _measure(self, state: State) -> tuple[Any, ...]:
        self.state = state
        return ()


def tiled(state: State, times: int) -> State:
    """The state repeated in x and y."""
    nx, ny = state.scene.membrane.lattice
    scene = state.scene.replace(
        **{"membrane.lattice": [times * nx, times * ny], "cells.stem": 1, "cells.nd": 0}
    )
    flat = lattice.positions((nx, ny), state.scene.spacing, 0.0)
    whole = flat + minimum_image(state.membrane - flat, state.box)
    row, column = np.divmod(np.arange(nx * ny), nx)
    membrane = np.empty((times**2 * nx * ny, 3))
    cells, below = [], []
    for i, j in np.ndindex(times, times):
        shift = np.array([i * state.box[0], j * state.box[1], 0.0])
        place = (row + j * ny) * times * nx + column + i * nx
        membrane[place] = whole + shift
        cells.append(state.cells + shift)
        below.append(place[state.below])
    triangles = lattice.triangles(scene.membrane.lattice)
    return replace(
        state, scene=scene, box=times * state.box, membrane=membrane,
        triangles=triangles, links=links(triangles), cells=np.concatenate(cells),
        kinds=np.tile(state.kinds, times**2), below=np.concatenate(below),
        ids=np.arange(times**2 * len(state.ids)),
    )  # fmt: skip


def cost_of_parts(state: State) -> dict[str, float]:
    """Median seconds of each part."""
    seconds: dict[str, list[float]] = {name: [] for name in PARTS}
    for _ in range(ROUNDS):
        fresh = replace(state)
        for name, part in PARTS.items():
            began = time.process_time()
            part(fresh)
            seconds[name].append(time.process_time() - began)
    return {name: median(values) for name, values in seconds.items()}


def cost_of_run(log: Path) -> float:
    """Seconds of all runs in a log."""
    lines = log.read_text("utf-8").splitlines()
    return sum(float(line.split()[3]) for line in lines if line.startswith("Loop time of"))


def timed(action: Callable[[], Any]) -> float:
    began = time.process_time()
    action()
    return time.process_time() - began


def show(run: Run, directory: Path, times: int) -> None:
    last = LastState(run.universe)
    last.run(start=len(run.universe.trajectory) - 1)
    state = tiled(last.state, times) if times > 1 else last.state
    print(
        f"{run.scene.name} at t = {state.time:g}, repeated {times} x {times}: "
        f"{len(state.membrane):,} membrane particles, {len(state.cells):,} cells"
    )
    parts = cost_of_parts(state)
    for name, seconds in {**parts, "sum": sum(parts.values())}.items():
        print(f"  {name:<28}{1e3 * seconds:8.1f} ms")
    frames = len(run.universe.trajectory)
    reading = timed(lambda: [None for _ in run.universe.trajectory])
    analysis = timed(lambda: Observables(run.universe, run.events).run())
    took = cost_of_run(directory / "log.lammps")
    print(f"the run: {frames} frames, {took:.0f} s to run")
    print(f"  reading a frame             {1e3 * reading / frames:8.1f} ms")
    print(f"  all observables of a frame  {1e3 * analysis / frames:8.1f} ms, with reading")
    print(f"  analysis of all frames      {analysis:8.1f} s, {analysis / took:.1%} of the run")


def main() -> None:
    parser = argparse.ArgumentParser(description="cost of the observables of a frame")
    parser.add_argument("run", type=Path, help="directory of a run")
    parser.add_argument("--tile", type=int, default=1, help="repeat the frame in x and y")
    options = parser.parse_args()
    with open_run(options.run) as run:
        show(run, options.run, options.tile)


if __name__ == "__main__":
    main()
