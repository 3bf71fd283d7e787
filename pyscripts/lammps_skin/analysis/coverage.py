"""How much of the membrane is covered by cells, and how many cells there are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lammps_skin.analysis.geometry import Box, images, wrapped
from lammps_skin.arrays import Bools, Floats, Ints
from lammps_skin.kinds import Kind


def covered(membrane: Floats, cells: Floats, box: Box, reach: float) -> Bools:
    """Which membrane particles have the centre of a cell within reach.

    Parameters
    ----------
    membrane : (n, 3) array
    cells : (c, 3) array
    box : (L_x, L_y)
    reach : float
        Length. The natural choice is lambda (R_c + R_m), where adhesion ends and beyond which
        cells are removed: a cell in contact with a flat membrane then covers a disc of radius
        (R_c + R_m) sqrt(lambda^2 - 1). Runs with different lambda compare at equal reach only.

    Returns
    -------
    (n,) array of bool
        Distances are straight, so a cell may also cover an adjacent fold.
    """
    from scipy.spatial import cKDTree

    farthest = np.nextafter(reach, np.inf)  # the search leaves out what is as far as its bound
    places, _ = images(wrapped(cells, box), box, farthest)  # faster than a tree that is periodic
    distance, _ = cKDTree(places).query(wrapped(membrane, box), distance_upper_bound=farthest)
    return np.asarray(distance <= reach)


def coverage(
    membrane: Floats, cells: Floats, box: Box, reach: float, area: Floats | None = None
) -> float:
    """Fraction of the membrane that is `covered`, between 0 and 1.

    Parameters
    ----------
    membrane, cells, box, reach
        As of `covered`.
    area : (n,) array, optional
        Area of each membrane particle, for the fraction of the membrane's present area; without
        it every particle counts the same, which is the fraction of the area at rest.
    """
    return float(np.average(covered(membrane, cells, box, reach), weights=area))


def count_by_kind(kinds: Sequence[int] | Ints, of: Sequence[Kind]) -> dict[Kind, int]:
    """Number of particles of each kind, 0 for a kind that does not occur."""
    number = np.bincount(np.asarray(kinds, np.int64), minlength=max(of, default=0) + 1)
    return {kind: int(number[kind]) for kind in of}
