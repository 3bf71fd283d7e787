"""What a run will cost: memory, steps and seconds, from a few measured numbers.

The numbers in `Rates` are of one core, from whole runs of built-in scenes
(``python benchmarks/run_cost.py``); `measure` times a short run of a scene on this machine.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.memory import BASE, PER_PARTICLE, particle_counts

CROWDED = 0.7  # cells per unit area of a covered membrane, with the default parameters
EVENTS_PER_CYCLE = 3.0  # of a cell: its share in births, ends of divisions and removals
REBUILDS_BY_MOTION = 0.15  # per time unit, divided by the neighbor skin


@dataclass(frozen=True)
class Rates:
    """Seconds of one core and bytes.

    Attributes
    ----------
    step : float
        Seconds of a step in a whole run, whatever its size: output, checkpoints, progress.
    particle, dermal, cell, link : float
        Seconds of a step: for every particle, and what dermal particles, cells and links add.
    rebuild : float
        Seconds of a rebuild of the neighbor lists, for every particle.
    base_memory, particle_memory : float
        Bytes of the process, and for every particle with its links.
    """

    step: float = 1.0e-3
    particle: float = 1.9e-8
    dermal: float = 3.8e-7
    cell: float = 1.14e-6
    link: float = 3.4e-8
    rebuild: float = 1.9e-6
    base_memory: float = BASE
    particle_memory: float = PER_PARTICLE


@dataclass(frozen=True)
class Cost:
    """Cost of a run on one core: seconds of a step at its start, seconds of all, bytes.

    `cells` is the number of cells that is expected at the end.
    """

    steps: int
    cells: float
    first_step: float
    seconds: float
    memory: float


def estimate(scene: Scene, rates: Rates | None = None) -> Cost:
    """Expected cost of a whole run: lineages double in each cell cycle until it is crowded."""
    rates = rates or Rates()
    membrane, dermal, _ = particle_counts(scene)
    steps = round(scene.end_time / scene.numerics.timestep)
    times = np.linspace(0.0, scene.end_time, 201)
    cells = _cells(scene, times)
    particles = membrane + dermal + cells
    forces = (
        rates.particle * particles
        + rates.dermal * dermal
        + rates.cell * cells
        + rates.link * 3 * membrane
    )
    rebuilds = _rebuilds(scene, cells) * scene.numerics.timestep
    step = scene.numerics.evaluations * forces + rates.rebuild * particles * rebuilds
    return Cost(
        steps=steps,
        cells=float(cells[-1]),
        first_step=float(step[0]),
        seconds=steps * (rates.step + float(step.mean())),
        memory=rates.base_memory + rates.particle_memory * float(particles[-1]),
    )


def _cells(scene: Scene, times: np.ndarray) -> np.ndarray:
    """Expected number of cells (n,) at times (n,)."""
    dividing = _dividing(scene)
    lx, ly, _ = scene.box_sides
    room = max(CROWDED * lx * ly, dividing)
    doublings = np.minimum(times / scene.shortest_cycle, 60.0)
    return np.minimum(dividing * 2.0**doublings, room) + scene.cell_count - dividing


def _dividing(scene: Scene) -> int:
    """Number of cells at the start that divide."""
    return sum(kind.count for kind in scene.cell_kinds if kind.daughter)


def _rebuilds(scene: Scene, cells: np.ndarray) -> np.ndarray:
    """Rebuilds of the neighbor lists per time unit: by events, on event steps, and by motion."""
    numerics = scene.numerics
    interval = max(numerics.event_interval, numerics.timestep)
    dividing = cells - scene.cell_count + _dividing(scene)
    events = EVENTS_PER_CYCLE * dividing / scene.shortest_cycle
    return -np.expm1(-events * interval) / interval + REBUILDS_BY_MOTION / numerics.neighbor_skin


def measure(scene: Scene, seconds: float = 1.0) -> float:
    """Seconds of a step at the start of a scene, from a run of about `seconds` here and now."""
    timestep = scene.numerics.timestep
    steps = max(round(seconds / estimate(scene).first_step), 20)
    warm_up = max(steps // 10, 1)
    quiet = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
    with Simulation.begin(scene.replace(**quiet)) as simulation:
        simulation.run(until=warm_up * timestep)
        began = time.perf_counter()
        simulation.run(until=(warm_up + steps) * timestep)
        return (time.perf_counter() - began) / steps
