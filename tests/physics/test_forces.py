"""Every energy and force that LAMMPS computes, against the numpy model and finite differences."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from lammps_skin.model import potentials
from lammps_skin.model.tables import Table
from lammps_skin.model.terms import Terms, stretch_table
from lammps_skin.run.simulation import Simulation
from model_states import (
    CELLS,
    SCENES,
    STIFFNESS,
    TABLES,
    TERMS,
    Prepared,
    alone,
    assert_forces,
    distances,
    expected,
    force_tolerance,
    natural_length,
    prepare,
    prepared,
    small_scene,
)
from numpy_model import Floats, nearest_membrane

FULL = "quarter-nd-a"
SHAPES = ("crumpled", "folded")
SETS = ("printed", "papilla", "weak5", "direct5")
ANALYTIC, TABLE = 1e-9, 1e-5  # relative errors
CASES = (
    ("crumpled", "papilla"), ("folded", "direct5"),
    pytest.param("folded", "printed", marks=pytest.mark.slow),
)  # fmt: skip
LENNARD_JONES = (
    "dermis_membrane", "membrane_exclusion", "cell_membrane_exclusion", "cell_cell_exclusion",
)  # fmt: skip


def assert_energies(got: dict[str, float], want: dict[str, float]) -> None:
    """Compare energies term by term."""
    assert set(got) == set(TERMS)
    for term in TERMS:
        tolerance = TABLE if term in TABLES else ANALYTIC
        assert got[term] == pytest.approx(want[term], rel=tolerance, abs=0), term


# ---- the states are what they should be ----


@pytest.mark.parametrize("shape", SHAPES)
def test_states_meet_every_branch(shape: str) -> None:
    """The full scene has every term, and particles on both sides of every bend of its formulas."""
    full = prepared(FULL, "papilla", shape)
    box, state = full.configuration.box, full.state
    want = expected(full.scene, state)
    for term in TERMS:
        assert np.linalg.norm(want.forces[term], axis=1).max() > 1e-3, term

    i, j = state.links.T
    lengths = np.linalg.norm(state.minimum_image(state.positions[j] - state.positions[i]), axis=1)
    assert lengths.min() < 0.5 < 2.0 < lengths.max() < 2.5
    dermis = state.positions[state.where("D")]
    x = np.concatenate([distances(dermis[:n], r, box) for n, r in enumerate(dermis)]) / 2.8
    assert all(np.sum((x > low) & (x < high)) > 3 for low, high in ((0, 0.8), (0.8, 1), (1, 1.4)))

    x = nearest_membrane(state)[1] / full.scene.contact
    kinds = state.kinds[state.where("TSN")]
    left = state.divisions_left[state.where("TSN")]
    adhering, exhausted = (kinds == "T") & (left > 0), (kinds == "T") & (left == 0)
    assert np.any(x[adhering] < 1)
    assert np.any((x[adhering] > 1) & (x[adhering] < 1.2))
    assert np.any(x[adhering] > 1.2)
    assert np.any(x[exhausted] > 1)
    assert np.any(x[kinds == "S"] > 1)
    assert np.any(x[kinds == "N"] > 1)

    # the first dividing pair is on both sides of both edges
    wrapped = full.configuration.wrapped()
    a, b, _ = state.pairs[0]
    assert np.all(np.abs(wrapped[a] - wrapped[b])[:2] > box[:2] / 2)
    assert len(state.pairs) == 3


def test_folded_membrane_runs_backwards() -> None:
    """A line upwards through the middle of the fold meets the membrane three times."""
    folded = prepared(FULL, "papilla", "folded")
    (i, j), x = folded.state.links.T, folded.state.positions
    row = (i // 14 == 3) & (j // 14 == 3)
    steps = folded.state.minimum_image(x[j[row]] - x[i[row]])[:, 0]
    assert np.sum(steps < -0.2) >= 3


# ---- all terms together ----


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        *product(SCENES, ("papilla",)),
        *((FULL, name) for name in ("direct5", "printed", "weak5", "earlier")),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in product(SCENES, ("direct5", "printed")) if case[0] != FULL
        ),
    ],
)  # fmt: skip
def test_scene(name: str, parameters: str, shape: str) -> None:
    """Energies by term, total forces and nearest membrane particles of every kind of scene."""
    case = prepared(name, parameters, shape)
    want = expected(case.scene, case.state)
    with Simulation.begin(case.scene, configuration=case.configuration) as simulation:
        energies, forces = simulation.energies(), simulation.forces()
        cells = simulation.cells()
    assert_energies(energies, want.energies)
    np.testing.assert_array_equal(forces.types, case.configuration.kinds)
    total = np.sum(list(want.forces.values()), axis=0)
    assert_forces(forces.forces, total, force_tolerance(want, TERMS, ANALYTIC, TABLE))
    if CELLS[name]:
        partner, distance = nearest_membrane(case.state)
        np.testing.assert_array_equal(cells.partner - 1, partner)
        np.testing.assert_allclose(cells.distance, distance, rtol=1e-12)


ODD_NUMBERS = {
    "dermis.radius": 1.21, "dermis.stiffness": 0.051, "dermis.membrane_stiffness": 0.033,
    "dermis.wall_stiffness": 0.062, "dermis.attraction_range": 1.31, "dermis.softening": 0.17,
    "dermis.softening_onset": 0.71, "membrane.radius": 0.93, "membrane.spacing_ratio": 0.28,
    "membrane.stretch_stiffness": 0.047, "membrane.elasticity": 1.07,
    "membrane.bending_stiffness": 0.61, "membrane.exclusion_stiffness": 0.037,
    "cells.radius": 1.47, "cells.exclusion_stiffness": 0.043,
    "cells.membrane_exclusion_stiffness": 0.029, "cells.cell_adhesion_stiffness": 0.21,
    "cells.adhesion_stiffness": 17.0, "cells.adhesion_range": 1.27,
    "cells.binding_stiffness": 13.0, "cells.division_stiffness": 3.3,
    "cells.division_rate": 0.11, "cells.division_separation": 0.013,
}  # fmt: skip


@pytest.mark.parametrize(("force_scale", "spring"), [("printed", "reduced"), ("direct", "length")])
def test_no_number_is_built_in(force_scale: str, spring: str) -> None:
    """All radii, stiffnesses, ranges and rates come from the scene."""
    words = {"force_scale": force_scale, "cells.division_spring": spring}
    case = prepare(small_scene(FULL, **ODD_NUMBERS, **words), "crumpled")
    want = expected(case.scene, case.state)
    assert all(want.energies.values())
    with Simulation.begin(case.scene, configuration=case.configuration) as simulation:
        energies, forces = simulation.energies(), simulation.forces()
    assert_energies(energies, want.energies)
    total = np.sum(list(want.forces.values()), axis=0)
    assert_forces(forces.forces, total, force_tolerance(want, TERMS, ANALYTIC, TABLE))


@pytest.mark.parametrize(
    ("parallel", "shape"), [({"ranks": 2}, "crumpled"), ({"threads": 2}, "folded")]
)
def test_ranks_and_threads(parallel: dict[str, int], shape: str) -> None:
    """Two ranks and two threads give what one gives, but for the order of sums."""
    case = prepared(FULL, "papilla", shape)
    want = expected(case.scene, case.state)
    results = []
    for how in ({}, parallel):
        with Simulation.begin(case.scene, configuration=case.configuration, **how) as simulation:
            results.append((simulation.energies(), simulation.forces(), simulation.cells()))
    (one_energies, one_forces, one_cells), (energies, forces, cells) = results
    assert energies == pytest.approx(one_energies, rel=1e-12, abs=0)
    np.testing.assert_array_equal(forces.ids, one_forces.ids)
    tolerance = force_tolerance(want, TERMS, 1e-12, 1e-12)
    assert_forces(forces.forces, one_forces.forces, tolerance)
    np.testing.assert_array_equal(cells.partner, one_cells.partner)


def test_after_a_run() -> None:
    """Forces are right after a run too, with neighbor builds and removals behind it."""
    scene = small_scene(FULL, numerics__timestep=2e-4, numerics__neighbor_skin=0.2)
    case = prepare(scene, "crumpled")
    case.configuration.next_division[:] = 1e6
    age = case.configuration.time - case.configuration.pair_start
    with Simulation.begin(scene, configuration=case.configuration) as simulation:
        simulation.run(until=case.configuration.time + 1.0)
        energies, forces, cells = (
            simulation.energies(), simulation.forces(), simulation.cells(),
        )  # fmt: skip
    assert len(forces.ids) < len(case.state.kinds)
    left = forces.ids - 1
    moved = case.state.minimum_image(forces.positions - case.state.positions[left])
    assert np.sum(np.linalg.norm(moved, axis=1) > 0.3) > 10
    n = {int(identity): place for place, identity in enumerate(forces.ids)}
    pairs = [
        (n[int(i)], n[int(j)], natural_length(scene, age[i - 1] + 1.0))
        for i, j in zip(cells.ids, cells.pair, strict=True)
        if i < j
    ]
    assert len(pairs) == 3
    state = replace(
        case.state, kinds=case.state.kinds[left], positions=forces.positions, pairs=pairs,
        divisions_left=case.state.divisions_left[left],
    )  # fmt: skip
    want = expected(scene, state)
    assert_energies(energies, want.energies)
    total = np.sum(list(want.forces.values()), axis=0)
    assert_forces(forces.forces, total, force_tolerance(want, TERMS, ANALYTIC, TABLE))


# ---- each term alone ----


@dataclass
class Alone:
    """What LAMMPS computes of one term, all other stiffnesses being 0.

    `slopes` are (force along a direction, minus the difference quotient of the energy along it,
    magnitude of the particle's force) at a few particles where the force is large.
    """

    energies: dict[str, float]
    forces: Floats
    slopes: list[tuple[float, float, float]]


@cache
def lammps_alone(term: str, shape: str, parameters: str) -> Alone:
    """Return energies, forces and difference quotients of one term in the full scene."""
    case = prepared(FULL, parameters, shape)
    points = 100_000 if term in TABLES else 100
    scene = alone(case.scene, term).replace(**{"numerics.table_points": points})
    with Simulation.begin(scene, configuration=case.configuration) as simulation:
        energies, forces = simulation.energies(), simulation.forces()
        slopes = list(difference_quotients(simulation, term))
    return Alone(energies, forces.forces, slopes)


def difference_quotients(simulation: Simulation, term: str) -> Iterator[tuple[float, float, float]]:
    """Yield `Alone.slopes` of the particles with the largest force and of one with a median."""
    ids, _, positions, forces = simulation.forces()
    sizes = np.linalg.norm(forces, axis=1)
    moved = np.argsort(sizes)[-np.count_nonzero(sizes) :]
    rng = np.random.default_rng(7)
    # tables have a linear energy between their points: the step must be long against these
    step = 1e-3 if term in TABLES else 2e-4
    for n in moved[[-1, -2, -3, len(moved) // 2]]:
        across = rng.normal(size=3)
        for direction in (forces[n] / sizes[n], across / np.linalg.norm(across)):
            slope = difference_quotient(simulation, term, ids[n], positions[n], direction, step)
            yield float(forces[n] @ direction), -slope, sizes[n]


def difference_quotient(
    simulation: Simulation, term: str, identity: int, place: Floats, direction: Floats, step: float
) -> float:
    """Return the slope of a term's energy along a direction, by central differences, O(step^4)."""
    total = 0.0
    for shift, weight in ((-2, 1), (-1, -8), (1, 8), (2, -1), (0, 0)):
        x, y, z = place + shift * step * direction
        simulation.command(f"set atom {identity} x {x:.17g} y {y:.17g} z {z:.17g}")
        simulation.command("run 0 post no")
        total += weight * simulation.energies()[term]
    return total / (12 * step)


@pytest.mark.parametrize(("shape", "parameters"), CASES)
@pytest.mark.parametrize("term", TERMS)
def test_term_alone(term: str, shape: str, parameters: str) -> None:
    """A term's energy and forces, particle by particle; nothing of any other term is left."""
    got = lammps_alone(term, shape, parameters)
    case = prepared(FULL, parameters, shape)
    want = expected(case.scene, case.state)
    tolerance = TABLE if term in TABLES else ANALYTIC
    assert got.energies.pop(term) == pytest.approx(want.energies[term], rel=tolerance, abs=0)
    assert set(got.energies.values()) == {0.0}
    assert_forces(got.forces, want.forces[term], tolerance * want.gross[term])


@pytest.mark.parametrize(("shape", "parameters"), CASES)
@pytest.mark.parametrize("term", TERMS)
def test_force_is_gradient(term: str, shape: str, parameters: str) -> None:
    """A term's forces are minus the central differences of its energy, both from LAMMPS."""
    slopes = np.array(lammps_alone(term, shape, parameters).slopes)
    assert len(slopes) == 8
    assert slopes[:, 2].min() > 1e-4
    force, quotient, size = slopes.T
    tolerance = TABLE if term in TABLES else 1e-6
    np.testing.assert_array_less(np.abs(quotient - force), tolerance * size)


@pytest.mark.parametrize(("shape", "parameters"), CASES)
@pytest.mark.parametrize("term", TERMS)
def test_momentum(term: str, shape: str, parameters: str) -> None:
    """The forces of a term add up to nothing, those of the wall to a push upwards."""
    forces = lammps_alone(term, shape, parameters).forces
    x, y, z = forces.sum(axis=0)
    assert np.abs(forces).max() > 1e-3
    assert max(abs(x), abs(y)) < 1e-10
    assert z > 1 if term == "wall" else abs(z) < 1e-10


# ---- tables ----


def tables(case: Prepared, **changes: object) -> dict[str, Table]:
    """Return the tables of a scene by term."""
    scene = case.scene.replace(**changes)
    return Terms.of(scene).tables | {"stretch": stretch_table(scene)}


@pytest.mark.parametrize("force_scale", ["printed", "direct"])
def test_table_of_links_has_the_coefficients_of_the_style(force_scale: str) -> None:
    scene = small_scene(FULL, force_scale=force_scale)
    stiffness, contact, *shape = map(float, Terms.of(scene).stretch.coefficients.split())
    table = stretch_table(scene)
    r = table.distances
    u = stiffness * potentials.stretch(r / contact, *shape)
    slope = stiffness / contact * potentials.stretch_slope(r / contact, *shape)
    np.testing.assert_allclose(table.energy(r), u, rtol=1e-12)
    np.testing.assert_allclose(table.force(r), -slope, rtol=1e-12)


@pytest.mark.parametrize("style", ["linear", "spline"])
@pytest.mark.parametrize("term", [*LENNARD_JONES, *TABLES])
def test_default_tables(term: str, style: str) -> None:
    """With as many points as by default a table is as exact as it states.

    The statement is relative to the force of a pair or link, or to the median of the table.
    """
    case = prepared(FULL, "papilla", "crumpled")
    want = expected(case.scene, case.state)
    numerics = {
        "numerics.pair_form": "table", "numerics.table_style": style,
        "numerics.table_points": 10_000,
    }  # fmt: skip
    table = tables(case, **numerics)[term]
    inside = np.abs(table.force(table.distances))
    stated, median = table.interpolation_error(), np.median(inside[inside > 0])
    assert 0 < stated < 2e-3
    scene = alone(case.scene, term).replace(**numerics)
    with Simulation.begin(scene, configuration=case.configuration) as simulation:
        energies, forces = simulation.energies(), simulation.forces()
    assert energies[term] == pytest.approx(want.energies[term], rel=TABLE, abs=0)
    assert_forces(forces.forces, want.forces[term], stated * (want.gross[term] + median))


def test_tables_replace_the_analytic_forms() -> None:
    """`pair_form` decides which terms are tables."""
    case = prepared(FULL, "papilla", "crumpled")
    assert set(tables(case)) == set(TABLES)
    assert set(tables(case, **{"numerics.pair_form": "table"})) == {*TABLES, *LENNARD_JONES}
    assert set(STIFFNESS) == {*TABLES, *LENNARD_JONES, "wall", "bend", "adhesion", "binding",
                              "division"}  # fmt: skip


@pytest.mark.parametrize(
    ("term", "contact", "reach", "slope"),
    [
        ("dermis_dermis", 2.8, 1.4, 1.4**-7 - 1.4**-13),
        ("dermis_membrane", 2.4, 1.4, 1.4**-7 - 1.4**-13),
    ],
)
def test_last_point_is_inside(term: str, contact: float, reach: float, slope: float) -> None:
    """Where a force jumps to 0, at the end of its table, the last point is the inside's."""
    table = tables(prepared(FULL, "papilla", "crumpled"), **{"numerics.pair_form": "table"})[term]
    assert table.outer == pytest.approx(contact * reach, rel=1e-12)
    last = table.force(table.distances[-1:])[0]
    assert last == pytest.approx(-0.04 * slope / contact, rel=1e-9)


def test_terms_are_worked_out_once() -> None:
    scene = small_scene(FULL)
    assert Terms.of(scene) is Terms.of(scene.replace())
    assert Terms.of(scene) is not Terms.of(scene.replace(**{"membrane.elasticity": 1.3}))
