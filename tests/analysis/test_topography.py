"""Prominence against its definition by brute force on the infinite plane."""

import heapq

import numpy as np
import pytest
from lammps_skin.analysis.topography import peaks

TILES = 7


def brute_force(height):
    """Peaks and saddles of a field repeated TILES x TILES times, of the copies in the middle."""
    plane = np.tile(height, (TILES, TILES))
    gx, gy = height.shape
    middle = TILES // 2

    def around(i, j):
        for k in range(max(i - 1, 0), min(i + 2, plane.shape[0])):
            for m in range(max(j - 1, 0), min(j + 2, plane.shape[1])):
                if (k, m) != (i, j):
                    yield k, m

    def saddle(start):
        """Lowest point of the best way to any other node at least as high."""
        seen, edge, lowest = {start}, [(-plane[start], start)], plane[start]
        while True:
            z, node = heapq.heappop(edge)
            lowest = min(lowest, -z)
            if node != start and -z >= plane[start]:
                return lowest
            for other in around(*node):
                if other not in seen:
                    seen.add(other)
                    heapq.heappush(edge, (-plane[other], other))

    found = {}
    for i in range(gx):
        for j in range(gy):
            node = middle * gx + i, middle * gy + j
            if all(plane[node] > plane[other] for other in around(*node)):
                found[i * gy + j] = saddle(node)
    return found


@pytest.mark.parametrize("seed", range(12))
def test_random_fields(seed):
    random = np.random.default_rng(seed)
    height = random.random(random.integers(4, 9, 2))
    found = peaks(height)
    assert dict(zip(found.node.tolist(), found.saddle.tolist(), strict=True)) == brute_force(height)
    np.testing.assert_array_equal(found.height, height.ravel()[found.node])
    assert (np.diff(found.height) < 0).all()


@pytest.mark.parametrize("seed", range(3))
def test_rolling_moves_the_peaks_along(seed):
    height = np.random.default_rng(seed).random((9, 7))
    one, other = peaks(height), peaks(np.roll(height, (4, 5), axis=(0, 1)))
    i, j = np.divmod(one.node, 7)
    np.testing.assert_array_equal((i + 4) % 9 * 7 + (j + 5) % 7, other.node)
    np.testing.assert_array_equal(one.saddle, other.saddle)
    np.testing.assert_array_equal(np.roll(one.basin, (4, 5), axis=(0, 1)), other.basin)


def test_basins_lead_up_to_their_peak():
    height = np.random.default_rng(5).random((12, 10))
    found = peaks(height)
    np.testing.assert_array_equal(found.basin.ravel()[found.node], np.arange(len(found.node)))
    assert (height <= found.height[found.basin]).all()


def test_a_lower_peak_joins_the_higher_one_whose_island_it_meets():
    height = np.zeros((8, 8))
    height[2, 1:6] = 5, 3, 4, 2, 6
    found = peaks(height)
    high, middle, low = (np.flatnonzero(found.height == z)[0] for z in (6, 5, 4))
    assert found.saddle[[high, middle, low]].tolist() == [0, 2, 3]
    assert found.joins[[middle, low]].tolist() == [high, middle]


@pytest.mark.parametrize(
    "height",
    [
        np.full((6, 5), 22.4),
        np.repeat(np.cos(np.arange(8) * np.pi / 4)[:, None], 6, axis=1),
        np.repeat(np.cos(np.arange(8) * np.pi / 4)[None, :], 6, axis=0),
        np.cos(np.add.outer(np.arange(8), np.arange(8)) * np.pi / 4),
        np.where(np.indices((7, 7)).sum(axis=0) == 6, -1.0, 0.0),
    ],
    ids=["plain", "ridge along y", "ridge along x", "diagonal ridge", "ditch"],
)
def test_what_runs_through_the_box_has_no_prominence(height):
    found = peaks(height)
    np.testing.assert_array_equal(found.saddle, found.height)


def test_a_plain_is_one_peak():
    assert len(peaks(np.full((20, 30), 22.4)).node) == 1


def test_island_in_a_moat_on_a_plain():
    height = np.zeros((12, 12))
    height[3:8, 3:8] = -1.0
    height[5, 5] = 0.5
    found = peaks(height)
    assert (found.height[0], found.saddle[0]) == (0.5, -1.0)
    assert (found.saddle[1:] == found.height[1:]).all()
