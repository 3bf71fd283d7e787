"""The lateral pressure of the layer of cells: how strongly they push one another aside."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from lammps_skin.analysis.geometry import Box, minimum_image
from lammps_skin.analysis.state import State, StateAnalysis
from lammps_skin.analysis.surface import smooth
from lammps_skin.arrays import Floats, Ints
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms

FREE = 0  # id of the other cell of the pair of a cell that is in none


def virials(scene: Scene, cells: Floats, other: Ints, lengths: Floats, box: Box) -> Floats:
    """Force times distance of each cell with all others, half of it (c,), energy.

    Their sum is minus the derivative of the energy between cells with respect to the logarithm
    of all distances: positive where cells push.

    Parameters
    ----------
    scene : Scene
    cells : (c, 3) array
        Positions.
    other : (c,) array of int
        Index of the other cell of a dividing pair, -1 outside of pairs.
    lengths : (c,) array
        Natural length of the spring of a pair.
    box : (L_x, L_y)
    """
    terms = Terms.of(scene)
    between = [pair for pair in terms.pair_potentials.values() if pair.between == "cell_cell"]
    reach = max((pair.contact * pair.range for pair in between), default=0.0)
    i, j = _close(cells, reach, box)
    apart = other[i] != j
    i, j = i[apart], j[apart]
    distance = np.linalg.norm(minimum_image(cells[j] - cells[i], box), axis=1)
    pushes = np.zeros(len(i))
    for pair in between:
        x = distance / pair.contact
        near = x < pair.range
        pushes[near] -= pair.stiffness * pair.slope(x[near]) * x[near]
    found = np.zeros(len(cells))
    np.add.at(found, i, pushes)
    np.add.at(found, j, pushes)
    paired = np.flatnonzero(other >= 0)
    apart_by = np.linalg.norm(minimum_image(cells[other[paired]] - cells[paired], box), axis=1)
    found[paired] += terms.division.stiffness * (lengths[paired] - apart_by) * apart_by
    return found / 2


def _close(cells: Floats, reach: float, box: Box) -> tuple[Ints, Ints]:
    """Pairs of cells within reach, each once, through the periodic edges."""
    sides = np.array([box[0], box[1], 0.0])  # a tree takes 0 for not periodic
    places = cells.copy()
    places[:, :2] %= sides[:2]
    places[:, :2] %= sides[:2]  # what was a tiny negative number is at the side itself
    pairs = cKDTree(places, boxsize=sides).query_pairs(reach, output_type="ndarray")
    return pairs[:, 0], pairs[:, 1]


def natural_lengths(scene: Scene, ages: Floats) -> Floats:
    """Natural lengths (c,) of the springs of pairs from the time since they began, NaN: none."""
    spring = Terms.of(scene).division
    return np.minimum(spring.start + spring.rate * ages, spring.end)


def spread(
    values: Floats, places: Floats, box: Box, shape: tuple[int, ...], width: float
) -> Floats:
    """Density of what cells carry, each a Gaussian, on a grid: per area.

    Parameters
    ----------
    values : (c,) array
    places : (c, 2) array
    box : (L_x, L_y)
    shape : (int, int)
        Nodes along x and y.
    width : float
        Standard deviation of the Gaussians, length.
    """
    axes = []
    for axis in (0, 1):
        nodes = np.arange(shape[axis]) * box[axis] / shape[axis]
        away = nodes[:, None] - places[:, axis] + box[axis] / 2
        away = away % box[axis] - box[axis] / 2
        weight = np.exp(-(away**2) / (2 * width**2))
        axes.append(weight / weight.sum(axis=0) * shape[axis] / box[axis])
    return np.asarray(np.einsum("c,xc,yc->xy", values, *axes, optimize=True), float)


class LateralPressure(StateAnalysis):
    """The membrane's height and the lateral pressure of the cells, as fields over the plane.

    The pressure is force per length: half of the sum over pairs of cells of their force times their
    distance, over the area; the momentum that cells exchange in the plane of their layer.
    ``results`` has ``time`` (f,), ``height`` and ``pressure`` (f, g_x, g_y), both smoothed with a
    Gaussian whose standard deviation is R_c, and ``mean`` (f,), the pressure of all the plane.

    Examples
    --------
    >>> found = LateralPressure(open_trajectory("runs/one-stem")).run(start=10).results
    >>> found.mean
    """

    columns = ("height", "pressure", "mean")

    def _measure(self, state: State) -> tuple[Any, ...]:
        data, slots = self._ts.data, state.ids - 1
        pair = np.asarray(data["pair"][slots], np.int64)
        partners = np.where(pair > FREE, np.searchsorted(state.ids, pair), -1)
        ages = state.time - np.asarray(data["pair_start"][slots], float)
        lengths = natural_lengths(self.scene, ages)
        values = virials(self.scene, state.cells, partners, lengths, state.box) / 2
        radius = self.scene.cells.radius
        height = smooth(state.height, state.box, radius)
        field = spread(values, state.cells[:, :2], state.box, height.shape, radius)
        return height, field, values.sum() / state.box.prod()
