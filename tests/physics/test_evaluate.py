"""Single-point evaluation of text files, against the reference files and the numpy model."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.engine.engine import Forces
from lammps_skin.kinds import Kind
from lammps_skin.model import terms
from lammps_skin.model.parameters import SETS
from lammps_skin.model.scene import Scene
from lammps_skin.run.evaluate import SHORT, Evaluation, evaluate
from model_states import (
    TABLES,
    TERMS,
    Cells,
    Prepared,
    assert_forces,
    expected,
    force_tolerance,
    parameters_of,
    prepare,
    small_scene,
)
from numpy_model import Floats, State, named, nearest_membrane, read_configuration

REFERENCE = Path(__file__).resolve().parent / "reference"
SMALL = REFERENCE / "small.txt"
REFERENCE_SETS: dict[str, tuple[str, dict[str, Any]]] = {
    "V1paperdiv": ("printed", {}),
    "V1_lam1.4_Kad25": ("printed", {"cells.division_spring": "length"}),
    "V1_lam1.2_Kad25": ("papilla", {}),
    "V2_lam1.4_Kad5": ("direct5", {}),
    "V2_lam1.2_Kad5": ("earlier", {}),
}
NO_TABLES = {
    "dermis.stiffness": 0.0,
    "membrane.stretch_stiffness": 0.0,
    "cells.cell_adhesion_stiffness": 0.0,
}
ANALYTIC, TABLE = 1e-9, 1e-5


def parse(text: str) -> tuple[dict[str, float], list[str], Floats, dict[int, tuple[int, float]]]:
    """Return energies, kinds, forces and nearest membrane particles of the output format."""
    energies: dict[str, float] = {}
    kinds: list[str] = []
    forces, nearest = [], {}
    for line in text.splitlines():
        words = line.split()
        if words[:2] == ["#", "E"]:
            energies[words[2]] = float(words[3])
        elif words[0] != "#":
            assert int(words[0]) == len(kinds)
            if len(words) > 5:
                nearest[len(kinds)] = int(words[5]), float(words[6])
            kinds.append(words[1])
            forces.append([float(word) for word in words[2:5]])
    return energies, kinds, np.array(forces), nearest


def assert_agrees(got: Evaluation, state: State, analytic: float = ANALYTIC) -> None:
    """Compare an evaluation with the numpy model, in every term, force and nearest particle."""
    want = expected(got.scene, state)
    for term in TERMS:
        tolerance = TABLE if term in TABLES else analytic
        assert got.energies[term] == pytest.approx(want.energies[term], rel=tolerance, abs=0), term
    total = np.sum(list(want.forces.values()), axis=0)
    assert_forces(got.forces.forces, total, force_tolerance(want, TERMS, analytic, TABLE))
    cells = state.where("TSN")
    partner, distance = nearest_membrane(state)
    assert list(got.partner) == cells.tolist()
    assert [near for near, _ in got.partner.values()] == partner.tolist()
    np.testing.assert_allclose([d for _, d in got.partner.values()], distance, rtol=1e-12)


# ---- the reference files ----


@pytest.mark.parametrize("name", REFERENCE_SETS)
def test_reference(name: str) -> None:
    """Energies, forces and nearest particles, as the output prints them, are the reference's."""
    got = evaluate(SMALL, *REFERENCE_SETS[name])
    energies, kinds, forces, nearest = parse("\n".join(got.lines()))
    their = parse((REFERENCE / f"small_{name}.forces").read_text())
    assert set(energies) == set(their[0]) == {*SHORT, "cc_ad", "cc_ad_shifted", "total"}
    for short, energy in their[0].items():
        tolerance = TABLE if short in ("dd", "str", "cc_ad", "cc_ad_shifted", "total") else ANALYTIC
        assert energies[short] == pytest.approx(energy, rel=tolerance, abs=1e-15), short
    assert kinds == their[1]
    want = expected(got.scene, read_configuration(SMALL))
    assert_forces(forces, their[2], force_tolerance(want, TERMS, ANALYTIC, TABLE))
    assert {n: near for n, (near, _) in nearest.items()} == {
        n: near for n, (near, _) in their[3].items()
    }
    for n, (_, distance) in their[3].items():
        assert nearest[n][1] == pytest.approx(distance, abs=1e-9)


@pytest.mark.parametrize("name", REFERENCE_SETS)
def test_reference_in_the_styles_of_the_plugin(name: str) -> None:
    """No term is a table: all energies and forces are the reference's."""
    parameters, changes = REFERENCE_SETS[name]
    got = evaluate(SMALL, parameters, {**changes, "numerics.pair_form": "skin"})
    energies, _, forces, _ = parse("\n".join(got.lines()))
    their = parse((REFERENCE / f"small_{name}.forces").read_text())
    assert energies == pytest.approx(their[0], rel=1e-10, abs=1e-15)
    np.testing.assert_allclose(forces, their[2], rtol=0, atol=1e-9)


def test_reference_without_tables() -> None:
    """With the terms that are tables switched off, all forces are exact."""
    got = evaluate(SMALL, "papilla", NO_TABLES)
    want = expected(got.scene, read_configuration(SMALL))
    total = np.sum(list(want.forces.values()), axis=0)
    assert np.abs(total).max() > 1
    assert_forces(got.forces.forces, total, force_tolerance(want, TERMS, 1e-11, 0.0))


@pytest.mark.parametrize("name", SETS)
def test_named_sets(name: str) -> None:
    """The scene's parameter sets are those of the numpy model, number by number."""
    scene = small_scene("quarter-nd-a", name)
    for term in ("wall", "membrane_exclusion", "cell_membrane_exclusion", "cell_cell_exclusion"):
        assert parameters_of(scene, term) == named(name)


# ---- crowded configurations on other lattices ----

S, T, X, N = Kind.STEM, Kind.TA, Kind.EXHAUSTED, Kind.ND
CROWD: Cells = [
    *[(S, 10), 0.7, (T, 10), (T, 5), 0.02, (T, 5), (X, 0), 1.9, (X, 0), (T, 2), 1.2, (T, 2)],
    *[(S, 10), (S, 10), (N, 0), (N, 0)],
    *[(T, m) for m in (9, 8, 7, 6, 5, 4, 3, 2, 1, 1, 1, 1)],
    *[(X, 0)] * 4,
]


def crowded(lattice: tuple[int, int], shape: str, seed: int, parameters: str) -> Prepared:
    """Return a state with cells as close as 0.4."""
    scene = small_scene("quarter-nd-a", parameters, **{"membrane.lattice": list(lattice)})
    return prepare(scene, shape, seed, CROWD, apart=0.4 / 2.8)


def text_of(state: State, lattice: tuple[int, int], time: float) -> str:
    """Return a state in the text format."""
    lines = [f"lattice {lattice[0]} {lattice[1]} {state.box[0]:.17g} {state.box[1]:.17g} {time}"]
    for kind, (x, y, z), m in zip(state.kinds, state.positions, state.divisions_left, strict=True):
        lines.append(f"{kind} {x:.17g} {y:.17g} {z:.17g} {m if kind == 'T' else ''}")
    lines += [f"pair {i} {j} {length:.17g}" for i, j, length in state.pairs]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("lattice", "shape", "parameters"),
    [
        ((12, 14), "crumpled", "papilla"),
        ((12, 14), "folded", "direct5"),
        ((16, 18), "folded", "printed"),
        ((16, 18), "crumpled", "weak5"),
        ((30, 20), "crumpled", "direct5"),
        ((30, 20), "folded", "papilla"),
    ],
)
def test_crowded(lattice: tuple[int, int], shape: str, parameters: str, tmp_path: Path) -> None:
    """Cells pressed together, several pairs mid-division, dermal spheres overlapping."""
    case = crowded(lattice, shape, lattice[0] + len(shape), parameters)
    cells = case.state.positions[case.state.where("TSN")]
    apart = case.state.minimum_image(cells[:, None] - cells[None])
    distances = np.linalg.norm(apart, axis=2)[np.triu_indices(len(cells), 1)]
    assert np.sum((distances > 0.4) & (distances < 1.0)) >= 3
    assert len(case.state.pairs) == 4

    path = tmp_path / "crowded.txt"
    path.write_text(text_of(case.state, lattice, 812.35))
    read = read_configuration(path)
    np.testing.assert_array_equal(read.positions, case.state.positions)
    want = expected(case.scene, read)
    assert all(want.energies.values())
    got = evaluate(path, parameters)
    assert_agrees(got, read)


# ---- the text format ----


@pytest.fixture
def case() -> Prepared:
    """Return a crowded state."""
    return crowded((12, 14), "crumpled", 20, "papilla")


def permuted(state: State, order: np.ndarray) -> State:
    """Return the state with its particles in another order."""
    place = np.argsort(order)
    return replace(
        state, kinds=state.kinds[order], positions=state.positions[order],
        divisions_left=state.divisions_left[order], links=place[state.links],
        hinges=place[state.hinges],
        pairs=[(int(place[j]), int(place[i]), length) for i, j, length in state.pairs],
    )  # fmt: skip


def test_order_of_particles(case: Prepared, tmp_path: Path) -> None:
    """Particles may be listed in any order that keeps the membrane's rows; so may pairs."""
    state = case.state
    rng = np.random.default_rng(9)
    order = rng.permutation(len(state.kinds))
    order[np.isin(order, state.where("M"))] = state.where("M")
    shuffled = permuted(state, order)
    path = tmp_path / "shuffled.txt"
    path.write_text(text_of(shuffled, (12, 14), 5.0))
    got = evaluate(path, "papilla")
    assert_agrees(got, shuffled)


def test_time_does_not_matter(case: Prepared, tmp_path: Path) -> None:
    """The natural lengths are those of the file, whatever its time."""
    energies = []
    for time in (0.0, 0.333, 98765.4321):
        path = tmp_path / "state.txt"
        path.write_text(text_of(case.state, (12, 14), time))
        energies.append(evaluate(path, "papilla", {"numerics.table_points": 1000}).energies)
    assert energies[1] == pytest.approx(energies[0], rel=1e-10, abs=0)
    assert energies[2] == pytest.approx(energies[0], rel=1e-10, abs=0)


@pytest.mark.parametrize("kinds", ["M", "MD", "MN", "MST", "MDT", "MTN"])
def test_parts(case: Prepared, kinds: str, tmp_path: Path) -> None:
    """A file may lack the dermis, all cells, or some kinds of cells."""
    state = case.state
    kept = state.where(kinds)
    place = np.full(len(state.kinds), -1)
    place[kept] = np.arange(len(kept))
    pairs = [(int(place[i]), int(place[j]), length) for i, j, length in state.pairs]
    part = replace(
        state, kinds=state.kinds[kept], positions=state.positions[kept],
        divisions_left=state.divisions_left[kept],
        pairs=[pair for pair in pairs if pair[0] >= 0 and pair[1] >= 0],
    )  # fmt: skip
    path = tmp_path / "part.txt"
    path.write_text(text_of(part, (12, 14), 1.0))
    got = evaluate(path, "direct5", {"numerics.table_points": 30_000})
    assert_agrees(got, part)
    assert set(got.scene.kinds) >= {Kind.MEMBRANE}
    assert got.scene.dermis.present == ("D" in kinds)


def test_a_term_without_a_short_name_counts_too() -> None:
    energies = {**dict.fromkeys(terms.TERMS, 1.0), "cell_dermis_exclusion": 5.0}
    nothing = Forces(np.empty(0, int), np.empty(0, int), np.empty((0, 3)), np.empty((0, 3)))
    lines = Evaluation(Scene.from_dict({}), energies, 0.0, nothing, {}).lines()
    assert "# E cell_dermis_exclusion 5" in lines
    assert f"# E total {sum(energies.values()):g}" in lines
