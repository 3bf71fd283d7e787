"""Peaks of a periodic height field and their topographic prominence."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from lammps_skin.arrays import Floats, Ints

STEPS = [(0, 1), (1, -1), (1, 0), (1, 1)]  # to half of the eight neighbors of a node
Shift = tuple[int, int]


class Peaks(NamedTuple):
    """The p local maxima of a height field, highest first.

    Attributes
    ----------
    node : (p,) array of int
        Flat index of the grid node.
    height : (p,) array
    saddle : (p,) array
        Height of the highest pass on the way to a peak at least as high, periodic images of the
        peak itself included. Height minus saddle is the prominence.
    joins : (p,) array of int
        The higher peak into whose island a peak's island merges at its saddle; the peak itself
        where the island first meets its own periodic image.
    basin : (g_x, g_y) array of int
        The peak that is reached from a node by steepest ascent.
    """

    node: Ints
    height: Floats
    saddle: Floats
    joins: Ints
    basin: Ints


def peaks(height: Floats) -> Peaks:
    """Local maxima of a periodic height field (g_x, g_y), by sinking sea level.

    As the level sinks, islands appear at the maxima and merge at passes, where the one with the
    lower peak ends. An island that meets its own periodic image ends as well: on the infinite
    plane that image is another peak of the same height. So a plain between dimples and a ridge
    that runs through the box have no prominence.
    """
    top, boxes = _ascend(height)
    nodes = np.unique(top)
    nodes = nodes[np.lexsort([nodes, height.ravel()[nodes]])][::-1]
    number = np.empty(height.size, np.int64)
    number[nodes] = np.arange(len(nodes))
    basin = number[top]
    saddle, joins = _flood(len(nodes), _passes(height, basin, boxes))
    return Peaks(nodes, height.ravel()[nodes], saddle, joins, basin)


@lru_cache(maxsize=8)  # all steps in a field of one shape
def _neighbors(shape: tuple[int, ...], step: Shift) -> tuple[Ints, Ints]:
    """Flat index (g_x, g_y) of the node one step away, and the boxes (g_x, g_y, 2) crossed."""
    i, j = np.indices(shape)
    (box_i, i), (box_j, j) = np.divmod(i + step[0], shape[0]), np.divmod(j + step[1], shape[1])
    return i * shape[1] + j, np.stack([box_i, box_j], axis=-1)


def _ascend(height: Floats) -> tuple[Ints, Ints]:
    """Flat index of the maximum reached from each node, and the boxes crossed on the way.

    Each step goes to the highest of the eight neighbors; the index decides between equals.
    """
    heights = height.ravel()
    up = np.arange(height.size).reshape(height.shape)
    boxes = np.zeros((*height.shape, 2), np.int64)
    for step in STEPS + [(-x, -y) for x, y in STEPS]:
        there, crossed = _neighbors(height.shape, step)
        better = (heights[there] > heights[up]) | ((heights[there] == heights[up]) & (there > up))
        up = np.where(better, there, up)
        boxes = np.where(better[..., None], crossed, boxes)
    while True:
        further = up.ravel()[up]
        if np.array_equal(further, up):
            return up, boxes
        boxes = boxes + boxes.reshape(-1, 2)[up]
        up = further


def _passes(height: Floats, basin: Ints, boxes: Ints) -> list[tuple[float, int, int, Shift]]:
    """Passes between neighboring basins, highest first: height, basins a and b, boxes.

    From the peak of a over the pass one comes to the image of the peak of b in the box that is
    `boxes` away. Of several passes between the same two images only the highest is kept.
    """
    found = []
    for step in STEPS:
        there, crossed = _neighbors(height.shape, step)
        boxes_there, basin_there = boxes.reshape(-1, 2)[there], basin.ravel()[there]
        shift = crossed + boxes_there - boxes
        apart = (basin != basin_there) | shift.any(axis=-1)
        passing = np.minimum(height[apart], height.ravel()[there[apart]])
        found.append((passing, basin[apart], basin_there[apart], *shift[apart].T))
    z, a, b, x, y = (np.concatenate(parts) for parts in zip(*found, strict=True))
    swapped = a > b
    a, b = np.minimum(a, b), np.maximum(a, b)
    x, y = np.where(swapped, -x, x), np.where(swapped, -y, y)
    order = np.argsort(-z, kind="stable")
    _, first = np.unique(_numbered(a, b, x, y)[order], return_index=True)
    highest = order[np.sort(first)]
    columns = (column[highest].tolist() for column in (z, a, b, x, y))
    return [(z, a, b, (x, y)) for z, a, b, x, y in zip(*columns, strict=True)]


def _numbered(*columns: Ints) -> Ints:
    """A whole number (k,) for each row of columns (k,), the same for the same row alone."""
    number = np.zeros(len(columns[0]), np.int64)
    for column in columns:
        least, most = column.min(initial=0), column.max(initial=0)
        number = number * (most - least + 1) + column - least
    return number


def _flood(n: int, passes: list[tuple[float, int, int, Shift]]) -> tuple[Floats, Ints]:
    """Saddle of each of n peaks (numbered from the highest), and the peak it joins there."""
    saddle = np.full(n, np.nan)
    joins = np.arange(n)
    parent = list(range(n))
    offset = [(0, 0)] * n  # boxes from the parent to the peak

    def root(peak: int) -> tuple[int, Shift]:
        x = y = 0
        while parent[peak] != peak:
            x, y = x + offset[peak][0], y + offset[peak][1]
            peak = parent[peak]
        return peak, (x, y)

    for z, a, b, shift in passes:
        (root_a, from_a), (root_b, from_b) = root(a), root(b)
        gap = (from_a[0] + shift[0] - from_b[0], from_a[1] + shift[1] - from_b[1])
        if root_a == root_b:
            if gap != (0, 0) and np.isnan(saddle[root_a]):
                saddle[root_a] = z
            continue
        if root_a > root_b:
            root_a, root_b, gap = root_b, root_a, (-gap[0], -gap[1])
        parent[root_b], offset[root_b] = root_a, gap
        if np.isnan(saddle[root_b]):
            saddle[root_b], joins[root_b] = z, root_a
        elif np.isnan(saddle[root_a]):
            saddle[root_a] = z  # through the other island it meets its own image
    return saddle, joins
