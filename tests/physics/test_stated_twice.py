"""Formulas that stand in C++ and in `potentials`: both give the same energies."""

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.model import parameters, potentials
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.start.configuration import Configuration

AGE = 3.7  # of the dividing pair
S, T, X, N = Kind.STEM, Kind.TA, Kind.EXHAUSTED, Kind.ND
# kind, divisions left, height above the membrane in contact lengths
CELLS = (
    (S, 10, 1.15), (T, 10, 1.02), (S, 10, 0.9), (N, 0, 1.2), (T, 3, 0.85), (T, 4, 1.1),
    (T, 1, 1.18), (X, 0, 1.1), (T, 5, 1.6),
)  # fmt: skip


def rough_state(scene: Scene) -> Configuration:
    """A rough membrane with a spike, cells around it, the first two of them a pair."""
    random = np.random.default_rng(1)
    sheet = lattice.positions(scene.membrane.lattice, scene.spacing, scene.membrane_height)
    sheet += random.normal(0.0, 0.07, sheet.shape)
    sheet[5, 2] += 2.05  # links between 2 R_m and their singular length
    links, hinges = lattice.links_and_hinges(scene.membrane.lattice)
    kinds, left, heights = zip(*CELLS, strict=True)
    spots = (np.indices((3, 3)).reshape(2, -1).T + 0.4) * np.divide(scene.box_sides[:2], 3)
    spots[1] = spots[0] + 0.6  # the pair
    above = scene.membrane_height + scene.contact * np.array(heights)
    bare = [0] * len(sheet)
    state = Configuration(
        box=np.array(scene.box_sides),
        kinds=np.array([Kind.MEMBRANE] * len(sheet) + list(kinds), int),
        positions=np.concatenate([sheet, np.column_stack([spots, above])]),
        links=links, hinges=hinges, divisions_left=np.array(bare + list(left)), time=50.0,
    )  # fmt: skip
    first = len(sheet)
    state.pair[[first, first + 1]] = first + 2, first + 1
    state.pair_start[[first, first + 1]] = state.time - AGE
    return state


def between(state: Configuration, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Shortest vectors (n, 3) from particles i to particles j."""
    vectors = state.positions[j] - state.positions[i]
    vectors[:, :2] -= state.box[:2] * np.round(vectors[:, :2] / state.box[:2])
    return vectors


def stretch_energy(scene: Scene, state: Configuration) -> float:
    membrane, contact = scene.membrane, 2 * scene.membrane.radius
    x = np.linalg.norm(between(state, *state.links.T), axis=1) / contact
    assert x.min() < membrane.spacing_ratio < 1 < x.max()
    scale = contact if scene.force_scale == "direct" else 1.0
    u = potentials.stretch(x, membrane.elasticity, membrane.spacing_ratio, scale)
    return membrane.stretch_stiffness * float(u.sum())


def bending_energy(scene: Scene, state: Configuration) -> float:
    a, i, j, b = state.hinges.T
    one = np.cross(between(state, a, i), between(state, a, j))
    other = np.cross(between(state, b, j), between(state, b, i))
    cosine = (one * other).sum(1) / np.linalg.norm(one, axis=1) / np.linalg.norm(other, axis=1)
    return scene.membrane.bending_stiffness * float(
        potentials.bending(cosine, scene.membrane.bending_form).sum()
    )


def attachment_energies(scene: Scene, state: Configuration) -> tuple[float, float]:
    """Adhesion and binding."""
    x = state.nearest_membrane()[1] / scene.contact
    adhering, bound = state.kinds == T, np.isin(state.kinds, (S, N))
    lam = scene.cells.adhesion_range
    assert (x[adhering] < 1).any()
    assert ((x[adhering] > 1) & (x[adhering] < lam)).any()
    assert (x[adhering] > lam).any()
    assert (x[bound] < 1).any()
    assert (x[bound] > 1).any()
    terms = Terms.of(scene)
    return (
        terms.adhesion * float(potentials.adhesion(x[adhering], lam).sum()),
        terms.binding * float(potentials.binding(x[bound]).sum()),
    )


def division_energy(scene: Scene, state: Configuration) -> float:
    pair = np.flatnonzero(state.pair)
    distance = float(np.linalg.norm(between(state, pair[:1], pair[1:])))
    stiffness, start, rate, _ = Terms.of(scene).division
    return stiffness * float(potentials.division_spring(distance, start + rate * AGE))


@pytest.mark.parametrize("name", parameters.SETS)
def test_energies_are_those_of_the_formulas(name: str) -> None:
    scene = Scene.from_dict(
        {
            "parameters": name, "dermis": {"present": False}, "membrane": {"lattice": [28, 32]},
            "cells": {"stem": 1, "nd": 1, "arrangement": "random"},
            "numerics": {"accuracy": "reference"},
            "output": {"dump_interval": 0.0, "checkpoint_interval": 0.0},
        }
    )  # fmt: skip
    state = rough_state(scene)
    adhesion, binding = attachment_energies(scene, state)
    want = {
        "stretch": stretch_energy(scene, state),
        "bend": bending_energy(scene, state),
        "adhesion": adhesion,
        "binding": binding,
        "division": division_energy(scene, state),
    }
    with Simulation.begin(scene, configuration=state) as simulation:
        energies = simulation.energies()
    assert {term: energies[term] for term in want} == pytest.approx(want, rel=1e-10, abs=0)
