"""Distances in a box that is periodic in x and y and open in z."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lammps_skin.arrays import Floats, Ints

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

Box = Sequence[float] | Floats  # L_x, L_y; what follows is not looked at


def minimum_image(vectors: Floats, box: Box | None) -> Floats:
    """Shortest periodic images of vectors (..., 2 or 3); the vectors themselves without a box."""
    if box is None:
        return vectors
    sides = np.asarray(box, float)[:2]
    shortest = np.array(vectors, float)
    for axis, side in enumerate(sides):
        shortest[..., axis] -= side * np.rint(shortest[..., axis] / side)
    return shortest


def wrapped(positions: Floats, box: Box) -> Floats:
    """Positions (..., 2 or 3) with x in [0, L_x) and y in [0, L_y)."""
    sides = np.asarray(box, float)[:2]
    inside = np.array(positions, float)
    inside[..., :2] %= sides
    inside[..., :2][inside[..., :2] >= sides] = 0.0  # where the remainder was rounded up
    return inside


def images(points: Floats, box: Box, reach: Floats | float) -> tuple[Floats, Ints]:
    """Points in the box and their periodic images near it.

    Parameters
    ----------
    points : (n, 2 or 3) array
        With x in [0, L_x] and y in [0, L_y].
    box : (L_x, L_y)
    reach : float or (n,) array
        Largest distance in x or y of an image from the box.

    Returns
    -------
    places : (k, 2 or 3) array
    index : (k,) array of int
        Of the point of each.
    """
    shifts = [np.array([-1.0, 0.0, 1.0]) * side for side in box[:2]]
    reaching = [
        [
            (points[:, axis] + shift > -reach) & (points[:, axis] + shift < box[axis] + reach)
            if shift
            else np.ones(len(points), bool)
            for shift in shifts[axis]
        ]
        for axis in (0, 1)
    ]
    places, index = [], []
    for i, j in np.ndindex(3, 3):
        here = np.flatnonzero(reaching[0][i] & reaching[1][j])
        place = np.array(points[here], float)
        place[:, :2] += shifts[0][i], shifts[1][j]
        places.append(place)
        index.append(here)
    return np.concatenate(places), np.concatenate(index)


def periodic_tree(points: Floats, box: Box) -> cKDTree:
    """Search tree of points (n, 2 or 3), periodic in x and y."""
    from scipy.spatial import cKDTree

    open_axis = 0.0
    sides = np.array([box[0], box[1], open_axis])
    return cKDTree(wrapped(points, box), boxsize=sides[: points.shape[1]])


def nearest(points: Floats, targets: Floats, box: Box) -> tuple[Ints, Floats]:
    """Nearest target of every point.

    Parameters
    ----------
    points : (p, 3) array
    targets : (n, 3) array
    box : (L_x, L_y)

    Returns
    -------
    index : (p,) array of int
        Of the nearest target, through the periodic edges; n if there is none.
    distance : (p,) array
        Infinite if there is no target.
    """
    distance, index = periodic_tree(targets, box).query(points)
    return np.asarray(index, np.int64), np.asarray(distance, np.float64)
