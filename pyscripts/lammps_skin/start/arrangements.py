"""Where the first cells stand on the flat membrane (section 5 of the model)."""

from __future__ import annotations

import math

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.errors import SceneError
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene

PLACEMENT_STREAM = 101  # keeps these random numbers apart from others of the same seed
TRIES_PER_CELL = 2000
WITH_RING = ("ring", "core", "alternating")  # arrangements


def place_cells(scene: Scene) -> dict[Kind, Floats]:
    """Places (n, 2) of the first cells of each kind that has any, no two closer than 2 R_c.

    The places of stem cells are dealt out evenly among all kinds but ND. Raises `SceneError` if so
    many cells do not fit.
    """
    cells = scene.cells
    lx, ly, _ = scene.box_sides
    radius = cells.ring_radius * lx
    centre = np.array([lx / 2, ly / 2])
    most = int(lx * ly / (2 * math.sqrt(3) * cells.radius**2))
    count, nd = scene.cell_count, cells.nd
    others = count - nd
    if count > most:
        raise SceneError(_does_not_fit(scene, f"there is room for {most:,} at most"))

    if cells.arrangement == "random":
        places = _random(scene, count)
    elif cells.arrangement == "cluster":
        places = _cluster(count, scene) + centre
    elif cells.arrangement == "ring":
        places = _ring(count, radius) + centre
    elif cells.arrangement == "core":
        places = np.concatenate([_ring(others, radius), _cluster(nd, scene)]) + centre
    elif cells.arrangement == "alternating":
        places = np.concatenate(_alternating(others, scene)) + centre
    else:
        quarter = np.array([lx / 4, 0])
        halves = _cluster(others, scene) - quarter, _cluster(nd, scene) + quarter
        places = np.concatenate(halves) + centre

    _check_room(scene, places)
    places %= [lx, ly]
    whose = {row.kind: row.count for row in scene.cell_kinds if row.count and row.kind != Kind.ND}
    dealt = _dealt(places[:others], list(whose.values()))
    found = dict(zip(whose, dealt, strict=True)) | ({Kind.ND: places[others:]} if nd else {})
    return dict(sorted(found.items()))


def _dealt(places: Floats, counts: list[int]) -> list[Floats]:
    """Places (n, 2) dealt out evenly: to each of some kinds as many as it has cells."""
    turns = np.array([(n + 0.5) / count for count in counts for n in range(count)])
    whose = np.repeat(np.arange(len(counts)), counts)[np.argsort(turns, kind="stable")]
    return [places[whose == kind] for kind in range(len(counts))]


def _ring(count: int, radius: float, turn: float = 0.0) -> Floats:
    angle = 2 * np.pi * (np.arange(count) + turn) / max(count, 1)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def _alternating(count: int, scene: Scene) -> tuple[Floats, Floats]:
    """One ring where there is room for all, else a zigzag of two rings 2 R_c apart."""
    radius, diameter = scene.cells.ring_radius * scene.box_sides[0], 2 * scene.cells.radius
    offset = 0.0 if 2 * radius * math.sin(np.pi / (2 * count)) >= diameter else diameter / 2
    return _ring(count, radius - offset), _ring(count, radius + offset, turn=0.5)


def _cluster(count: int, scene: Scene) -> Floats:
    """Hexagonal patch around the origin, nearest neighbors 2 R_c apart."""
    reach = math.isqrt(count) + 2
    row, column = (index.ravel() for index in np.mgrid[-reach : reach + 1, -reach : reach + 1])
    x, y = column + 0.5 * row, np.sqrt(3) / 2 * row
    nearest_first = np.lexsort([np.arctan2(y, x).round(9), (x**2 + y**2).round(9)])[:count]
    return 2 * scene.cells.radius * np.column_stack([x, y])[nearest_first]


def _random(scene: Scene, count: int) -> Floats:
    """Uniform places at least 2 R_c apart, by random sequential addition."""
    random = np.random.default_rng([scene.cell_seed, PLACEMENT_STREAM])
    sides = np.array(scene.box_sides[:2])
    places = np.empty((count, 2))
    for n in range(count):
        for _ in range(TRIES_PER_CELL):
            place = random.random(2) * sides
            if not n or _distances(places[:n], place, sides).min() >= 2 * scene.cells.radius:
                break
        else:
            raise SceneError(_does_not_fit(scene, f"at random only {n} found a place"))
        places[n] = place
    return places


def _distances(places: Floats, place: Floats, sides: Floats) -> Floats:
    delta = places - place
    delta -= sides * np.round(delta / sides)
    return np.hypot(delta[:, 0], delta[:, 1])


def _check_room(scene: Scene, places: Floats) -> None:
    sides = np.array(scene.box_sides[:2])
    diameter = 2 * scene.cells.radius
    for n in range(1, len(places)):
        closest = _distances(places[:n], places[n], sides).min()
        if closest < diameter * (1 - 1e-9):
            why = f"two would be {closest:.4g} apart, below 2 R_c = {diameter:g}"
            if scene.cells.arrangement in WITH_RING:
                why += f", with cells.ring_radius = {scene.cells.ring_radius:g}"
            raise SceneError(_does_not_fit(scene, why))


def _does_not_fit(scene: Scene, why: str) -> str:
    counts = {"cells.stem": scene.cells.stem, "cells.nd": scene.cells.nd}
    for row in scene.cell_kinds:
        if row.count and row.kind not in (Kind.STEM, Kind.ND):
            counts[f"cells.kinds.{row.label}.count"] = row.count
    *first, last = (f"{key} = {count}" for key, count in counts.items())
    lx, ly, _ = scene.box_sides
    return (
        f"{', '.join(first)} and {last}: do not fit in the arrangement "
        f"'{scene.cells.arrangement}' on a membrane of {lx:.4g} x {ly:.4g}: {why}"
    )
