"""The lateral pressure of cells, against energies and against what is known."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin import Scene, open_trajectory
from lammps_skin.analysis.pressure import LateralPressure, natural_lengths, spread, virials
from lammps_skin.model.terms import Terms

from tests.analysis.conftest import FRAMES, Run

BOX = (12.0, 11.0)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene.load("one-stem").replace(**{"cells.cell_adhesion_stiffness": 0.5})


def energy(
    scene: Scene, cells: np.ndarray, box: np.ndarray, other: np.ndarray, lengths: np.ndarray
) -> float:
    """Between all cells, those of pairs by their springs alone."""
    terms, total = Terms.of(scene), 0.0
    for i in range(len(cells)):
        for j in range(i):
            away = cells[i] - cells[j]
            away[:2] -= np.round(away[:2] / box) * box
            distance = np.linalg.norm(away)
            if other[i] == j:
                total += terms.division.stiffness / 2 * (distance - lengths[i]) ** 2
                continue
            for pair in terms.pair_potentials.values():
                x = distance / pair.contact
                if pair.between == "cell_cell" and x < pair.range:
                    total += pair.stiffness * float(pair.energy(np.array([x]))[0])
    return total


def test_virials_are_the_derivative_of_the_energy(scene: Scene) -> None:
    """To a scale of all lengths, the box's included: with neighbors through its edges."""
    random = np.random.default_rng(1)
    grid = np.array([(x, y) for x in np.arange(1, 12, 2.4) for y in np.arange(1, 11, 2.2)])
    places = grid + random.uniform(-0.2, 0.2, grid.shape)
    cells = np.column_stack([places, random.uniform(0, 0.3, len(grid))])
    other = np.full(len(cells), -1)
    other[:2] = 1, 0
    lengths = np.full(len(cells), 1.3)
    found = virials(scene, cells, other, lengths, BOX)
    box, step = np.array(BOX), 1e-6
    larger, smaller = (
        energy(scene, cells * s, box * s, other, lengths) for s in (1 + step, 1 - step)
    )
    assert found.sum() == pytest.approx(-(larger - smaller) / (2 * step), rel=1e-6)
    assert abs(found.sum()) > 0.1
    # each pair belongs to its two cells in equal parts
    pair = virials(scene, cells[:2], other[:2], lengths[:2], BOX)
    assert pair[0] == pytest.approx(pair[1])


def test_pressure_of_a_run(run: Run) -> None:
    """Of its last frame it is the derivative of the energy of the cells to twice the area."""
    found = LateralPressure(open_trajectory(run.directory)).run(start=FRAMES - 1).results
    cells, box = run.cells[-1], np.array(run.scene.box_sides[:2])
    other = np.where(cells.pair > 0, np.searchsorted(cells.ids, cells.pair), -1)
    assert (other >= 0).any() and (other < 0).any()
    cell = run.scene.cells
    ages = found.time[0] - cells.pair_start
    lengths = 2 * cell.division_separation * cell.radius + cell.division_rate * ages
    lengths = np.minimum(lengths, 2 * cell.radius)
    larger, smaller = (
        energy(run.scene, cells.positions * s, box * s, other, lengths)
        for s in (1 + 1e-6, 1 - 1e-6)
    )
    expected = -(larger - smaller) / 2e-6 / (2 * box.prod())
    assert found.mean[0] == pytest.approx(expected, rel=1e-3) and expected > 0
    assert found.pressure[0].mean() == pytest.approx(found.mean[0])
    assert found.height.shape == found.pressure.shape


def test_a_cell_alone_pushes_nothing(scene: Scene) -> None:
    alone = np.array([[1.0, 1.0, 0.0], [6.0, 5.0, 0.0]])
    assert not virials(scene, alone, np.array([-1, -1]), np.full(2, np.nan), BOX).any()


def test_springs_of_pairs_grow_up_to_the_diameter_of_a_cell(scene: Scene) -> None:
    ages = np.array([0.0, 10.0, 1e3])
    cells = scene.cells
    np.testing.assert_allclose(
        natural_lengths(scene, ages),
        [2 * cells.division_separation * cells.radius,
         2 * cells.division_separation * cells.radius + 10 * cells.division_rate,
         2 * cells.radius],
    )  # fmt: skip


def test_what_is_spread_is_kept(scene: Scene) -> None:
    """Through the edges, and with its highest value where the cell is."""
    values, places = np.array([2.0, 1.0]), np.array([[0.1, 10.9], [6.0, 5.5]])
    field = spread(values, places, BOX, (48, 44), 1.4)
    assert field.mean() * BOX[0] * BOX[1] == pytest.approx(3.0)
    assert np.unravel_index(field.argmax(), field.shape) == (0, 0)  # the node that is nearest
