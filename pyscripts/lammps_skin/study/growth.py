"""How many cells are expected in the course of a run, and how often they divide."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.model.cell_kinds import CellKind
from lammps_skin.model.changes import scene_at
from lammps_skin.model.interventions import ALL, Intervention
from lammps_skin.model.scene import Scene

# cells per unit area of a covered membrane, with two strengths of adhesion: they make one layer
# with the weaker one, and heap with the other
CROWDED = {5.0: 0.27, 25.0: 0.7}
PHASES = 8  # of the cycle, in which the first cells are
MOST_CYCLES = 12  # between two times
GRID = 32  # points along a side of the box, for the share of a region


class Growth(NamedTuple):
    """Numbers of cells (n,), and of divisions per time unit (n,)."""

    cells: Floats
    divisions: Floats


@dataclass(frozen=True)
class Cohort:
    """Cells of a kind that divide together.

    Attributes
    ----------
    label : str
        Of their kind.
    number : float
    left : float
        Divisions that each of them has left.
    due : float
        Time of the next one.
    """

    label: str
    number: float
    left: float
    due: float


def growth(scene: Scene, first: Mapping[str, int], times: Floats) -> Growth:
    """What is expected at times, of cells that divide in each cycle of theirs and share the room.

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
    table = scene_at(scene, times[0]).cell_table
    cohorts = [one for label, n in first.items() for one in _spread(table[label], n, times[0])]
    rows = []
    for before, now in pairwise([times[0], *times]):
        table = scene_at(scene, now).cell_table
        cohorts = [one for cohort in cohorts for one in _divide(cohort, table, now)]
        for one in scene.interventions:
            repeats = _done(one, now) - _done(one, before)
            if repeats:
                cohorts = list(_intervene(cohorts, table, one, repeats, shares[one.name], now))
        cohorts = _crowded(_merged(cohorts, table), table, lx * ly)
        divisions = sum(
            one.number / table[one.label].cycle for one in cohorts if _divides(one, table)
        )
        rows.append((sum(one.number for one in cohorts), divisions))
    cells, happening = np.array(rows).T
    return Growth(cells, happening)


def _spread(row: CellKind, number: float, now: float) -> Iterator[Cohort]:
    """Cells of a kind in all phases of their cycle."""
    for n in range(PHASES if number else 0):
        due = now + (n + 0.5) / PHASES * row.cycle
        yield Cohort(row.label, number / PHASES, _generations(row), due)


def _generations(row: CellKind) -> float:
    return math.inf if row.generations is None else row.generations


def _divides(cohort: Cohort, table: Mapping[str, CellKind]) -> bool:
    return table[cohort.label].daughter is not None and cohort.left > 0


def _divide(cohort: Cohort, table: Mapping[str, CellKind], now: float) -> Iterator[Cohort]:
    """The cells of a cohort, and what they have given birth to up to a time."""
    if _divides(cohort, table):  # of very many cycles the last ones are enough
        cycle = table[cohort.label].cycle
        missed = max(math.floor((now - cohort.due) / cycle) - MOST_CYCLES, 0)
        cohort = replace(cohort, due=cohort.due + missed * cycle)
    while cohort.due <= now and _divides(cohort, table):
        row, due = table[cohort.label], cohort.due
        cohort = replace(cohort, left=cohort.left - 1, due=due + row.cycle)
        if row.daughter == row.label:  # they have as many divisions left
            cohort = replace(cohort, number=2 * cohort.number)
        elif row.daughter is not None:
            born = table[row.daughter]
            newborn = Cohort(born.label, cohort.number, _generations(born), due + born.cycle)
            yield from _divide(newborn, table, now)
        if not cohort.left and row.after_last is not None:
            after = table[row.after_last]
            cohort = replace(cohort, label=after.label, left=_generations(after))
    yield cohort


def _merged(cohorts: list[Cohort], table: Mapping[str, CellKind]) -> list[Cohort]:
    """Cohorts that are about in the same phase of the same cycle are one."""
    found: dict[tuple[str, float, int], Cohort] = {}
    for one in cohorts:
        phase = math.floor(one.due / table[one.label].cycle * PHASES + 1e-6)
        key = one.label, one.left, phase if _divides(one, table) else 0
        if key in found:
            one = replace(one, number=one.number + found[key].number)
        found[key] = one
    return list(found.values())


def _crowded(cohorts: list[Cohort], table: Mapping[str, CellKind], area: float) -> list[Cohort]:
    """Of kinds that detach, no more cells than there is room for."""
    numbers = [one.number for one in cohorts if table[one.label].detaches]
    staying = sum(one.number for one in cohorts) - sum(numbers)
    adhesive = [one for one in cohorts if table[one.label].adhesion == "adhesive"]
    weights = [one.number for one in adhesive]
    if not sum(weights) or not sum(numbers):
        return cohorts
    strength = np.average([table[one.label].stiffness for one in adhesive], weights=weights)
    room = area * float(np.interp(strength, [*CROWDED], [*CROWDED.values()]))
    kept = min(max(room - staying, 0.0) / sum(numbers), 1.0)
    return [
        replace(one, number=kept * one.number) if table[one.label].detaches else one
        for one in cohorts
    ]


def _done(one: Intervention, time: float) -> int:
    """How often an intervention has been done up to a time."""
    if time < one.first:
        return 0
    last = time if one.until is None else min(time, one.until)
    return 1 + (math.floor((last - one.first) / one.every + 1e-9) if one.every else 0)


def _intervene(
    cohorts: list[Cohort], table: Mapping[str, CellKind], one: Intervention, repeats: int,
    share: float, now: float,
) -> Iterator[Cohort]:  # fmt: skip
    """The cohorts after an intervention."""
    if one.add:
        yield from _spread(table[one.add], repeats * len(one.places or ()), now)
    chosen = one.remove or one.convert or ()
    leaving = 1 - (1 - share) ** repeats
    for cohort in cohorts:
        if ALL in chosen or cohort.label in chosen:
            if one.to:
                yield from _spread(table[one.to], cohort.number * leaving, now)
            cohort = replace(cohort, number=cohort.number * (1 - leaving))
        yield cohort


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
