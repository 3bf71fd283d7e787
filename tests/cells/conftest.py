"""Small scenes for fix skin/cells, and its random numbers and schedules in Python."""

import csv
import heapq
import math
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms
from lammps_skin.start import lattice
from lammps_skin.start.configuration import Configuration

# threads that wait must not keep the cores from other processes
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

HEIGHT = 22.4
CONTACT = 2.4
RADIUS = 1.4
HALF_SEPARATION = 0.005 * RADIUS
WAIT, ORIENTATION, FIRST_PHASE = 1, 2, 3  # purposes of random numbers
WORD = 2**64 - 1
QUIET = {"thermo_interval": 10.0, "dump_interval": 0.0, "checkpoint_interval": 0.0}
FOUR_STEPS = {  # of a time unit, with events on every second one and a limit of stiffness
    "integrator": "rkl1", "stages": 5, "timestep": 0.25, "stiffness_limit": 100.0,
    "event_interval": 0.5,
}  # fmt: skip
FREEZE = "fix freeze all setforce 0 0 0"
TIME_DIGITS = 1e-9  # events.csv states ten digits


def membrane_scene(size: tuple[int, int] = (24, 28), **changes: object) -> Scene:
    """Stem line and ND cells on a free membrane, nothing written but the event log."""
    scene = Scene.from_dict(
        {
            "name": "test",
            "dermis": {"present": False},
            "membrane": {"lattice": list(size)},
            "cells": {"stem": 1, "nd": 1, "arrangement": "random"},
            "numerics": {"accuracy": "reference"},
            "output": QUIET,
        }
    )
    return scene.replace(**changes)


def busy_scene(**changes: object) -> Scene:
    """Cells that divide and detach often: cycles of 8 time units, pairs of 5."""
    cells = {
        "cells.generations": 3, "cells.cycle_delay": 6.0, "cells.cycle_rate": 0.5,
        "cells.first_phase": 8.0, "cells.division_rate": 0.56, "numerics.timestep": 0.02,
    }  # fmt: skip
    return membrane_scene(**cells, **changes)


def place(
    scene: Scene,
    cells: Sequence[tuple[Kind, Sequence[float], int]],
    amplitude: float = 0.0,
) -> Configuration:
    """Cells as (kind, place, divisions left) on a membrane that is flat or waves in x and y."""
    sheet = lattice.positions(scene.membrane.lattice, scene.spacing, HEIGHT)
    sheet[:, 2] += wave(scene, sheet, amplitude)
    links, hinges = lattice.links_and_hinges(scene.membrane.lattice)
    kinds, places, divisions_left = zip(*cells, strict=True) if cells else ((), (), ())
    bare = [0] * len(sheet)
    return Configuration(
        box=np.array(scene.box_sides),
        kinds=np.array([Kind.MEMBRANE] * len(sheet) + list(kinds), int),
        positions=np.concatenate([sheet, np.reshape(places, (-1, 3))]),
        links=links,
        hinges=hinges,
        divisions_left=np.array(bare + list(divisions_left), int),
    )


def wave(scene: Scene, x: np.ndarray, amplitude: float) -> np.ndarray:
    """Height of the waving membrane above the flat one at places (n, 2 or 3)."""
    phase = 2 * np.pi * x[:, :2] / scene.box_sides[:2]
    return amplitude * np.cos(phase[:, 0]) * np.cos(phase[:, 1])


def grid(scene: Scene, across: int, jitter: float = 0.0, seed: int = 1) -> np.ndarray:
    """Places (across^2, 2) on a square grid over the membrane."""
    steps = np.indices((across, across)).reshape(2, -1).T + 0.5
    steps += jitter * np.random.default_rng(seed).uniform(-1, 1, steps.shape)
    return steps / across * scene.box_sides[:2]


def crowd(
    scene: Scene, across: int, amplitude: float, above: float, seed: int = 1
) -> Configuration:
    """All kinds of cells, mixed, mostly TA, close together on a waving membrane."""
    flat = grid(scene, across, jitter=0.1, seed=seed)
    heights = HEIGHT + above + wave(scene, flat, amplitude)
    mixture = [Kind.STEM, Kind.TA, Kind.TA, Kind.TA, Kind.EXHAUSTED, Kind.ND]
    kinds = [mixture[k] for k in np.random.default_rng(seed).integers(0, 6, len(flat))]
    left = {Kind.STEM: scene.cells.generations, Kind.TA: 3}
    cells = [
        (kind, (*xy, z), left.get(kind, 0))
        for kind, xy, z in zip(kinds, flat, heights, strict=True)
    ]
    return place(scene, cells, amplitude)


# ---- events.csv


@dataclass(frozen=True)
class Event:
    """A line of events.csv."""

    time: float
    kind: str
    id: int
    parent: int
    type: int
    x: tuple[float, float, float]
    divisions_left: int
    cause: str


def read_events(directory: Path) -> list[Event]:
    """Lines of a closed run's events.csv."""
    with (directory / "events.csv").open(newline="") as file:
        return [
            Event(
                float(row["time"]), row["kind"], int(row["id"]), int(row["parent"]),
                int(row["type"]), (float(row["x"]), float(row["y"]), float(row["z"])),
                int(row["divisions_left"]), row["cause"],
            )
            for row in csv.DictReader(file)
        ]  # fmt: skip


def of_kind(events: list[Event], kind: str) -> list[Event]:
    return [event for event in events if event.kind == kind]


def assert_same_events(directory: Path, other: Path) -> None:
    """Two logs of the same events, but for rounding."""
    ours, theirs = read_events(directory), read_events(other)
    names = ("kind", "id", "parent", "type", "divisions_left", "cause")
    assert [[getattr(e, name) for name in names] for e in ours] == [
        [getattr(e, name) for name in names] for e in theirs
    ]
    for a, b in zip(ours, theirs, strict=True):
        np.testing.assert_allclose([a.time, *a.x], [b.time, *b.x], rtol=1e-9)


# ---- log.lammps and skin.dump


def thermo(directory: Path) -> list[dict[str, float]]:
    """Thermo rows of log.lammps by column."""
    rows, columns = [], []
    for line in (directory / "log.lammps").read_text().splitlines():
        words = line.split()
        if words[:3] == ["Step", "Time", "Atoms"]:
            columns = words
        elif len(words) == len(columns) and words and words[0].isdigit():
            rows.append(dict(zip(columns, map(float, words), strict=True)))
    return rows


Frame = tuple[float, list[int], list[int], np.ndarray]  # time, ids, types, positions


def frames(path: Path) -> list[Frame]:
    """All frames of a dump file, or of the last one in a directory."""
    if path.is_dir():
        path = max(path.glob("skin*.dump"), key=lambda dump: dump.stat().st_mtime_ns)
    found = []
    for text in path.read_text().split("ITEM: TIME\n")[1:]:
        head, body = text.split("ITEM: ATOMS")
        lines = head.splitlines()
        count = int(lines[lines.index("ITEM: NUMBER OF ATOMS") + 1])
        rows = np.array([line.split()[:5] for line in body.splitlines()[1:]], float)
        assert len(rows) == count
        ids, types = rows[:, :2].astype(int).T.tolist()
        found.append((float(lines[0]), ids, types, rows[:, 2:]))
    return found


# ---- the random numbers of the plugin, from its documented key


def _mix(z: int) -> int:
    z = (z + 0x9E3779B97F4A7C15) & WORD
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & WORD
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & WORD
    return z ^ (z >> 31)


def uniform(seed: int, cell: int, event: int, purpose: int) -> float:
    """Random number in (0, 1) of a key."""
    word = _mix(_mix(_mix(_mix(seed) ^ cell) ^ event) ^ purpose)
    return min(((word >> 11) + 0.5) * 2.0**-53, 1 - 2.0**-53)


def exponential(scene: Scene, seed: int, cell: int, event: int) -> float:
    return -math.log(uniform(seed, cell, event, WAIT)) / scene.cells.cycle_rate


def first_division(scene: Scene, seed: int, cell: int, start: float = 0.0) -> float:
    """Time of the first division of a cell that was there at the start."""
    elapsed = scene.cells.first_phase * uniform(seed, cell, 0, FIRST_PHASE)
    rest = max(scene.cells.cycle_delay - elapsed, 0.0)
    return start + rest + exponential(scene, seed, cell, 0)


# ---- schedules and lineage, told in advance from the seed

Told = tuple[float, str, int, int, int]  # time, kind, id, parent, divisions left


def told_events(scene: Scene, seed: int, founders: dict[int, float], until: float) -> list[Told]:
    """Births and ends of divisions of stem cells and their line, in the order of their times.

    Founders are the ids of the stem cells and the times of their first divisions.
    """
    _, start, rate, end = Terms.of(scene).division
    left = dict.fromkeys(founders, math.inf)
    done: Counter[int] = Counter()
    due = [(time, cell) for cell, time in founders.items()]
    heapq.heapify(due)
    next_id = max(founders) + 1
    events: list[Told] = []
    while due and due[0][0] <= until:
        time, mother = heapq.heappop(due)
        daughter, next_id = next_id, next_id + 1
        done[mother] += 1
        if left[mother] == math.inf:
            left[daughter] = scene.cells.generations
        else:
            left[mother] = left[daughter] = left[mother] - 1
        m = int(left[daughter])
        grown = time + (end - start) / rate
        events.append((time, "birth", daughter, mother, m))
        events.append((grown, "division_end", daughter, mother, m))
        for cell in (mother, daughter):
            if left[cell]:
                wait = scene.cells.cycle_delay + exponential(scene, seed, cell, done[cell])
                heapq.heappush(due, (max(time + wait, grown), cell))
    return sorted(event for event in events if event[0] <= until)


def check_told(events: list[Event], told: list[Told]) -> None:
    """Events are those told, at the times told, whatever their order in the file."""
    events = sorted(events, key=lambda event: event.time)
    assert [(e.kind, e.id, e.parent, e.divisions_left) for e in events] == [e[1:] for e in told]
    times = [event.time for event in events]
    np.testing.assert_allclose(times, [event[0] for event in told], rtol=TIME_DIGITS)
    for event in events:
        assert event.type == (Kind.TA if event.divisions_left else Kind.EXHAUSTED)
        assert event.cause == {"birth": "division", "division_end": "grown"}[event.kind]


# ---- LAMMPS in a process of its own


def lmp(directory: Path, *arguments: str, ranks: int = 1) -> subprocess.CompletedProcess[str]:
    """Run ``lmp -in skin.in`` in a built directory."""
    binaries = Path(sys.executable).parent
    launcher = [str(binaries / "mpirun"), "-np", str(ranks)] if ranks > 1 else []
    command = [*launcher, str(binaries / "lmp"), *arguments, "-in", "skin.in"]
    return subprocess.run(command, cwd=directory, capture_output=True, text=True, timeout=120)
