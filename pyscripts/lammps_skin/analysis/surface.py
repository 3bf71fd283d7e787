"""The membrane as a height field over a regular periodic grid.

Where the membrane is folded, the field is its upper side: at every node the highest point of the
membrane above (x, y). Triangles are filled linearly, so the field is exact for the triangulated
surface and has no gaps.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter

from lammps_skin.analysis.geometry import Box, Floats, Ints, minimum_image

EDGE_TOLERANCE = 1e-9  # in barycentric coordinates: nodes on an edge belong to both triangles


def height_field(positions: Floats, triangles: Ints, box: Box, spacing: float) -> Floats:
    """Height of the membrane at the nodes of a grid.

    Parameters
    ----------
    positions : (n, 3) array
    triangles : (t, 3) array of int
    box : (L_x, L_y)
    spacing : float
        Wanted distance of nodes, length; the nearest that divides the box is taken.

    Returns
    -------
    height : (g_x, g_y) array
        z of the upper side; node (i, j) stands at (i L_x/g_x, j L_y/g_y).

    Raises
    ------
    ValueError
        If the triangles leave some node uncovered.
    """
    sides = np.asarray(box, float)[:2]
    shape = np.maximum(np.round(sides / spacing), 1).astype(np.int64)
    a, b, c = (positions[corner] for corner in triangles.T)
    ab, ac = minimum_image(b - a, box), minimum_image(c - a, box)
    triangle, node = _candidates(a, ab, ac, sides / shape)

    a, ab, ac = a[triangle], ab[triangle], ac[triangle]
    to_node = node * (sides / shape) - a[:, :2]
    projected = _cross(ab, ac)
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = _cross(to_node, ac) / projected, _cross(ab, to_node) / projected
    inside = (u >= -EDGE_TOLERANCE) & (v >= -EDGE_TOLERANCE) & (u + v <= 1 + EDGE_TOLERANCE)

    height = np.full(shape, -np.inf)
    i, j = (node[inside] % shape).T
    z = a[inside, 2] + u[inside] * ab[inside, 2] + v[inside] * ac[inside, 2]
    np.maximum.at(height, (i, j), z)
    if not np.isfinite(height).all():
        raise ValueError(
            f"triangles: leave {np.isneginf(height).sum()} of {height.size} grid nodes uncovered; "
            "they must close over the periodic box"
        )
    return height


def smooth(height: Floats, box: Box, length: float) -> Floats:
    """Height field (g_x, g_y) convolved with a periodic Gaussian of standard deviation `length`.

    A wave of wave number q keeps exp(-(q length)^2 / 2) of its amplitude.
    """
    nodes = length * np.array(height.shape) / np.asarray(box, float)[:2]
    return np.asarray(gaussian_filter(height, nodes, mode="wrap"), np.float64)


def _candidates(a: Floats, ab: Floats, ac: Floats, steps: Floats) -> tuple[Ints, Ints]:
    """Nodes in the bounding rectangle of each triangle: triangle (k,) and node (k, 2)."""
    corners = np.stack([a[:, :2], (a + ab)[:, :2], (a + ac)[:, :2]]) / steps
    first = np.ceil(corners.min(axis=0) - EDGE_TOLERANCE).astype(np.int64)
    last = np.floor(corners.max(axis=0) + EDGE_TOLERANCE).astype(np.int64)
    wide, deep = np.maximum(last - first + 1, 0).T
    count = wide * deep
    triangle = np.repeat(np.arange(len(a)), count)
    number = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count, count)
    offset = np.stack(np.divmod(number, deep[triangle]), axis=1)
    return triangle, first[triangle] + offset


def _cross(u: Floats, v: Floats) -> Floats:
    """z component of the vector product of the projections on the x-y plane."""
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
