"""Random states of small scenes, as configurations of LAMMPS and as states of the numpy model.

The states are crumpled or folded so that every branch of every term is met; the first dividing
pair straddles a corner of the periodic box.
"""

import itertools
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from unittest import mock

import numpy as np
import numpy_model
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.start import lattice
from lammps_skin.start.configuration import Configuration
from numpy_model import Floats, Ints, Parameters, State

LETTERS = {
    Kind.DERMAL: "D", Kind.MEMBRANE: "M", Kind.STEM: "S", Kind.TA: "T", Kind.EXHAUSTED: "T",
    Kind.ND: "N",
}  # fmt: skip

STIFFNESS = {
    "dermis_dermis": "dermis.stiffness",
    "dermis_membrane": "dermis.membrane_stiffness",
    "wall": "dermis.wall_stiffness",
    "stretch": "membrane.stretch_stiffness",
    "bend": "membrane.bending_stiffness",
    "membrane_exclusion": "membrane.exclusion_stiffness",
    "cell_membrane_exclusion": "cells.membrane_exclusion_stiffness",
    "adhesion": "cells.adhesion_stiffness",
    "binding": "cells.binding_stiffness",
    "cell_cell_exclusion": "cells.exclusion_stiffness",
    "cell_cell_adhesion": "cells.cell_adhesion_stiffness",
    "division": "cells.division_stiffness",
}
TERMS = tuple(STIFFNESS)
TABLES = ("dermis_dermis", "stretch", "cell_cell_adhesion")  # the terms that are always tables

# cells of a scene by kind and divisions left; a number is the separation of a daughter from
# the cell before it
Cells = list[tuple[Kind, int] | float]
S, T, X, N = Kind.STEM, Kind.TA, Kind.EXHAUSTED, Kind.ND
CELLS: dict[str, Cells] = {
    "quarter-nd-a": [
        (T, 6), 0.9, (T, 6), (S, 10), 0.03, (T, 10), (X, 0), 2.0, (X, 0),
        (T, 3), (T, 7), (T, 1), (S, 10), (X, 0), (T, 5), (N, 0), (N, 0),
    ],
    "no-dermis": [(T, 4), 1.5, (T, 4), (S, 10), 0.5, (T, 10), (S, 10), (T, 2), (X, 0), (X, 0)],
    "bare-membrane": [],
    "two-cells": [(S, 10), (S, 10)],
    "one-stem": [(S, 10), 1.2, (T, 10)],
}  # fmt: skip
SCENES = tuple(CELLS)


def small_scene(name: str, parameters: str = "papilla", **changes: object) -> Scene:
    """Return a built-in scene on a membrane of 7 x 7, its keys given with __ for the dot."""
    small = {
        "membrane.lattice": [14, 16], "membrane.height": 8.0, "box_height": 40.0,
        "output.dump_interval": 0.0, "output.checkpoint_interval": 0.0,
        "numerics.table_points": 30_000, "numerics.accuracy": "reference",
    }  # fmt: skip
    changes = {key.replace("__", "."): value for key, value in changes.items()}
    return Scene.load(name).replace(parameters=parameters, **(small | changes))


def alone(scene: Scene, term: str) -> Scene:
    """Return the scene with the stiffness of all other terms 0."""
    return scene.replace(**{key: 0.0 for name, key in STIFFNESS.items() if name != term})


# ---- states ----


def shortest(vectors: Floats, box: Floats) -> Floats:
    """Return the shortest periodic equivalents of vectors (n, 3)."""
    return vectors - np.round(vectors / [*box[:2], np.inf]) * [*box[:2], 0.0]


def distances(places: Floats, place: Floats, box: Floats) -> Floats:
    """Return the distances (n,) of places from one place."""
    return np.linalg.norm(shortest(places - place, box), axis=1)


def membrane(scene: Scene, shape: str, rng: np.random.Generator) -> Floats:
    """Return a crumpled or folded membrane with links beyond 2 R_m and close pairs."""
    nx, ny = scene.membrane.lattice
    box, spacing = np.array(scene.box_sides), scene.spacing
    sheet = lattice.positions((nx, ny), spacing, scene.membrane_height)
    turn = 2 * np.pi / box[:2]
    if shape == "folded":  # an S: its middle layer runs backwards
        u = turn[0] * sheet[:, 0]
        sheet[:, 2] += 0.25 * box[0] * np.sin(u)
        sheet[:, 0] -= 0.33 * box[0] * np.sin(u)
    else:
        waves = np.sin(turn[0] * sheet[:, 0]) + np.cos(2 * turn[1] * sheet[:, 1])
        sheet[:, 2] += 0.2 * waves
    sheet += 0.08 * spacing * rng.normal(size=sheet.shape)

    # a spike whose longest link is 1.09 (2 R_m), and two pairs of second neighbours too close
    spike = 6 * nx + nx // 2
    links, _ = lattice.links_and_hinges((nx, ny))
    ring = links[(links == spike).any(axis=1)].sum(axis=1) - spike
    x, y, z = shortest(sheet[ring] - sheet[spike], box).T
    sheet[spike, 2] += np.min(z + np.sqrt((2.18 * scene.membrane.radius) ** 2 - x**2 - y**2))
    for one, apart in ((10 * nx + nx // 4, 0.76), (1 * nx + nx // 3, 0.85)):
        gap = sheet[one + 2 * nx] - sheet[one]
        inward = (0.5 - 0.5 * apart * spacing / np.linalg.norm(gap)) * gap
        sheet[one] += inward
        sheet[one + 2 * nx] -= inward
    return sheet


def dermis(scene: Scene, sheet: Floats, rng: np.random.Generator, count: int) -> Floats:
    """Return overlapping dermal spheres between the wall and the membrane."""
    box, radius = np.array(scene.box_sides), scene.dermis.radius
    contact = radius + scene.membrane.radius
    places = np.empty((0, 3))
    for place in rng.random((20_000, 3)) * [*box[:2], scene.membrane_height]:
        room = distances(sheet, place, box).min() > 0.7 * contact and place[2] > 0.5 * radius
        if room and np.all(distances(places, place, box) > 0.8 * radius):
            places = np.vstack([places, place])
        if len(places) == count:
            return places
    raise AssertionError(f"no room for {count} dermal spheres")


def cells(
    scene: Scene, sheet: Floats, rng: np.random.Generator, given: Cells, apart: float
) -> tuple[Floats, list[tuple[int, int]]]:
    """Return places of cells around the membrane, at least `apart` (in 2 R_c), and the pairs.

    Mothers and single cells are by turns in contact, within the range of adhesion, and beyond it.
    """
    box, contact, reach = np.array(scene.box_sides), scene.contact, scene.cells.adhesion_range
    bands = itertools.cycle([(1.0, reach), (0.75, 1.0), (1.0, reach), (reach, 1.5)])
    places, pairs = np.empty((0, 3)), []
    separation = None
    for item in given:
        if isinstance(item, float):
            separation = item
            continue
        low, high = (0.75, 1.5) if separation else next(bands)
        for _ in range(20_000):
            direction = rng.normal(size=3)
            direction /= np.linalg.norm(direction)
            if separation is None:
                near = sheet[rng.integers(len(sheet))]
                place, others = near + rng.uniform(0.8, 1.5) * contact * direction, places
            else:
                place, others = places[-1] + separation * direction, places[:-1]
            x = distances(sheet, place, box).min() / contact
            free = np.all(distances(others, place, box) > 2 * apart * scene.cells.radius)
            if free and low < x < high:
                break
        else:
            raise AssertionError(f"no room for cell {len(places)}")
        if separation is not None:
            pairs.append((len(places) - 1, len(places)))
        places, separation = np.vstack([places, place]), None
    return places, pairs


@dataclass
class Prepared:
    """The same state for LAMMPS and for the numpy model."""

    scene: Scene
    configuration: Configuration
    state: State


def prepare(
    scene: Scene, shape: str, seed: int = 1, given: Cells | None = None, apart: float = 0.62
) -> Prepared:
    """Return a random state of a scene, by default with the cells that go with its name."""
    rng = np.random.default_rng(seed)
    box = np.array(scene.box_sides)
    sheet = membrane(scene, shape, rng)
    below = dermis(scene, sheet, rng, round(0.3 * box[0] * box[1])) if scene.dermis.present else []
    given = CELLS[scene.name] if given is None else given
    places, pairs = cells(scene, sheet, rng, given, apart)
    who = [item for item in given if not isinstance(item, float)]
    kinds = [Kind.MEMBRANE] * len(sheet) + [Kind.DERMAL] * len(below) + [kind for kind, _ in who]
    positions = np.vstack([sheet, np.reshape(below, (-1, 3)), places])
    first = len(sheet) + len(below)
    if pairs:
        positions[:, :2] -= (places[pairs[0][0]] + places[pairs[0][1]])[:2] / 2

    links, hinges = lattice.links_and_hinges(scene.membrane.lattice)
    left = np.array([0] * first + [m for _, m in who])
    configuration = Configuration(
        box, np.array(kinds, int), positions, links, hinges, divisions_left=left, time=37.3
    )
    own_links, _, own_hinges = numpy_model.triangular_lattice(*scene.membrane.lattice)
    letters = np.array([LETTERS[kind] for kind in kinds])
    state = State(letters, positions, (box[0], box[1]), left, own_links, own_hinges)
    for (i, j), age in zip(pairs, rng.uniform(2.0, 6.5, len(pairs)), strict=True):
        i, j = i + first, j + first
        configuration.pair[[i, j]] = j + 1, i + 1
        configuration.pair_start[[i, j]] = configuration.time - age
        state.pairs.append((i, j, natural_length(scene, age)))
    return Prepared(scene, configuration, state)


def natural_length(scene: Scene, age: float) -> float:
    """Return the natural length of a division spring of this age, as the model describes it."""
    cells = scene.cells
    if cells.division_spring == "reduced":
        return 2 * cells.radius * cells.division_rate * age
    return 2 * cells.division_separation * cells.radius + cells.division_rate * age


@cache
def prepared(name: str, parameters: str, shape: str) -> Prepared:
    """Return a random state of a built-in scene on a small membrane."""
    return prepare(small_scene(name, parameters), shape)


# ---- what the numpy model says ----


def parameters_of(scene: Scene, term: str = "wall") -> Parameters:
    """Return the numpy model's parameters of a scene; Kex is that of one term."""
    d, m, c = scene.dermis, scene.membrane, scene.cells
    exclusion = {
        "wall": d.wall_stiffness,
        "membrane_exclusion": m.exclusion_stiffness,
        "cell_membrane_exclusion": c.membrane_exclusion_stiffness,
        "cell_cell_exclusion": c.exclusion_stiffness,
    }
    return Parameters(
        R_d=d.radius, R_m=m.radius, R_c=c.radius, Kdm=d.membrane_stiffness, Kdd=d.stiffness,
        Kex=exclusion.get(term, 0.0), Kstr=m.stretch_stiffness, Kbend=m.bending_stiffness,
        bending_form=m.bending_form,
        Kad=c.adhesion_stiffness, Kbind=c.binding_stiffness, Kcc=c.cell_adhesion_stiffness,
        Kdiv=c.division_stiffness, d1=d.softening_onset, d2=m.spacing_ratio,
        Lambda=d.attraction_range, lam=c.adhesion_range, a1=d.softening, a2=m.elasticity,
        force_scale=scene.force_scale, division_spring=c.division_spring,
    )  # fmt: skip


@dataclass
class Expected:
    """Energy, forces (n, 3) and gross forces (n,) of each term.

    The gross force on a particle is the sum of the magnitudes of all contributions to its
    force, the measure of what rounding and tables may do to it.
    """

    energies: dict[str, float]
    forces: dict[str, Floats]
    gross: dict[str, Floats]


def _magnitudes(state: State, i: Ints, j: Ints, vectors: Floats, slopes: Floats) -> Floats:
    """Stand in for the numpy model's sum of central forces: add magnitudes, in one column."""
    gross = np.zeros_like(state.positions)
    np.add.at(gross[:, 0], i, np.abs(slopes))
    np.add.at(gross[:, 0], j, np.abs(slopes))
    return gross


def expected(scene: Scene, state: State) -> Expected:
    """Return what the numpy model says; the four exclusions have each their own stiffness."""
    energies, forces, gross = {}, {}, {}
    unit = replace(parameters_of(scene), Kex=1.0)
    all_energies, all_forces = numpy_model.energies_and_forces(state, unit)
    with mock.patch.object(numpy_model, "_central", _magnitudes):
        _, all_gross = numpy_model.energies_and_forces(state, unit)
    for term in all_energies:
        k = parameters_of(scene, term).Kex if "exclusion" in term or term == "wall" else 1.0
        energies[term], forces[term] = k * all_energies[term], k * all_forces[term]
        gross[term] = k * np.linalg.norm(all_gross[term], axis=1)
    # bending is no sum of central forces: its unit is the mean force
    gross["bend"] += gross["bend"].mean()
    return Expected(energies, forces, gross)


def force_tolerance(want: Expected, terms: Iterable[str], analytic: float, table: float) -> Floats:
    """Return the allowed error (n,) of the force that some terms together make."""
    return sum((table if term in TABLES else analytic) * want.gross[term] for term in terms)


def assert_forces(got: Floats, want: Floats, tolerance: Floats) -> None:
    """Compare forces (n, 3) particle by particle, but for rounding of numbers of order 1."""
    error, tolerance = np.linalg.norm(got - want, axis=1), tolerance + 1e-14
    worst = np.argmax(error - tolerance)
    assert np.all(error <= tolerance), (
        f"particle {worst}: force {got[worst]}, expected {want[worst]}, "
        f"error {error[worst]:.3g}, allowed {tolerance[worst]:.3g}"
    )
