"""Whether cells make one layer on the membrane, and whether the membrane stays a sheet.

A basal layer is one layer of cells on the membrane. Cells that hang in bunches on a few membrane
particles, which they have drawn out as tethers, cover the membrane just as well: coverage and
the order parameters do not tell the two apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lammps_skin.analysis.geometry import Box, minimum_image, periodic_tree
from lammps_skin.arrays import Floats, Ints

COVERED = 0.9  # fraction of the membrane from which on a tissue is taken for covered
LAYER = 0.8  # fraction of cells with none below from which on it is a basal layer


class Layering(NamedTuple):
    """How the c cells lie over each other and on the membrane; NaN without cells.

    Attributes
    ----------
    none_below : float
        Fraction of the cells that have no other cell straight below: closer in the plane than
        R_c, and lower by more than R_c.
    number_below : float
        Mean number of the cells straight below a cell.
    most_on_one : float
        Most cells whose nearest membrane particle is the same one.
    holding : float
        Fraction of the membrane particles that are nearest to a cell.
    """

    none_below: float
    number_below: float
    most_on_one: float
    holding: float


class Sheet(NamedTuple):
    """How far the membrane is stretched.

    Attributes
    ----------
    area : float
        Of all triangles, length^2.
    long_link : float
        99th percentile of the lengths of links, length.
    """

    area: float
    long_link: float


def number_below(cells: Floats, box: Box, radius: float) -> Ints:
    """Number (c,) of other cells straight below each of the cells (c, 3), see `Layering`."""
    closer = np.nextafter(radius, 0.0)
    pairs = periodic_tree(cells[:, :2], box).query_pairs(closer, output_type="ndarray")
    rise = cells[pairs[:, 0], 2] - cells[pairs[:, 1], 2]
    upper = np.concatenate([pairs[rise > radius, 0], pairs[rise < -radius, 1]])
    return np.bincount(upper, minlength=len(cells))


def layering(cells: Floats, below: Ints, particles: int, box: Box, radius: float) -> Layering:
    """How cells lie over each other and on the membrane.

    Parameters
    ----------
    cells : (c, 3) array
        Positions, wrapped or not.
    below : (c,) array of int
        Index of the membrane particle nearest to each cell.
    particles : int
        Number of membrane particles.
    box : (L_x, L_y)
    radius : float
        R_c.
    """
    if not len(cells):
        return Layering(*[np.nan] * 4)
    number = number_below(cells, box, radius)
    held = np.bincount(below, minlength=particles)
    return Layering(
        float((number == 0).mean()), float(number.mean()), float(held.max()),
        float((held > 0).mean()),
    )  # fmt: skip


def links(triangles: Ints) -> Ints:
    """Indices (2, l) of the ends of each side of triangles (t, 3), once for those that share it."""
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    particles = int(triangles.max(initial=0)) + 1
    numbers = np.unique(ends[:, 0] * particles + ends[:, 1])
    return np.stack(np.divmod(numbers, particles))


def sheet(positions: Floats, triangles: Ints, ends: Ints, box: Box | None = None) -> Sheet:
    """How far a triangulated membrane is stretched.

    Parameters
    ----------
    positions : (n, 3) array
        Wrapped or not.
    triangles : (t, 3) array of int
        Indices of the corners.
    ends : (2, l) array of int
        The `links` of the triangles, which are the same in all frames of a trajectory.
    box : (L_x, L_y), optional
        Periods of x and y; none for a closed surface.
    """
    a, b, c = (positions[corner] for corner in triangles.T)
    twice = np.cross(minimum_image(b - a, box), minimum_image(c - a, box))
    area = float(np.sqrt(np.einsum("ti,ti->t", twice, twice)).sum() / 2)
    link = minimum_image(positions[ends[1]] - positions[ends[0]], box)
    lengths = np.sqrt(np.einsum("li,li->l", link, link))
    return Sheet(area, float(np.quantile(lengths, 0.99)))


def remark(time: float, coverage: float, none_below: float) -> str | None:
    """One line if a covered tissue is no basal layer, for those who look at its statistics."""
    if not (coverage >= COVERED and none_below < LAYER):
        return None
    return (
        f"not a basal layer at t = {time:g}: {1 - none_below:.0%} of the cells have another cell "
        f"straight below them (in one layer it is at most {1 - LAYER:.0%}): statistics of papillae "
        "and of cells on their tips describe a heap of cells"
    )


def last_remark(table: Mapping[str, Sequence[float]] | NDArray[np.void]) -> str | None:
    """The remark on the last frame of a table of observables to which one applies."""
    columns = (table[name] for name in ("time", "coverage", "none_below"))
    lines = (remark(*row) for row in list(zip(*columns, strict=True))[::-1])
    return next((line for line in lines if line), None)
