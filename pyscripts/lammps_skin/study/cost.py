"""What a run will cost: memory, steps and seconds, from a few measured numbers.

The numbers in `Rates` are of one core, from whole runs of built-in scenes
(``python benchmarks/run_cost.py``); `measure` times a short run of a scene on this machine.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.engine.machine import A_PROCESS
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.counts import first_counts
from lammps_skin.start.memory import PER_PARTICLE
from lammps_skin.study.growth import growth

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
    start, packed : float
        Seconds until the first step: of a process that loads the package and LAMMPS, and for every
        dermal particle that is packed.
    base_memory, particle_memory : float
        Bytes of the process, and for every particle with its links.
    """

    step: float = 1.0e-3
    particle: float = 1.9e-8
    dermal: float = 3.8e-7
    cell: float = 1.14e-6
    link: float = 3.4e-8
    rebuild: float = 1.9e-6
    start: float = 2.5
    packed: float = 9.0e-4
    base_memory: float = A_PROCESS
    particle_memory: float = PER_PARTICLE


@dataclass(frozen=True)
class Cost:
    """Cost of a run on one core.

    Attributes
    ----------
    steps : int
        From the time at which it begins to its end.
    cells : float
        Number that is expected at the end.
    start, first_step, seconds : float
        Seconds until the first step, of the first step, and of all.
    memory : float
        Bytes.
    """

    steps: int
    cells: float
    start: float
    first_step: float
    seconds: float
    memory: float


def estimate(scene: Scene, rates: Rates | None = None) -> Cost:
    """Expected cost of a whole run, from the time at which it begins."""
    rates = rates or Rates()
    first = first_counts(scene)
    membrane, dermal = first[Kind.MEMBRANE], first[Kind.DERMAL]
    steps = round((scene.end_time - scene.begins) / scene.numerics.timestep)
    times = np.linspace(scene.begins, scene.end_time, 201)
    found = growth(scene, {kind.label: n for kind, n in first.items() if is_cell(kind)}, times)
    particles = membrane + dermal + found.cells
    forces = (
        rates.particle * particles
        + rates.dermal * dermal
        + rates.cell * found.cells
        + rates.link * 3 * membrane
    )
    rebuilds = _rebuilds(scene, found.divisions) * scene.numerics.timestep
    step = scene.numerics.evaluations * forces + rates.rebuild * particles * rebuilds
    start = rates.start + rates.packed * (0 if scene.start.run else dermal)
    return Cost(
        steps=steps,
        cells=float(found.cells[-1]),
        start=start,
        first_step=float(step[0]),
        seconds=start + steps * (rates.step + float(step.mean())),
        memory=rates.base_memory + rates.particle_memory * float(particles[-1]),
    )


def _rebuilds(scene: Scene, divisions: Floats) -> Floats:
    """Rebuilds of the neighbor lists per time unit: by events, on event steps, and by motion."""
    numerics = scene.numerics
    interval = max(numerics.event_interval, numerics.timestep)
    by_events: Floats = -np.expm1(-EVENTS_PER_CYCLE * divisions * interval) / interval
    return by_events + REBUILDS_BY_MOTION / numerics.neighbor_skin


def measure(scene: Scene, seconds: float = 1.0) -> float:
    """Seconds of a step at the start of a scene, from a run of about `seconds` here and now."""
    timestep = scene.numerics.timestep
    steps = max(round(seconds / estimate(scene).first_step), 20)
    warm_up = max(steps // 10, 1)
    quiet = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
    with Simulation.begin(scene.replace(**quiet)) as simulation:
        first = simulation.time
        simulation.run(until=first + warm_up * timestep)
        began = time.perf_counter()
        simulation.run(until=first + (warm_up + steps) * timestep)
        return (time.perf_counter() - began) / steps
