"""Links and triangles of the membrane of a built scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lammps_skin.arrays import Ints
from lammps_skin.engine.built import section
from lammps_skin.errors import SkinError


def connectivity(directory: Path) -> tuple[Ints, Ints]:
    """Ids of linked particles (l, 2), and of the corners of triangles (t, 3).

    Each triangle is there once, lowest id first, counterclockwise seen from the side of the
    cells.
    """
    links = _members(directory / "skin.data", "Bonds", 2)
    hinges = _members(directory / "skin.data", "Dihedrals", 4)
    both = np.concatenate([hinges[:, [0, 1, 2]], hinges[:, [3, 2, 1]]])
    if not len(both):
        return links, both
    turned = (both.argmin(axis=1)[:, None] + np.arange(3)) % 3
    return links, np.unique(np.take_along_axis(both, turned, axis=1), axis=0)


def _members(path: Path, title: str, columns: int) -> Ints:
    """Ids in a section, without the number and the type of each line."""
    try:
        rows = [[int(word) for word in words[2:]] for words in section(path, title)]
        return np.array(rows, np.int64).reshape(len(rows), columns)
    except (OSError, ValueError, OverflowError):
        raise SkinError(f"data file {path}: cannot be read; build the scene again") from None
