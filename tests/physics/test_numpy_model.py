"""The numpy model against the reference files, finite differences and closed forms."""

from dataclasses import dataclass, replace
from itertools import product
from math import dist, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from numpy_model import (
    Floats,
    Ints,
    Parameters,
    State,
    energies_and_forces,
    named,
    nearest_membrane,
    read_configuration,
    triangular_lattice,
)
from plain_potentials import table_dermis_dermis

REFERENCE = Path(__file__).resolve().parent / "reference"

REFERENCE_SETS = {
    "V1paperdiv": named("printed"),
    "V1_lam1.4_Kad25": replace(named("printed"), division_spring="length"),
    "V1_lam1.2_Kad25": named("papilla"),
    "V2_lam1.4_Kad5": named("direct5"),
    "V2_lam1.2_Kad5": named("earlier"),
}
REFERENCE_TERMS = {
    "dm": "dermis_membrane",
    "dd": "dermis_dermis",
    "wall": "wall",
    "str": "stretch",
    "bend": "bend",
    "mm_ex": "membrane_exclusion",
    "bind": "binding",
    "ad": "adhesion",
    "cm_ex": "cell_membrane_exclusion",
    "cc_ex": "cell_cell_exclusion",
    "cc_ad_shifted": "cell_cell_adhesion",
    "div": "division",
}
TERMS = set(REFERENCE_TERMS.values())
SETS = ("printed", "papilla", "weak5", "direct5")


@dataclass
class Reference:
    """What one .forces file says."""

    energies: dict[str, float]
    kinds: list[str]
    forces: Floats
    nearest: Ints
    distances: Floats


def read_reference(name: str) -> Reference:
    """Read one .forces file."""
    energies: dict[str, float] = {}
    kinds: list[str] = []
    forces, nearest = [], []
    for line in (REFERENCE / f"small_{name}.forces").read_text().splitlines():
        words = line.split()
        if words[:2] == ["#", "E"]:
            energies[words[2]] = float(words[3])
        elif words[0] != "#":
            assert int(words[0]) == len(kinds)
            kinds.append(words[1])
            forces.append([float(word) for word in words[2:5]])
            if len(words) > 5:
                nearest.append((int(words[5]), float(words[6])))
    index, distances = zip(*nearest, strict=True)
    return Reference(energies, kinds, np.array(forces), np.array(index), np.array(distances))


@pytest.fixture(scope="module")
def small() -> State:
    """Return the configuration of the reference files."""
    return read_configuration(REFERENCE / "small.txt")


def flat_lattice(nx: int, ny: int) -> tuple[Floats, tuple[float, float]]:
    """Return the positions and the box of the flat lattice with spacing 0.5."""
    row, column = (axis.ravel() for axis in np.indices((ny, nx)))
    height = sqrt(3) / 4
    x, y = 0.5 * column + 0.25 * (row % 2), height * row
    return np.stack([x, y, np.zeros(nx * ny)], axis=1), (0.5 * nx, height * ny)


def scatter(
    rng: np.random.Generator, n: int, box: tuple[float, float], z: tuple[float, float], apart: float
) -> Floats:
    """Return n random points of a slab that keep a distance, through the edges too."""
    points: list[Floats] = []
    for _ in range(100_000):
        point = rng.uniform((0, 0, z[0]), (*box, z[1]))
        gaps = np.array([point - other for other in points]).reshape(-1, 3)
        gaps[:, :2] -= np.round(gaps[:, :2] / box) * box
        if np.all(np.linalg.norm(gaps, axis=1) > apart):
            points.append(point)
        if len(points) == n:
            return np.array(points)
    raise AssertionError(f"no room for {n} points {apart} apart")


SPIKE, TWINS = 40, (100, 123)  # pulled far up; second neighbours pushed together


@pytest.fixture(scope="module")
def crowded() -> State:
    """Return a 6 x 6 scene in which every branch of every term is active."""
    rng = np.random.default_rng(2018)
    nx, ny = 12, 14
    membrane, box = flat_lattice(nx, ny)
    membrane += rng.normal(scale=0.04, size=membrane.shape)
    membrane[:, 2] += 8 + 0.2 * np.sin(2 * pi * membrane[:, 0] / box[0])
    membrane[SPIKE, 2] += 1.9
    gap = membrane[TWINS[1]] - membrane[TWINS[0]]
    membrane[TWINS[0]] += (0.27 * gap[0], 0.27 * gap[1], 0.6)
    membrane[TWINS[1]] += (-0.27 * gap[0], -0.27 * gap[1], 0.6 - gap[2])

    dermis = scatter(rng, 14, box, (0.9, 6.5), 1.5)
    cells = scatter(rng, 12, box, (10.0, 13.0), 2.0)
    daughters = cells[[2, 7]] + np.array([[0.3, 0.2, -0.1], [1.0, -0.9, 0.4]])
    positions = np.concatenate([membrane, dermis, cells, daughters])
    # nothing may depend on the image in which a particle is given
    positions[:, :2] += rng.integers(-2, 3, (len(positions), 2)) * box

    kinds = np.array([*"M" * nx * ny, *"D" * 14, *"SNTTTTNTTSTT", *"TT"])
    left = np.where(kinds == "T", np.arange(len(kinds)) % 4, 0)
    links, _, hinges = triangular_lattice(nx, ny)
    first = nx * ny + 14
    pairs = [(first + 2, first + 12, 0.6), (first + 13, first + 7, 1.1)]
    return State(kinds, positions, box, left, links, hinges, pairs)


def link_lengths(state: State) -> Floats:
    """Return the lengths of all links."""
    i, j = state.links.T
    vectors = state.minimum_image(state.positions[j] - state.positions[i])
    lengths: Floats = np.linalg.norm(vectors, axis=1)
    return lengths


# ---- reference files ----


@pytest.mark.parametrize("name", REFERENCE_SETS)
def test_energies_of_the_reference(small: State, name: str) -> None:
    """Every energy agrees to the printed digits."""
    expected = read_reference(name).energies
    energies, _ = energies_and_forces(small, REFERENCE_SETS[name])
    assert set(energies) == TERMS
    for theirs, ours in REFERENCE_TERMS.items():
        assert energies[ours] == pytest.approx(expected[theirs], rel=1e-11, abs=1e-15), ours
    # their total is with the plateau
    total = sum(energies.values()) + expected["cc_ad"] - expected["cc_ad_shifted"]
    assert total == pytest.approx(expected["total"], rel=1e-11)


@pytest.mark.parametrize("name", REFERENCE_SETS)
def test_forces_of_the_reference(small: State, name: str) -> None:
    """Every particle's force agrees to 1e-11 of the largest, the digits of the positions."""
    expected = read_reference(name)
    _, forces = energies_and_forces(small, REFERENCE_SETS[name])
    assert expected.kinds == small.kinds.tolist()
    assert set(forces) == TERMS
    total = np.sum(list(forces.values()), axis=0)
    largest = np.linalg.norm(expected.forces, axis=1).max()
    assert largest > 1
    np.testing.assert_allclose(total, expected.forces, rtol=0, atol=1e-11 * largest)


@pytest.mark.parametrize("name", REFERENCE_SETS)
def test_nearest_membrane_of_the_reference(small: State, name: str) -> None:
    """Every cell's nearest membrane particle and its distance agree."""
    expected = read_reference(name)
    index, distance = nearest_membrane(small)
    assert len(expected.nearest) == 15
    np.testing.assert_array_equal(index, expected.nearest)
    np.testing.assert_allclose(distance, expected.distances, rtol=0, atol=1e-9)


# ---- forces are derivatives ----


def test_crowded_scene_reaches_every_branch(crowded: State) -> None:
    """The scene of the finite differences has particles on each branch of each potential."""
    x = link_lengths(crowded) / 2
    assert np.sum(x < 0.25) > 10
    assert np.sum((x > 0.25) & (x < 1)) > 10
    assert np.sum(x > 1) >= 3
    dermis = crowded.positions[crowded.where("D")]
    gaps = crowded.minimum_image(dermis[:, None] - dermis)[np.triu_indices(len(dermis), 1)]
    x = np.linalg.norm(gaps, axis=1) / 2.8
    assert min(np.sum(x < 0.8), np.sum((x > 0.8) & (x < 1)), np.sum((x > 1) & (x < 1.4))) > 3
    x = nearest_membrane(crowded)[1] / 2.4
    ta = crowded.kinds[crowded.where("STN")] == "T"
    assert x[ta].min() < 1 < 1.4 < x[ta].max()
    assert np.any((x[ta] > 1) & (x[ta] < 1.2))
    assert set(crowded.divisions_left[crowded.where("T")]) == {0, 1, 2, 3}


LONGER = [pytest.param(name, marks=pytest.mark.slow) for name in ("papilla", "weak5")]


@pytest.mark.parametrize(
    "name", ["direct5", pytest.param("printed", marks=pytest.mark.slow), *LONGER]
)
def test_forces_are_central_differences(crowded: State, name: str) -> None:
    """Each term's forces are minus the central differences of its energy."""
    parameters, step = named(name), 1e-5
    _, forces = energies_and_forces(crowded, parameters)
    i, j = crowded.links.T
    special = np.isin(i, (SPIKE, *TWINS)) | np.isin(j, (SPIKE, *TWINS))
    membrane = np.random.default_rng(1).choice(crowded.where("M"), 12, replace=False)
    moved = np.unique(
        [*crowded.where("DSTN"), *i[special], *j[special], *membrane, *nearest_membrane(crowded)[0]]
    )
    difference = {term: np.zeros((len(moved), 3)) for term in forces}
    for row, axis in product(range(len(moved)), range(3)):
        for sign in (1, -1):
            positions = crowded.positions.copy()
            positions[moved[row], axis] += sign * step
            energies, _ = energies_and_forces(replace(crowded, positions=positions), parameters)
            for term, energy in energies.items():
                difference[term][row, axis] -= sign * energy / (2 * step)
    assert set(forces) == TERMS
    for term, force in forces.items():
        largest = np.abs(force).max()
        assert 1e-3 < largest < 30, term  # no single force hides the others
        np.testing.assert_allclose(
            difference[term], force[moved], rtol=1e-6, atol=1e-8 * max(largest, 1), err_msg=term
        )


@pytest.mark.parametrize("name", SETS)
def test_only_the_wall_pushes_the_whole(crowded: State, name: str) -> None:
    """Each term's forces add up to nothing, those of the wall to a push upwards."""
    _, forces = energies_and_forces(crowded, named(name))
    for term, force in forces.items():
        if term == "wall":
            assert force.sum(axis=0)[2] > 0.01
        else:
            assert np.abs(force).max() > 1e-3, term
            assert np.abs(force.sum(axis=0)).max() < 1e-11 * np.abs(force).max(), term


# ---- searches ----


def test_pairs_see_all_images(crowded: State) -> None:
    """The dermal energy is a plain sum over images, not over the minimum images alone."""
    lx, ly = crowded.box
    dermis = [tuple(r) for r in crowded.positions[crowded.where("D")]]
    all_images = shortest = 0.0
    for b, (x, y, z) in enumerate(dermis):
        for other in dermis[:b]:
            images = [(x + k * lx, y + m * ly, z) for k, m in product(range(-6, 7), repeat=2)]
            each = [table_dermis_dermis(dist(other, image) / 2.8) for image in images]
            all_images += 0.04 * sum(each)
            shortest += 0.04 * each[int(np.argmin([dist(other, image) for image in images]))]
    assert abs(all_images - shortest) > 1e-3
    energies, _ = energies_and_forces(crowded, named("papilla"))
    assert energies["dermis_dermis"] == pytest.approx(all_images, rel=1e-12)


def test_own_images_count_half() -> None:
    """A particle alone in a box of 3 x 3 sees four images of itself and feels no force."""
    state = State(np.array(["D"]), np.array([[7.0, -2.0, 5.0]]), (3.0, 3.0), np.array([0]))
    energies, forces = energies_and_forces(state, Parameters())
    expected = 0.04 * 4 / 2 * table_dermis_dermis(3 / 2.8)
    assert expected < -1e-3
    assert energies["dermis_dermis"] == pytest.approx(expected, rel=1e-12)
    assert np.abs(forces["dermis_dermis"]).max() < 1e-15


def test_nearest_membrane_through_the_edges(crowded: State) -> None:
    """The nearest membrane particle is the nearest of all images, for some through an edge."""
    lx, ly = crowded.box
    index, distance = nearest_membrane(crowded)
    assert len(index) == 14
    cells = crowded.positions[crowded.where("STN")]
    offsets = np.array(list(product(range(-6, 7), repeat=2))) * (lx, ly)
    across = 0
    for cell, near, expected in zip(cells, index, distance, strict=True):
        images = np.concatenate(
            [crowded.positions[crowded.where("M")] + (*offset, 0.0) for offset in offsets]
        )
        gaps = np.sqrt(np.sum((images - cell) ** 2, axis=1))
        assert np.argmin(gaps) % 168 == near
        assert gaps.min() == pytest.approx(expected, rel=1e-12)
        across += dist(cell, crowded.positions[near]) > expected + 1
    assert across > 3


def test_unlinked_membrane_is_a_plain_sum(crowded: State) -> None:
    """Membrane exclusion counts close pairs that no link joins, and there are some."""
    linked = {frozenset(map(int, link)) for link in crowded.links}
    membrane = crowded.where("M")
    gaps = crowded.minimum_image(
        crowded.positions[membrane][:, None] - crowded.positions[membrane][None]
    )
    x = np.linalg.norm(gaps, axis=2) / 0.5
    close = [(i, j) for i, j in np.argwhere(x < 1) if i < j and frozenset((i, j)) not in linked]
    assert TWINS in close
    expected = sum(0.04 * (x[pair] ** -12 / 12 - x[pair] ** -6 / 6 + 1 / 12) for pair in close)
    energies, _ = energies_and_forces(crowded, named("papilla"))
    assert energies["membrane_exclusion"] == pytest.approx(expected, rel=1e-12)


def test_dividing_pairs_have_only_their_spring(crowded: State) -> None:
    """Without its pairs the same scene has much more exclusion and no spring."""
    paired, _ = energies_and_forces(crowded, named("papilla"))
    alone, _ = energies_and_forces(replace(crowded, pairs=[]), named("papilla"))
    assert paired["division"] > 0.01
    assert alone["division"] == 0
    assert alone["cell_cell_exclusion"] > 100 * paired["cell_cell_exclusion"] > 0
    assert alone["cell_cell_adhesion"] < paired["cell_cell_adhesion"] < 0


def test_exhausted_cells_do_not_adhere(crowded: State) -> None:
    """Adhesion comes from TA cells with divisions left, and from them alone."""
    left = crowded.divisions_left
    full, _ = energies_and_forces(crowded, named("papilla"))
    fewer = replace(crowded, divisions_left=np.where(left == 1, 0, left))
    none = replace(crowded, divisions_left=np.zeros_like(left))
    assert 0 < energies_and_forces(fewer, named("papilla"))[0]["adhesion"] < full["adhesion"]
    assert energies_and_forces(none, named("papilla"))[0]["adhesion"] == 0


# ---- lattice ----


def test_lattice_topology() -> None:
    """Six neighbours each at 0.5, two triangles at each link, all normals up."""
    positions, box = flat_lattice(6, 8)
    links, triangles, hinges = triangular_lattice(6, 8)
    n = len(positions)
    assert links.shape == (3 * n, 2)
    assert triangles.shape == (2 * n, 3)
    assert hinges.shape == (3 * n, 4)
    state = State(np.full(n, "M"), positions, box, np.zeros(n, int), links, hinges)
    assert len({frozenset(link) for link in links.tolist()}) == 3 * n
    assert np.all(np.bincount(links.ravel()) == 6)
    np.testing.assert_allclose(link_lengths(state), 0.5, atol=1e-14)
    r0, r1, r2 = (positions[corner] for corner in triangles.T)
    normals = np.cross(state.minimum_image(r1 - r0), state.minimum_image(r2 - r0))
    np.testing.assert_allclose(normals, np.tile((0, 0, sqrt(3) / 8), (2 * n, 1)), atol=1e-14)
    faces = {frozenset(triangle) for triangle in triangles.tolist()}
    assert len(faces) == 2 * n
    for one, i, j, two in hinges.tolist():
        assert [i, j] in links.tolist()
        assert {face for face in faces if face >= {i, j}} == {
            frozenset((one, i, j)),
            frozenset((two, i, j)),
        }


@pytest.mark.parametrize("size", [(6, 7), (2, 8), (6, 2)])
def test_lattice_refuses(size: tuple[int, int]) -> None:
    """An odd number of rows does not close, a tiny lattice links particles twice."""
    with pytest.raises(ValueError, match=f"lattice of {size[0]} x {size[1]}"):
        triangular_lattice(*size)
