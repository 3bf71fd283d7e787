"""The height field of the membrane."""

from itertools import product

import numpy as np
import pytest
from lammps_skin.analysis.surface import height_field, smooth
from lammps_skin.errors import MembraneError
from meshes import rough_sheet, sheet
from scipy.interpolate import LinearNDInterpolator

NINE = list(product((-1, 0, 1), repeat=2))


def grid(shape, box):
    return np.meshgrid(
        *(np.arange(n) * side / n for n, side in zip(shape, box, strict=True)), indexing="ij"
    )


@pytest.mark.parametrize("spacing", [0.35, 0.5, 1.3])
def test_is_the_linear_interpolation_of_the_particles(spacing):
    # so little noise that the Delaunay triangles of the projection are those of the membrane
    positions, triangles, box = rough_sheet(1, noise=0.02)
    tiles = [positions + np.array([i * box[0], j * box[1], 0]) for i, j in NINE]
    interpolated = LinearNDInterpolator(*np.split(np.concatenate(tiles), [2], axis=1))
    wrapped = positions.copy()
    wrapped[:, :2] %= box
    found = height_field(wrapped, triangles, box, spacing)
    assert found.shape == tuple(np.round(np.array(box) / spacing).astype(int))
    np.testing.assert_allclose(found, interpolated(*grid(found.shape, box))[..., 0], atol=1e-12)


def test_is_the_upper_side_of_a_fold():
    # an overturned wave: x = u + a sin(2 pi u/L), z = cos(2 pi u/L - 1)
    a = 5.0
    positions, triangles, box = sheet((240, 8), lambda x, y: 0 * x, 0.05)
    k = 2 * np.pi / box[0]

    def wave(u):
        return u + a * np.sin(k * u), np.cos(k * u - 1)

    positions[:, 0], positions[:, 2] = wave(positions[:, 0])
    found = height_field(positions, triangles, box, 0.1)

    u = np.linspace(-box[0], 2 * box[0], 300_001)
    x, z = wave(u)
    expected = []
    for node in np.arange(120) * box[0] / 120:
        crossing = np.flatnonzero((x[:-1] - node) * (x[1:] - node) <= 0)
        expected.append((z[crossing].max(), z[crossing].min()))
    upper, lower = np.transpose(expected)
    assert (upper - lower > 0.5).mean() > 0.2
    np.testing.assert_allclose(found, np.broadcast_to(upper[:, None], found.shape), atol=0.01)


def test_nodes_on_edges_up_to_rounding_are_covered():
    flat, triangles, box = sheet((14, 12), lambda x, y: 0 * x)
    for steps in np.random.default_rng(1).integers(-40, 40, (50, 2)):
        positions = flat.copy()
        positions[:, :2] += steps * [0.1, box[1] / 60]
        positions[:, :2] %= box
        assert (height_field(positions, triangles, box, 0.1) == 0).all()


def test_a_hole_is_an_error():
    positions, triangles, box = sheet((10, 10), lambda x, y: 0 * x)
    with pytest.raises(MembraneError, match=r"^membrane: has no height at \d+ of \d+ places"):
        height_field(positions, triangles[1:], box, 0.1)


def test_smoothing_damps_waves_by_the_gaussian_factor():
    box, shape, length = (20.0, 15.0), (80, 75), 0.8
    x, y = grid(shape, box)
    q = 2 * np.pi * np.array([2, 3]) / box
    wave = np.cos(q[0] * x + q[1] * y)
    factor = np.exp(-(q @ q) * length**2 / 2)
    np.testing.assert_allclose(smooth(5 + wave, box, length), 5 + factor * wave, atol=2e-4)
