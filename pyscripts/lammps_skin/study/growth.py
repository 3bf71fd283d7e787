"""How many cells are expected in the course of a run, and how often they divide."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.model.cell_kinds import CellKind
from lammps_skin.model.changes import scene_at
from lammps_skin.model.interventions import ALL, Intervention
from lammps_skin.model.scene import Scene

CROWDED = 0.7  # cells per unit area of a covered membrane, with the default parameters
MOST_DOUBLINGS = 60.0  # between two times
GRID = 32  # points along a side of the box, for the share of a region


class Growth(NamedTuple):
    """Numbers of cells (n,), and of divisions per time unit (n,)."""

    cells: Floats
    divisions: Floats


def growth(scene: Scene, first: Mapping[str, int], times: Floats) -> Growth:
    """What is expected at times: kinds that divide double in a cycle of theirs until it is crowded.

    Parameters
    ----------
    scene : Scene
    first : mapping
        Numbers of cells at the first time, by the labels of their kinds.
    times : (n,) array
        Ascending. What interventions do later is counted, with the share of the membrane that
        is in their region.
    """
    lx, ly, _ = scene.box_sides
    shares = {one.name: one.fraction * _share(one, scene) for one in scene.interventions}
    numbers = {label: float(first.get(label, 0)) for label in scene.cell_table}
    rows = []
    for before, now in pairwise([times[0], *times]):
        table = scene_at(scene, now).cell_table
        _grow(numbers, table, now - before, CROWDED * lx * ly)
        for one in scene.interventions:
            _intervene(numbers, one, _done(one, now) - _done(one, before), shares[one.name])
        divisions = sum(numbers[row.label] / row.cycle for row in table.values() if _divides(row))
        rows.append((sum(numbers.values()), divisions))
    cells, happening = np.array(rows).T
    return Growth(cells, happening)


def _divides(row: CellKind) -> bool:
    return row.daughter is not None and row.generations != 0


def _grow(
    numbers: dict[str, float], table: Mapping[str, CellKind], interval: float, room: float
) -> None:
    """Add the newborn of an interval, as far as there is room."""
    born = dict.fromkeys(numbers, 0.0)
    for label, row in table.items():
        if row.daughter is not None and _divides(row):
            cycles = interval / row.cycle
            if _divides(table[row.daughter]):  # who divide in turn
                cycles = 2.0 ** min(cycles, MOST_DOUBLINGS) - 1
            born[row.daughter] += numbers[label] * cycles
    free, wanted = max(room - sum(numbers.values()), 0.0), sum(born.values())
    for label, number in born.items():
        numbers[label] += number * min(free / wanted, 1.0) if wanted else 0.0


def _done(one: Intervention, time: float) -> int:
    """How often an intervention has been done up to a time."""
    if time < one.first:
        return 0
    last = time if one.until is None else min(time, one.until)
    return 1 + (math.floor((last - one.first) / one.every + 1e-9) if one.every else 0)


def _intervene(numbers: dict[str, float], one: Intervention, repeats: int, share: float) -> None:
    if one.add:
        numbers[one.add] += repeats * len(one.places or ())
    chosen = one.remove or one.convert or ()
    leaving = 1 - (1 - share) ** repeats
    for label in numbers if ALL in chosen else chosen:
        left = numbers[label] * leaving
        numbers[label] -= left
        if one.to:
            numbers[one.to] += left


def _share(one: Intervention, scene: Scene) -> float:
    """Share of the flat membrane that is in the region of an intervention."""
    lx, ly, _ = scene.box_sides
    steps = (np.arange(GRID) + 0.5) / GRID
    x, y = (side.ravel() for side in np.meshgrid(lx * steps, ly * steps))
    inside = np.ones(len(x), bool)
    if one.within and one.within.cylinder:
        *center, radius = one.within.cylinder
        apart = [
            (along - middle + side / 2) % side - side / 2
            for along, middle, side in zip((x, y), center, (lx, ly), strict=True)
        ]
        inside &= np.hypot(*apart) < radius
    if one.within and one.within.half_space:
        *normal, offset = one.within.half_space
        inside &= normal[0] * x + normal[1] * y + normal[2] * scene.membrane_height > offset
    return float(inside.mean())
