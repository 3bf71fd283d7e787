"""What a run will cost: memory, disk, steps and seconds, from measured rates.

`measure` times a short run of a scene on this machine.
"""

from __future__ import annotations

import time
from dataclasses import astuple, dataclass

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.model.stiffness import evaluations
from lammps_skin.run.checkpoints import KEPT
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration
from lammps_skin.start.counts import first_counts
from lammps_skin.study.growth import growth
from lammps_skin.study.rates import SHIPPED, Rates, rates_here, store

EVENTS_PER_CYCLE = 3.0  # of a cell: its share in births, ends of divisions and removals
REBUILDS_BY_MOTION = 0.15  # per time unit, divided by the neighbor skin
PROCESS, HELD = 130e6, 2800.0  # bytes of memory of a process, and of a particle in it
FRAMED, SAVED, BUILT = 23.0, 330.0, 190.0  # bytes of a particle in a frame, checkpoint, skin.data
LOGGED = 80.0  # bytes of an event in the log

# what a calibration times, whatever the levels are, and seconds of a step of it where the shipped
# rates were measured
TIMED, TIMED_STEP = "quarter-ring", 1.2e-2
TIMED_KEYS = {
    "parameters": "earlier-stiff", "numerics.accuracy": "balanced", "numerics.integrator": "rkl2",
    "numerics.stages": 13, "numerics.timestep": 1.0, "numerics.neighbor_skin": 0.5,
}  # fmt: skip


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
    memory, disk : float
        Bytes.
    """

    steps: int
    cells: float
    start: float
    first_step: float
    seconds: float
    memory: float
    disk: float


def estimate(scene: Scene, rates: Rates | None = None) -> Cost:
    """Expected cost of a whole run, from the time at which it begins."""
    rates = rates or rates_here()
    first = first_counts(scene)
    membrane, dermal = first[Kind.MEMBRANE], first[Kind.DERMAL]
    duration, timestep = scene.end_time - scene.begins, scene.numerics.timestep
    times = np.linspace(scene.begins, scene.end_time, 201)
    found = growth(scene, {kind.label: n for kind, n in first.items() if is_cell(kind)}, times)
    done = work(scene, membrane, dermal, found.cells, found.divisions)
    each = done * astuple(rates)[: done.shape[1]]
    seconds = each.sum(axis=1)
    start = rates.start + rates.packed * (0 if scene.start.run else dermal)
    particles = membrane + dermal + found.cells
    output = scene.output
    frames = duration / output.dump_interval if output.dump_interval else 0.0
    saved = KEPT if output.checkpoint_interval else 1
    events = EVENTS_PER_CYCLE * float(found.divisions.mean()) * duration
    return Cost(
        steps=round(duration / timestep),
        cells=float(found.cells[-1]),
        start=start,
        first_step=timestep * float(seconds[0] - each[0, -1]),  # without a frame
        seconds=start + duration * float(seconds.mean()),
        memory=PROCESS + HELD * float(particles.max()),
        disk=float((BUILT + FRAMED * frames + SAVED * saved) * particles.mean()) + LOGGED * events,
    )


def work(scene: Scene, membrane: float, dermal: float, cells: Floats, divisions: Floats) -> Floats:
    """What is done in a time unit (n, 6), in the order of `Rates`, for numbers of cells (n,)."""
    numerics, interval = scene.numerics, scene.output.dump_interval
    evaluated = np.full(len(cells), evaluations(scene) / numerics.timestep)
    frames = np.full(len(cells), 1 / interval if interval else 0.0)
    particles = membrane + dermal + cells
    return np.column_stack([
        evaluated, evaluated * membrane, evaluated * dermal, evaluated * cells,
        _rebuilds(scene, divisions) * particles, frames,
    ])  # fmt: skip


def _rebuilds(scene: Scene, divisions: Floats) -> Floats:
    """Rebuilds of the neighbor lists per time unit: by events, on event steps, and by motion."""
    numerics = scene.numerics
    interval = max(numerics.event_interval, numerics.timestep)
    by_events: Floats = -np.expm1(-EVENTS_PER_CYCLE * divisions * interval) / interval
    return by_events + REBUILDS_BY_MOTION / numerics.neighbor_skin


def measure(
    scene: Scene, seconds: float = 1.0, configuration: Configuration | None = None
) -> float:
    """Seconds of a step at the start of a scene, from a run of about `seconds` here and now.

    They are CPU time of this thread, and hardly depend on what else runs.
    """
    steps = max(round(seconds / estimate(scene).first_step), 20)
    quiet = {"output.dump_interval": 0.0, "output.checkpoint_interval": 0.0}
    with Simulation.begin(scene.replace(**quiet), configuration=configuration) as simulation:
        first, timestep = simulation.time, simulation.timestep
        warm_up = max(steps // 10, 1)
        simulation.run(until=first + warm_up * timestep)
        began = time.thread_time()
        simulation.run(until=first + (warm_up + steps) * timestep)
        return (time.thread_time() - began) / steps


def calibrate() -> tuple[float, float]:
    """How many times longer than by the shipped rates a run, and its start, take here.

    Both are stored, for all estimates on this machine.
    """
    scene = Scene.load(TIMED).replace(**TIMED_KEYS)
    began = time.thread_time()
    state = Configuration.from_scene(scene)
    dermal = int((state.kinds == Kind.DERMAL).sum())
    starting = (time.thread_time() - began) / (SHIPPED.packed * dermal)
    running = measure(scene, configuration=state) / TIMED_STEP
    store(running, starting)
    return running, starting
