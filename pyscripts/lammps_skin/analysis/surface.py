"""The membrane as a height field over a regular periodic grid.

Where the membrane is folded, the field is its upper side: at every node the highest point of the
membrane above (x, y). Triangles are filled linearly, so the field is exact for the triangulated
surface and has no gaps.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter

from lammps_skin.analysis.geometry import Box, minimum_image
from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import MembraneError

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
    MembraneError
        If the triangles leave some node uncovered.
    """
    sides = np.asarray(box, float)[:2]
    shape = np.maximum(np.round(sides / spacing), 1).astype(np.int64)
    steps = sides / shape
    a, b, c = (positions[corner] for corner in triangles.T)
    ab, ac = minimum_image(b - a, box), minimum_image(c - a, box)
    triangle, node_x, node_y = _candidates(a, ab, ac, steps)

    # columns: x, y, z of the corner a and of the edges from it
    corner, ab, ac = a[triangle].T, ab[triangle].T, ac[triangle].T
    to_node = node_x * steps[0] - corner[0], node_y * steps[1] - corner[1]
    projected = _cross(ab, ac)
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = _cross(to_node, ac) / projected, _cross(ab, to_node) / projected
        inside = (u >= -EDGE_TOLERANCE) & (v >= -EDGE_TOLERANCE) & (u + v <= 1 + EDGE_TOLERANCE)

    height = np.full(shape, -np.inf)
    i, j = node_x[inside] % shape[0], node_y[inside] % shape[1]
    z = (corner[2] + u * ab[2] + v * ac[2])[inside]
    np.maximum.at(height, (i, j), z)
    if not np.isfinite(height).all():
        missing = np.isneginf(height).sum()
        raise MembraneError(
            f"membrane: has no height at {missing} of {height.size} places of the box; heights, "
            "papillae and tips are those of a sheet that closes over the box"
        )
    return height


def smooth(height: Floats, box: Box, length: float) -> Floats:
    """Height field (g_x, g_y) convolved with a periodic Gaussian of standard deviation `length`.

    A wave of wave number q keeps exp(-(q length)^2 / 2) of its amplitude.
    """
    nodes = length * np.array(height.shape) / np.asarray(box, float)[:2]
    return np.asarray(gaussian_filter(height, nodes, mode="wrap"), np.float64)


def _candidates(a: Floats, ab: Floats, ac: Floats, steps: Floats) -> tuple[Ints, Ints, Ints]:
    """Nodes in the bounding rectangle of each triangle: triangle (k,), node in x and in y (k,)."""
    first, last = [], []
    for axis in (0, 1):
        corners = a[:, axis], a[:, axis] + ab[:, axis], a[:, axis] + ac[:, axis]
        lowest = np.minimum(np.minimum(corners[0], corners[1]), corners[2])
        highest = np.maximum(np.maximum(corners[0], corners[1]), corners[2])
        first.append(np.ceil(lowest / steps[axis] - EDGE_TOLERANCE).astype(np.int64))
        last.append(np.floor(highest / steps[axis] + EDGE_TOLERANCE).astype(np.int64))
    wide, deep = (np.maximum(b - a + 1, 0) for a, b in zip(first, last, strict=True))
    count = wide * deep
    triangle = np.repeat(np.arange(len(a)), count)
    number = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count, count)
    in_x, in_y = np.divmod(number, deep[triangle])
    return triangle, first[0][triangle] + in_x, first[1][triangle] + in_y


def _cross(u: Floats | tuple[Floats, Floats], v: Floats | tuple[Floats, Floats]) -> Floats:
    """z component of the vector product of the projections on the x-y plane."""
    return u[0] * v[1] - u[1] * v[0]
