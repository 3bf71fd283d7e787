"""The triangular lattice of the basement membrane, periodic in x and y."""

from __future__ import annotations

import numpy as np

from lammps_skin.arrays import Floats, Ints


def positions(lattice: tuple[int, int], spacing: float, height: float) -> Floats:
    """Positions (n, 3), row by row: rows sqrt(3)/2 apart, odd rows shifted by half a spacing."""
    nx, ny = lattice
    row, column = np.divmod(np.arange(nx * ny), nx)
    x = spacing * (column + 0.5 * (row % 2))
    y = spacing * np.sqrt(3) / 2 * row
    return np.column_stack([x, y, np.full(nx * ny, height)])


def links_and_hinges(lattice: tuple[int, int]) -> tuple[Ints, Ints]:
    """Links (3n, 2) and hinges (3n, 4), 0-based.

    Each hinge is ``(opposite, i, j, opposite)``: the link i-j, and the third corner of the
    triangle on each of its sides, so that ``(h[0], h[1], h[2])`` and ``(h[3], h[2], h[1])``
    are its two triangles, both counterclockwise seen from above.
    """
    nx, ny = lattice
    row, column = np.divmod(np.arange(nx * ny), nx)
    odd = row % 2

    def at(rows_up: int, columns_right: Ints | int) -> Ints:
        return np.asarray((row + rows_up) % ny * nx + (column + columns_right) % nx)

    here = at(0, 0)
    right, left = at(0, 1), at(0, -1)
    up_right, up_left = at(1, odd), at(1, odd - 1)
    down_right = at(-1, odd)

    links = np.concatenate(
        [np.stack([here, right], 1), np.stack([here, up_right], 1), np.stack([here, up_left], 1)]
    )
    on_left = np.concatenate([up_right, up_left, left])
    on_right = np.concatenate([down_right, right, up_right])
    return links, np.column_stack([on_left, links, on_right])


def triangles(lattice: tuple[int, int]) -> Ints:
    """Triangles (2n, 3), 0-based, counterclockwise seen from above."""
    _, hinges = links_and_hinges(lattice)
    n = lattice[0] * lattice[1]
    return np.concatenate([hinges[:n, :3], hinges[n : 2 * n, :3]])
