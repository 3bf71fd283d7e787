"""Layers of cells and stretched membranes with known answers."""

from __future__ import annotations

import numpy as np
import pytest
from lammps_skin.analysis.basal_layer import last_remark, layering, links, remark, sheet

from tests.analysis.meshes import icosphere, rough_sheet
from tests.analysis.meshes import sheet as flat

RADIUS = 1.4
BOX = 20.0, 17.0


def test_one_layer_has_no_cell_below_another():
    x, y = (part.ravel() * 2 * RADIUS for part in np.mgrid[:5, :5])
    slope = 0.9 * RADIUS / (2 * RADIUS)
    found = layering(np.column_stack([x, y, slope * x]), np.arange(25), 50, BOX, RADIUS)
    assert found == (1.0, 0.0, 1.0, 0.5)


def test_a_heap_counts_every_cell_below_through_the_edge_of_the_box():
    cells = np.array([[0.1, 5, 10], [19.9, 5, 12], [0.3, 5, 14], [10, 5, 14]])
    found = layering(cells, np.array([7, 7, 7, 2]), 10, BOX, RADIUS)
    assert found == (0.5, 3 / 4, 3.0, 0.2)


@pytest.mark.parametrize(("aside", "lower", "counts"), [
    (0.99, 1.01, True), (1.01, 1.01, False), (0.99, 0.99, False),
])  # fmt: skip
def test_below_is_closer_in_the_plane_than_a_radius_and_lower_by_more(aside, lower, counts):
    cells = np.array([[5, 5, 8], [5 + aside * RADIUS, 5, 8 - lower * RADIUS]])
    assert layering(cells, np.array([0, 1]), 4, BOX, RADIUS).none_below == (0.5 if counts else 1.0)


def test_layering_agrees_with_all_pairs_one_by_one():
    random = np.random.default_rng(3)
    cells = random.uniform(0, [*BOX, 8], (120, 3))
    below = random.integers(0, 40, 120)
    apart = cells[:, None] - cells[None]
    apart[..., :2] -= BOX * np.round(apart[..., :2] / BOX)
    number = ((np.hypot(*apart[..., :2].T).T < RADIUS) & (apart[..., 2] > RADIUS)).sum(axis=1)
    most = max(np.count_nonzero(below == n) for n in range(40))
    expected = (number == 0).mean(), number.mean(), most, len(set(below)) / 40
    assert layering(cells, below, 40, BOX, RADIUS) == pytest.approx(expected)


def test_without_cells_nothing_is_defined():
    assert np.isnan(layering(np.empty((0, 3)), np.empty(0, int), 4, BOX, RADIUS)).all()


def test_area_and_links_of_known_surfaces():
    tilted, triangles, box = flat((40, 46), lambda x, y: 0 * x)
    found = sheet(tilted, triangles, links(triangles), box)
    assert found.area == pytest.approx(box[0] * box[1])
    assert found.long_link == pytest.approx(0.5)
    ball, faces = icosphere(4, 3.0)
    assert sheet(ball, faces, links(faces)).area == pytest.approx(4 * np.pi * 9, rel=5e-3)


def test_links_are_each_counted_once():
    positions, triangles, box = rough_sheet(1)
    sides = {frozenset(pair) for t in triangles.tolist() for pair in zip(t, t[1:] + t[:1])}  # noqa: B905
    found = links(triangles)
    assert found.shape == (2, len(sides))
    assert {frozenset(pair) for pair in found.T.tolist()} == sides
    ends = np.array([sorted(side) for side in sides])
    apart = positions[ends[:, 0]] - positions[ends[:, 1]]
    apart[:, :2] -= np.array(box) * np.round(apart[:, :2] / np.array(box))
    expected = np.quantile(np.linalg.norm(apart, axis=1), 0.99)
    assert sheet(positions, triangles, found, box).long_link == pytest.approx(expected)


def test_only_a_covered_heap_is_remarked_on():
    assert remark(400.0, 0.95, 0.36) == (
        "not a basal layer at t = 400: 64% of the cells have another cell straight below them "
        "(in one layer it is at most 20%): statistics of papillae and of cells on their tips "
        "describe a heap of cells"
    )
    assert remark(400.0, 0.95, 0.85) is None
    assert remark(100.0, 0.5, 0.3) is None
    assert remark(0.0, float("nan"), float("nan")) is None


def test_a_table_is_remarked_on_for_its_last_heap():
    table = {
        "time": [0.0, 300.0, 400.0, 500.0], "coverage": [0.1, 0.95, 0.96, 0.97],
        "none_below": [float("nan"), 0.5, 0.6, 0.9],
    }  # fmt: skip
    assert last_remark(table) == remark(400.0, 0.96, 0.6)
    assert last_remark({**table, "none_below": [1.0] * 4}) is None
