"""Random packing of the dermis between the wall and the flat membrane."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.engine.engine import open_lammps
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms

PACKING_STREAM = 103
# largest force component of a relaxed packing: that of overlaps is gone by then, and what is
# left is the spheres' attraction, which would contract the packing away from the wall
FORCE_TOLERANCE = 2e-2
# volume fraction of the densest packing of hard spheres
CLOSEST_PACKING = math.pi / math.sqrt(18)


def dermal_count(scene: Scene) -> int:
    """Number of spheres at the scene's volume fraction between the wall and the membrane."""
    lx, ly, _ = scene.box_sides
    thickness = scene.membrane_height - scene.membrane.radius
    sphere = 4 / 3 * math.pi * scene.dermis.radius**3
    return round(scene.dermis.volume_fraction * lx * ly * thickness / sphere)


def pack_dermis(scene: Scene, membrane: Floats) -> Floats:
    """Relaxed centres (n, 3) of the dermal spheres under a flat membrane (m, 3) that is held.

    Uniform random centres are pushed apart by a soft potential and then relaxed in the true
    forces, by LAMMPS' minimiser, until the largest force component is below `FORCE_TOLERANCE`.
    The result depends on the scene's dermis seed alone.
    """
    random = np.random.default_rng([scene.dermis_seed, PACKING_STREAM])
    count, radius = dermal_count(scene), scene.dermis.radius
    low, high = radius, scene.membrane_height - scene.membrane.radius - radius
    lx, ly, _ = scene.box_sides
    start = random.random((count, 3)) * [lx, ly, high - low] + [0, 0, low]

    with tempfile.TemporaryDirectory() as folder:
        engine = open_lammps(["-log", "none"])
        try:
            _set_up(engine, scene, start, membrane)
            _push_apart(engine, scene)
            _relax(engine, scene, Path(folder))
            positions = np.array(engine.gather_atoms("x", 1, 3)).reshape(-1, 3)[:count]
        finally:
            engine.close()
    positions[:, :2] %= [lx, ly]
    return np.asarray(positions)


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
        neigh_modify exclude type 2 2
    """)


def _push_apart(engine: Any, scene: Scene) -> None:
    """Soft repulsion of overlapping spheres between two harmonic walls.

    Where overlaps must remain, it is a harmonic one: `soft` has no force between spheres at the
    same place, and would collect them there.
    """
    dermis = scene.dermis
    reach = f"{2 * dermis.radius:.17g}"
    if dermis.volume_fraction > CLOSEST_PACKING:
        style, apart, none = "harmonic/cut", f"0.1 {reach}", f"0.0 {reach}"
    else:
        style, apart, none = f"soft {reach}", "1.0", "0.0"
    top = scene.membrane_height - scene.membrane.radius
    walls = f"zlo 0 1 1 {dermis.radius:.17g} zhi {top:.17g} 1 1 {dermis.radius:.17g}"
    engine.commands_string(f"""
        pair_style {style}
        pair_coeff 1 1 {apart}
        pair_coeff * 2 {none}
        fix walls dermis wall/harmonic {walls}
        min_style cg
        min_modify norm max
        minimize 0 1e-3 500 5000
        unfix walls
    """)


def _relax(engine: Any, scene: Scene, folder: Path) -> None:
    """The scene's own dermal forces."""
    terms = Terms(scene)
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
    engine.commands_string(f"""
        pair_style hybrid {between.style} {above.style}
        pair_coeff 1 1 {name} {first} {coefficients(between)}
        pair_coeff 1 2 {other} {second} {coefficients(above)}
        pair_coeff 2 2 none
        fix wall dermis wall/lj126 zlo 0 {terms.wall}
        min_style fire
        min_modify norm max
        timestep 0.05
        minimize 0 {FORCE_TOLERANCE} 1000 100000
    """)
