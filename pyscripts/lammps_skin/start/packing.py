"""Packing of the dermis between the wall and the membrane."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.engine.engine import open_lammps
from lammps_skin.errors import SceneError
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms
from lammps_skin.start import lattice

PACKING_STREAM = 103
# largest force component of a relaxed packing: that of overlaps is gone by then, and what is
# left is the spheres' attraction, which would contract the packing away from the wall
FORCE_TOLERANCE = 2e-2
MOST_DRAWS = 1000  # of all spheres, for those that are free
CLOSEST_PACKING = math.pi / math.sqrt(18)  # volume fraction of the densest one of hard spheres
HELD_ARE_NO_PAIRS = "neigh_modify exclude type 2 2"  # particles of the membrane


def dermal_count(scene: Scene, membrane: Floats | None = None) -> int:
    """Number of spheres between the wall and the membrane.

    A random packing has the scene's volume fraction. The membrane (m, 3) takes a layer of the
    thickness R_m. Without one, it is flat.
    """
    lx, ly, _ = scene.box_sides
    if scene.dermis.packing == "cubic":
        if membrane is not None:
            return len(_cubic(scene, membrane))
        room = scene.membrane_height - scene.membrane.radius
        return math.prod(_columns(scene)) * round(room / (2 * scene.dermis.radius))
    if membrane is None:
        volume = lx * ly * (scene.membrane_height - scene.membrane.radius)
    else:
        layer = scene.membrane.radius * surface(scene, membrane)
        volume = lx * ly * membrane[:, 2].mean() - layer
    sphere = 4 / 3 * math.pi * scene.dermis.radius**3
    return round(scene.dermis.volume_fraction * volume / sphere)


def surface(scene: Scene, membrane: Floats) -> float:
    """Area of the membrane (m, 3)."""
    one, two, three = membrane[lattice.triangles(scene.membrane.lattice).T]
    sides = np.array(scene.box_sides)
    edges = [side - np.round(side / sides) * sides for side in (two - one, three - one)]
    return float(np.linalg.norm(np.cross(*edges), axis=1).sum() / 2)


def pack_dermis(scene: Scene, membrane: Floats) -> Floats:
    """Relaxed centres (n, 3) of the dermal spheres under a membrane (m, 3) that is held.

    Uniform random centres, or those of a cubic packing under heights, are pushed apart by a soft
    potential. All are then relaxed in the true forces, by LAMMPS' minimiser, until the largest
    force component is below `FORCE_TOLERANCE`. The result depends on the membrane and, if it is
    random, on the scene's dermis seed alone.
    """
    is_flat = not np.ptp(membrane[:, 2])
    is_cubic = scene.dermis.packing == "cubic"
    count = dermal_count(scene, None if is_flat else membrane)
    spheres = _cubic(scene, membrane) if is_cubic else _drawn(scene, membrane, count)
    if not (is_cubic and is_flat):
        sheet = membrane[:0] if is_flat else membrane  # a wall is cheaper
        spheres = _minimized(scene, spheres, sheet, _pushing_apart(scene, is_flat))
    with tempfile.TemporaryDirectory() as folder:
        spheres = _minimized(scene, spheres, membrane, _relaxing(scene, Path(folder)))
    spheres[:, :2] %= scene.box_sides[:2]
    return spheres


def _columns(scene: Scene) -> tuple[int, int]:
    """Columns of a cubic packing along x and y: as many as fit side by side in the periodic box."""
    lx, ly, _ = scene.box_sides
    nx, ny = (math.floor(side / (2 * scene.dermis.radius) + 1e-9) for side in (lx, ly))
    return nx, ny


def _cubic(scene: Scene, membrane: Floats) -> Floats:
    """Centres (n, 3) of spheres in columns on a square lattice under the membrane (m, 3).

    Each column has the number of spheres with which their distance is next to 2 R_d. They are
    spread evenly between the wall and the membrane's lower side.
    """
    from scipy.spatial import cKDTree

    sides, columns = np.array(scene.box_sides[:2]), _columns(scene)
    places = (np.indices(columns).reshape(2, -1).T + 0.5) * sides / columns
    sheet = cKDTree(membrane[:, :2] % sides, boxsize=sides)
    room = membrane[sheet.query(places)[1], 2] - scene.membrane.radius
    layers = np.rint(room / (2 * scene.dermis.radius)).astype(int)
    layer = np.concatenate([np.arange(count) for count in layers])
    z = (layer + 0.5) * np.repeat(room / layers, layers)
    return np.column_stack([np.repeat(places, layers, axis=0), z])


def _drawn(scene: Scene, membrane: Floats, count: int) -> Floats:
    """Uniform random centres (n, 3) of spheres that touch neither the wall nor the membrane."""
    from scipy.spatial import cKDTree

    random = np.random.default_rng([scene.dermis_seed, PACKING_STREAM])
    sides = np.array(scene.box_sides)
    contact = scene.dermis.radius + scene.membrane.radius
    low = scene.dermis.radius
    high = membrane[:, 2].max() - scene.membrane.radius - scene.dermis.radius
    sheet = membrane % [*sides[:2], np.inf]
    seen_from_above = cKDTree(sheet[:, :2], boxsize=sides[:2])
    everywhere = cKDTree(sheet, boxsize=sides * [1, 1, 4])
    found = np.empty((0, 3))
    for _ in range(MOST_DRAWS):
        if len(found) >= count:
            return found[:count]
        drawn = random.random((count, 3)) * [*sides[:2], high - low] + [0, 0, low]
        below = drawn[:, 2] < sheet[seen_from_above.query(drawn[:, :2])[1], 2]
        free = everywhere.query(drawn)[0] >= contact
        found = np.concatenate([found, drawn[below & free]])
    raise SceneError(
        f"membrane.height = {scene.membrane_height:g}: leaves too little room below the heights "
        f"for {count:,} spheres of dermis.radius = {scene.dermis.radius:g}"
    )


def _minimized(scene: Scene, dermis: Floats, membrane: Floats, commands: str) -> Floats:
    """Centres (n, 3) of the spheres after commands of LAMMPS, under a membrane that is held."""
    engine = open_lammps(["-log", "none"])
    try:
        _set_up(engine, scene, dermis, membrane)
        engine.commands_string(commands)
        positions = np.array(engine.gather_atoms("x", 1, 3)).reshape(-1, 3)
    finally:
        engine.close()
    return np.asarray(positions[: len(dermis)])


def _set_up(engine: Any, scene: Scene, dermis: Floats, membrane: Floats) -> None:
    lx, ly, lz = scene.box_sides
    engine.commands_string(f"""
        units lj
        atom_style atomic
        atom_modify map array
        boundary p p f
        region box block 0 {lx:.17g} 0 {ly:.17g} 0 {lz:.17g}
        create_box 2 box
        mass * 1
        neighbor 0.3 bin
        neigh_modify every 1 delay 0 check yes
    """)
    x = np.concatenate([dermis, membrane])
    types = [1] * len(dermis) + [2] * len(membrane)
    engine.create_atoms(len(x), list(range(1, len(x) + 1)), types, x.ravel().tolist())
    engine.commands_string("""
        group dermis type 1
        group membrane type 2
        fix hold membrane setforce 0 0 0
    """)


def _pushing_apart(scene: Scene, is_flat: bool) -> str:
    """Soft repulsion of overlapping spheres between two harmonic walls.

    Under a membrane that is not flat, its particles push instead of the upper wall.

    Where overlaps must remain, it is a harmonic one: `soft` has no force between spheres at the
    same place, and would collect them there.
    """
    dermis = scene.dermis
    reach = f"{2 * dermis.radius:.17g}"
    contact = f"{dermis.radius + scene.membrane.radius:.17g}"
    if dermis.volume_fraction > CLOSEST_PACKING:
        style, stiffness, none = "harmonic/cut", 0.1, f"0.0 {reach}"
    else:
        style, stiffness, none = f"soft {reach}", 1.0, "0.0"
    walls = f"zlo 0 1 1 {dermis.radius:.17g}"
    above = f"{stiffness} {contact}"
    if is_flat:
        top = scene.membrane_height - scene.membrane.radius
        walls += f" zhi {top:.17g} 1 1 {dermis.radius:.17g}"
        above = none
    return f"""
        {HELD_ARE_NO_PAIRS}
        pair_style {style}
        pair_coeff 1 1 {stiffness} {reach}
        pair_coeff 1 2 {above}
        pair_coeff 2 2 {none}
        fix walls dermis wall/harmonic {walls}
        min_style cg
        min_modify norm max
        minimize 0 1e-3 500 5000
    """


def _relaxing(scene: Scene, folder: Path) -> str:
    """The scene's own dermal forces, with tables in a folder."""
    terms = Terms.of(scene)
    pairs = {term.name: term for term in terms.pairs}
    between, above = pairs["dermis_dermis"], pairs["dermis_membrane"]
    for term in (between, above):
        if term.table:
            term.table.write(folder / f"{term.name}.table")
    styles = {between.style.split()[0], above.style.split()[0]}
    first, second = ("", "") if len(styles) == 2 else ("1", "2")

    def coefficients(term: Any) -> str:
        return f"{folder}/{term.coefficients}" if term.table else str(term.coefficients)

    name, other = between.style.split()[0], above.style.split()[0]
    # the pair styles of the plugin list no pairs but their own, and must not look for exclusions
    exclusion = "" if scene.numerics.pair_form == "skin" else HELD_ARE_NO_PAIRS
    return f"""
        {exclusion}
        pair_style hybrid {between.style} {above.style}
        pair_coeff 1 1 {name} {first} {coefficients(between)}
        pair_coeff 1 2 {other} {second} {coefficients(above)}
        pair_coeff 2 2 none
        fix wall dermis wall/lj126 zlo 0 {terms.wall}
        min_style fire
        min_modify norm max
        timestep 0.05
        minimize 0 {FORCE_TOLERANCE} 1000 100000
    """
