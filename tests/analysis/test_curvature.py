"""Curvature against surfaces of known shape, Gauss-Bonnet, and what must not change it."""

import numpy as np
import pytest
from lammps_skin.analysis.curvature import curvature
from meshes import Waves, cylinder, icosphere, rough_sheet, sheet


def flat(x, y):
    return 0 * x


def test_plane_has_no_curvature():
    found = curvature(*sheet((8, 6), flat))
    np.testing.assert_allclose(found.mean, 0, atol=1e-13)
    np.testing.assert_allclose(found.gaussian, 0, atol=1e-13)
    np.testing.assert_allclose(found.area, 0.5**2 * np.sqrt(3) / 2, rtol=1e-13)
    np.testing.assert_allclose(found.normal, [[0, 0, 1]] * 48, atol=1e-13)


@pytest.mark.parametrize("radius", [0.7, 3.0])
def test_sphere(radius):
    found = curvature(*icosphere(4, radius))
    np.testing.assert_allclose(found.mean, 1 / radius, rtol=1e-5)
    np.testing.assert_allclose(found.gaussian, 1 / radius**2, rtol=1.5e-3)
    np.testing.assert_allclose(found.area.sum(), 4 * np.pi * radius**2, rtol=1.5e-3)


def test_gaussian_curvature_of_the_sphere_converges_with_order_two():
    worst = [np.abs(curvature(*icosphere(level, 1.0)).gaussian - 1).max() for level in (2, 3, 4)]
    orders = np.log2(np.divide(worst[:-1], worst[1:]))
    assert ((orders > 1.8) & (orders < 2.2)).all(), orders


def test_cylinder_is_exact():
    found = curvature(*cylinder((6, 20), 3.0))
    np.testing.assert_allclose(found.mean, 1 / 6, rtol=1e-12)
    np.testing.assert_allclose(found.gaussian, 0, atol=1e-12)


def test_peak_pit_and_saddle():
    # z = a (cos kx + cos ky): at its stationary points the second derivatives are +-a k^2
    a, shape = 0.4, (40, 40)
    _, _, box = sheet(shape, flat)
    kx, ky = 2 * np.pi / np.array(box)
    positions, triangles, box = sheet(shape, lambda x, y: a * (np.cos(kx * x) + np.cos(ky * y)))
    found = curvature(positions, triangles, box)
    peak, saddle_x, saddle_y, pit = 0, 20, 20 * 40, 20 * 40 + 20
    bend_x, bend_y = a * kx**2, a * ky**2
    for particle, mean, gaussian in [
        (peak, (bend_x + bend_y) / 2, bend_x * bend_y),
        (pit, -(bend_x + bend_y) / 2, bend_x * bend_y),
        (saddle_x, (bend_y - bend_x) / 2, -bend_x * bend_y),
        (saddle_y, (bend_x - bend_y) / 2, -bend_x * bend_y),
    ]:
        assert found.mean[particle] == pytest.approx(mean, rel=5e-3, abs=2e-5)
        assert found.gaussian[particle] == pytest.approx(gaussian, rel=5e-3)


@pytest.mark.parametrize("seed", [1, 2])
def test_smooth_field_converges_with_order_two(seed):
    errors = []
    for finer in (2, 4, 8):
        shape, spacing = (16 * finer, 18 * finer), 0.5 / finer
        _, _, box = sheet(shape, flat, spacing)
        waves = Waves(seed, box, slope=1.0)
        positions, triangles, box = sheet(shape, waves, spacing)
        found = curvature(positions, triangles, box)
        mean, gaussian = waves.curvatures(positions[:, 0], positions[:, 1])
        both = found.mean - mean, found.gaussian - gaussian
        errors.append([f(e) for e in both for f in (np.std, lambda e: np.abs(e).max())])
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert ((orders > 1.9) & (orders < 2.1)).all(), orders
    assert np.max(errors[-1]) < 4e-4  # of curvatures up to 0.35 and 0.09


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_gauss_bonnet_and_area_on_a_rough_membrane(seed):
    positions, triangles, box = rough_sheet(seed)
    found = curvature(positions, triangles, box)
    assert np.abs(found.gaussian).max() > 1
    assert abs((found.area * found.gaussian).sum()) < 1e-10
    a, b, c = positions[triangles.T]
    ab, ac = (d - np.round(d / [*box, np.inf]) * [*box, 0] for d in (b - a, c - a))
    total = np.linalg.norm(np.cross(ab, ac), axis=1).sum() / 2
    assert found.area.sum() == pytest.approx(total, rel=1e-13)


def test_gauss_bonnet_on_a_dented_sphere():
    positions, triangles = icosphere(3, 2.0)
    positions += np.random.default_rng(1).normal(0, 0.05, positions.shape)
    found = curvature(positions, triangles)
    assert (found.area * found.gaussian).sum() == pytest.approx(4 * np.pi, abs=1e-10)


def test_translation_and_wrapping_change_nothing():
    positions, triangles, box = rough_sheet(4)
    moved = positions + np.array([3.21, -4.56, 7.0])
    moved[:, :2] %= box
    expected, found = (curvature(x, triangles, box) for x in (positions, moved))
    for before, after in zip(expected, found, strict=True):
        np.testing.assert_allclose(after, before, rtol=1e-10, atol=1e-11)


def test_relabelling_changes_nothing():
    positions, triangles, box = rough_sheet(5)
    random = np.random.default_rng(5)
    new_label = random.permutation(len(positions))
    old_label = np.argsort(new_label)
    turned = np.array([np.roll(t, random.integers(3)) for t in random.permutation(triangles)])
    expected = curvature(positions, triangles, box)
    found = curvature(positions[old_label], new_label[turned], box)
    for before, after in zip(expected, found, strict=True):
        np.testing.assert_allclose(after[new_label], before, rtol=1e-11, atol=1e-12)


def test_orientation_decides_the_sign_of_the_mean_curvature_only():
    positions, triangles, box = rough_sheet(6)
    up, down = curvature(positions, triangles, box), curvature(positions, triangles[:, ::-1], box)
    np.testing.assert_allclose(down.mean, -up.mean, rtol=1e-11)
    np.testing.assert_allclose(down.normal, -up.normal, rtol=1e-11)
    np.testing.assert_allclose(down.gaussian, up.gaussian, rtol=1e-11)
    np.testing.assert_allclose(down.area, up.area, rtol=1e-11)


def test_scaling():
    positions, triangles, box = rough_sheet(7)
    one = curvature(positions, triangles, box)
    two = curvature(2 * positions, triangles, np.multiply(box, 2))
    np.testing.assert_allclose(two.mean, one.mean / 2, rtol=1e-11)
    np.testing.assert_allclose(two.gaussian, one.gaussian / 4, rtol=1e-11)
    np.testing.assert_allclose(two.area, one.area * 4, rtol=1e-11)


def test_mixed_area_of_an_acute_triangle_is_the_voronoi_area():
    corners = np.array([[0, 0, 0], [4, 0, 0], [2, 3, 0]], float)
    circumcentre = [2, 5 / 6]
    x, y = np.array([corners[0, :2], [2, 0], circumcentre, [1, 1.5]]).T
    voronoi = (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    found = curvature(corners, np.array([[0, 1, 2]])).area
    np.testing.assert_allclose(found, [voronoi, voronoi, 6 - 2 * voronoi], rtol=1e-13)


@pytest.mark.parametrize("turn", range(3))
def test_mixed_area_of_an_obtuse_triangle(turn):
    corners = np.roll([[0, 0, 0], [4, 0, 0], [1, 1, 0]], turn, axis=0).astype(float)
    found = curvature(corners, np.array([[0, 1, 2]])).area
    np.testing.assert_allclose(found, np.roll([0.5, 0.5, 1.0], turn), rtol=1e-13)


@pytest.mark.filterwarnings("error")
def test_no_value_where_there_is_none():
    positions, triangles, box = rough_sheet(8)
    alone = np.vstack([positions, [1.0, 1.0, 5.0]])
    found = curvature(alone, triangles, box)
    assert np.isnan([found.mean[-1], found.gaussian[-1], *found.normal[-1]]).all()
    assert found.area[-1] == 0
    assert np.isfinite(found.mean[:-1]).all()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("part", [0.0, 0.25], ids=["two corners in one place", "three in a line"])
def test_no_mean_curvature_at_a_triangle_without_area(part):
    positions, triangles, box = sheet((8, 6), flat)
    i, j, k = triangles[10]  # j and k stand side by side in a row
    positions[i] = positions[j] + part * (positions[k] - positions[j])
    found = curvature(positions, triangles, box)
    assert np.isnan(found.mean[[i, j, k]]).all()
    around = triangles[np.isin(triangles, i).any(axis=1)]
    assert np.isfinite(np.delete(found.mean, around.ravel())).all()
