"""Discrete mean and Gaussian curvature of a triangulated surface.

After Meyer, Desbrun, Schroeder and Barr, Discrete differential-geometry operators for
triangulated 2-manifolds (2003).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.geometry import Box, minimum_image
from lammps_skin.arrays import Floats, Ints


class Curvature(NamedTuple):
    """Curvature and its frame at each of the n particles of a surface.

    Attributes
    ----------
    mean : (n,) array
        kappa_H, 1/length; positive where the surface is convex toward its outside, the side of
        the normals.
    gaussian : (n,) array
        kappa_G, 1/length^2.
    area : (n,) array
        Mixed Voronoi area, length^2; the areas add up to that of the surface.
    normal : (n, 3) array
        Unit vectors, the area-weighted mean of the normals of the triangles around a particle.
    """

    mean: Floats
    gaussian: Floats
    area: Floats
    normal: Floats


def curvature(positions: Floats, triangles: Ints, box: Box | None = None) -> Curvature:
    """Curvature of a triangulated surface at its particles.

    The mean curvature is half the length of the cotangent-weighted sum of edges over the mixed
    area, with the sign of its component along the normal; the Gaussian curvature is the angle
    that is missing from 2 pi over the mixed area. The mixed area is the Voronoi area, and in an
    obtuse triangle half of its area for the obtuse corner and a quarter for the others.

    Parameters
    ----------
    positions : (n, 3) array
        Wrapped or not.
    triangles : (t, 3) array of int
        Indices of the corners, counterclockwise seen from outside.
    box : (L_x, L_y), optional
        Periods of x and y; none for a closed surface.

    Returns
    -------
    Curvature
        NaN for particles without triangles and at the corners of a triangle without area. At the
        rim of an open surface the values have no meaning.
    """
    edges, cross = _edges_and_cross(positions, triangles, box)
    twice_area = np.sqrt(_dot(cross, cross))
    following, last = [1, 2, 0], [2, 0, 1]
    dots = -_dot(edges[following], edges[last])  # of the two edges that leave a corner
    cotangents = np.divide(dots, twice_area, out=np.full_like(dots, np.nan), where=twice_area > 0)
    angles = np.arctan2(twice_area, dots)
    areas = _mixed_areas(edges, cotangents, dots, twice_area / 2)
    pulls = cotangents[..., None] * edges
    pulls = pulls[following] - pulls[last]

    n = len(positions)
    area = _at_particles(areas, triangles, n)
    pull = np.stack([_at_particles(pulls[..., axis], triangles, n) for axis in range(3)], axis=1)
    normal = np.stack(
        [_at_particles(np.stack([cross[:, axis]] * 3), triangles, n) for axis in range(3)], axis=1
    )
    missing_angle = 2 * np.pi - _at_particles(angles, triangles, n)
    with np.errstate(divide="ignore", invalid="ignore"):
        normal /= np.sqrt(_dot(normal, normal))[:, None]
        mean = np.sign(_dot(pull, normal)) * np.sqrt(_dot(pull, pull)) / (4 * area)
        gaussian = np.where(area > 0, missing_angle / area, np.nan)
    return Curvature(mean, gaussian, area, normal)


def _edges_and_cross(positions: Floats, triangles: Ints, box: Box | None) -> tuple[Floats, Floats]:
    """Edges (3, t, 3), the k-th opposite the k-th corner, and twice the area vectors (t, 3)."""
    a, b, c = (positions[corner] for corner in triangles.T)
    ab, ac = minimum_image(b - a, box), minimum_image(c - a, box)
    return np.stack([ac - ab, -ac, ab]), np.cross(ab, ac)


def _mixed_areas(edges: Floats, cotangents: Floats, dots: Floats, area: Floats) -> Floats:
    """Share (3, t) of each corner in the area of its triangle."""
    eighths = _dot(edges, edges) * cotangents / 8
    voronoi = eighths[[1, 2, 0]] + eighths[[2, 0, 1]]
    obtuse = dots < 0
    return np.where(obtuse.any(axis=0), np.where(obtuse, area / 2, area / 4), voronoi)


def _at_particles(values: Floats, triangles: Ints, n: int) -> Floats:
    """Sum (n,) over the triangles around each particle of values (3, t) at their corners."""
    sums = np.bincount(triangles.T.ravel(), weights=values.ravel(), minlength=n)
    return np.asarray(sums, np.float64)


def _dot(u: Floats, v: Floats) -> Floats:
    """Scalar products over the last axis."""
    products: Floats = np.einsum("...i,...i->...", u, v)
    return products
