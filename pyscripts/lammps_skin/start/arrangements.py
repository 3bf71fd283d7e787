"""Where the first stem and ND cells stand on the flat membrane (section 5 of the model)."""

from __future__ import annotations

import math

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.errors import SceneError
from lammps_skin.model.scene import Scene

RING_RADIUS = 0.3  # of L_x
PLACEMENT_STREAM = 101  # keeps these random numbers apart from others of the same seed
TRIES_PER_CELL = 2000


def place_cells(scene: Scene) -> tuple[Floats, Floats]:
    """Places (n, 2) of the stem and of the ND cells, no two closer than 2 R_c.

    Raises `SceneError` if so many cells do not fit.
    """
    cells = scene.cells
    lx, ly, _ = scene.box_sides
    centre = np.array([lx / 2, ly / 2])
    nobody = np.empty((0, 2))
    most = int(lx * ly / (2 * math.sqrt(3) * cells.radius**2))
    if cells.stem + cells.nd > most:
        raise SceneError(_does_not_fit(scene, f"there is room for {most:,} at most"))

    if cells.arrangement == "random":
        both = _random(scene, cells.stem + cells.nd)
        stem, nd = both[: cells.stem], both[cells.stem :]
    elif cells.arrangement == "cluster":
        both = _cluster(cells.stem + cells.nd, scene) + centre
        stem, nd = both[: cells.stem], both[cells.stem :]
    elif cells.arrangement == "ring":
        both = _ring(cells.stem + cells.nd, RING_RADIUS * lx) + centre
        stem, nd = both[: cells.stem], both[cells.stem :]
    elif cells.arrangement == "core":
        stem, nd = _ring(cells.stem, RING_RADIUS * lx) + centre, _cluster(cells.nd, scene) + centre
    elif cells.arrangement == "alternating":
        stem, nd = (ring + centre for ring in _alternating(cells.stem, scene))
    else:
        quarter = np.array([lx / 4, 0])
        stem = _cluster(cells.stem, scene) + centre - quarter
        nd = _cluster(cells.nd, scene) + centre + quarter

    everybody = np.concatenate([stem, nd]) if scene.has_cells else nobody
    _check_room(scene, everybody)
    return stem % [lx, ly], nd % [lx, ly]


def _ring(count: int, radius: float, turn: float = 0.0) -> Floats:
    angle = 2 * np.pi * (np.arange(count) + turn) / max(count, 1)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def _alternating(count: int, scene: Scene) -> tuple[Floats, Floats]:
    """One ring where there is room for all, else a zigzag of two rings 2 R_c apart."""
    radius, diameter = RING_RADIUS * scene.box_sides[0], 2 * scene.cells.radius
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
            raise SceneError(
                _does_not_fit(
                    scene, f"two would be {closest:.4g} apart, below 2 R_c = {diameter:g}"
                )
            )


def _does_not_fit(scene: Scene, why: str) -> str:
    cells = scene.cells
    lx, ly, _ = scene.box_sides
    return (
        f"cells.stem = {cells.stem} and cells.nd = {cells.nd}: do not fit in the arrangement "
        f"'{cells.arrangement}' on a membrane of {lx:.4g} x {ly:.4g}: {why}"
    )
