"""chi, zeta and sigma against plain sums by hand, and in the limits."""

import cmath
import math

import numpy as np
import pytest
from lammps_skin.analysis.curvature import curvature
from lammps_skin.analysis.geometry import nearest
from lammps_skin.analysis.order import clustering, order
from lammps_skin.kinds import Kind
from meshes import sheet

BOX = (50.0, 49.363)
R_C = 1.4
ALL_KINDS = (Kind.STEM, Kind.TA, Kind.EXHAUSTED, Kind.ND)


def random_cells(seed, n=37, kinds=ALL_KINDS):
    random = np.random.default_rng(seed)
    positions = random.uniform(-20, 70, (n, 3))
    return random.choice(kinds, n), positions, random.normal(size=n), random.normal(size=n)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("of", [Kind.STEM, Kind.ND])
def test_against_sums_by_hand(seed, of):
    kinds, positions, kappa_H, kappa_G = random_cells(seed)
    mine = [n for n in range(37) if kinds[n] == of]
    assert 0 < len(mine) < 37

    def mean(values, which):
        return sum(values[n] for n in which) / len(which)

    def over_all(values):
        return mean(values, mine) - mean(values, range(37))

    sigma_x, sigma_y = (
        abs(mean([cmath.exp(2j * math.pi * r[d] / BOX[d]) for r in positions], mine))
        for d in (0, 1)
    )
    expected = (
        over_all(kappa_H) * 1.4,
        over_all(kappa_G) * 1.4,
        over_all(positions[:, 2]) / 1.4,
        math.sqrt(sigma_x**2 + sigma_y**2),
    )
    found = order(kinds, positions, kappa_H, kappa_G, BOX, R_C, of)
    assert found == pytest.approx(expected, rel=1e-12)


def test_stem_cells_are_the_default():
    cells = random_cells(1)
    assert order(*cells, BOX, R_C) == order(*cells, BOX, R_C, Kind.STEM)
    assert order(*cells, BOX, R_C) != order(*cells, BOX, R_C, Kind.ND)


def test_wrapping_and_relabelling_change_nothing():
    kinds, positions, kappa_H, kappa_G = random_cells(2)
    moved = positions + np.array([17.0, 3.0, 5.0])
    moved[:, :2] %= BOX
    shuffle = np.random.default_rng(2).permutation(37)
    found = order(kinds[shuffle], moved[shuffle], kappa_H[shuffle], kappa_G[shuffle], BOX, R_C)
    assert found == pytest.approx(order(kinds, positions, kappa_H, kappa_G, BOX, R_C), rel=1e-11)


def test_only_stem_cells_have_no_excess():
    kinds, positions, kappa_H, kappa_G = random_cells(3, kinds=(Kind.STEM,))
    found = order(kinds, positions, kappa_H, kappa_G, BOX, R_C)
    assert found[:3] == pytest.approx((0, 0, 0), abs=1e-13)
    assert 0 < found.sigma < math.sqrt(2)


@pytest.mark.filterwarnings("error")
def test_nan_without_a_cell_of_the_kind():
    cells = random_cells(4, kinds=(Kind.TA, Kind.EXHAUSTED))
    assert np.isnan(order(*cells, BOX, R_C)).all()
    none = np.empty(0, int), np.empty((0, 3)), np.empty(0), np.empty(0)
    assert np.isnan(order(*none, BOX, R_C)).all()


def test_sigma_of_cells_at_one_point():
    everywhere = np.tile([12.3, 45.6, 20.0], (16, 1)) + [[50.0 * k, 0, k] for k in range(16)]
    assert clustering(everywhere, BOX) == pytest.approx(math.sqrt(2), abs=1e-12)


def test_sigma_of_cells_spread_evenly():
    across = np.arange(4) / 4
    grid = np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2) * BOX
    assert clustering(grid, BOX) < 1e-14
    line = np.column_stack([across * BOX[0], np.full(4, 7.0)])
    assert clustering(line, BOX) == pytest.approx(1, abs=1e-14)  # spread in x, together in y


def test_sigma_of_two_cells_a_third_of_the_box_apart():
    pair = np.array([[0, 0], [BOX[0] / 3, 0]])
    assert clustering(pair, BOX) == pytest.approx(math.hypot(math.cos(math.pi / 3), 1))


def test_sigma_of_random_cells():
    places = np.random.default_rng(1).random((4000, 16, 2)) * BOX
    squares = [clustering(cells, BOX) ** 2 for cells in places]
    assert np.mean(squares) == pytest.approx(2 / 16, rel=0.05)  # 3 standard errors


def test_stem_cells_on_peaks_of_a_membrane():
    a, k = 1.0, 2 * np.pi / 20

    def height(x, y):
        return 20 + a * np.cos(k * x)

    positions, triangles, box = sheet((40, 24), height)
    x = np.array([0.0, 10.0, 0.0, 10.0])  # peak, trough, peak, trough
    above = np.column_stack([x, [2.0, 2.0, 7.0, 7.0], height(x, x) + 2.4])
    above[0] += [20.0, -box[1], 0]
    membrane = curvature(positions, triangles, box)
    index, _ = nearest(above, positions, box)
    kinds = np.array([Kind.STEM, Kind.TA, Kind.STEM, Kind.EXHAUSTED])
    found = order(kinds, above, membrane.mean[index], membrane.gaussian[index], box, R_C)
    assert found.chi_H == pytest.approx(a * k**2 / 2 * R_C, rel=0.01)
    assert found.chi_G == pytest.approx(0, abs=1e-10)
    assert found.zeta == pytest.approx(a / R_C)


@pytest.mark.parametrize("others", [0, 3])
def test_a_single_cell(others):
    """Alone it is its own reference; one of its kind is no cluster."""
    kinds = np.array([Kind.STEM] + [Kind.TA] * others)
    places = np.arange(3.0 * (1 + others)).reshape(-1, 3)
    curvature = np.arange(1.0 + others)
    found = order(kinds, places, curvature, curvature, BOX, R_C)
    assert np.isnan(found.sigma)
    assert np.isnan(found[:3]).all() == (others == 0)
