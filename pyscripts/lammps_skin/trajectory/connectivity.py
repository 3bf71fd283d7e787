"""Links and triangles of the membrane of a built scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lammps_skin.errors import SkinError
from lammps_skin.trajectory.frame import Ints


def connectivity(directory: Path) -> tuple[Ints, Ints]:
    """Ids of linked particles (l, 2), and of the corners of triangles (t, 3).

    Each triangle is there once, lowest id first, counterclockwise seen from the side of the
    cells.
    """
    links = _section(directory / "skin.data", "Bonds").reshape(-1, 2)
    hinges = _section(directory / "skin.data", "Dihedrals").reshape(-1, 4)
    both = np.concatenate([hinges[:, [0, 1, 2]], hinges[:, [3, 2, 1]]])
    if not len(both):
        return links, both
    turned = (both.argmin(axis=1)[:, None] + np.arange(3)) % 3
    return links, np.unique(np.take_along_axis(both, turned, axis=1), axis=0)


def _section(path: Path, title: str) -> Ints:
    """Ids in a section of a data file, without the number and the type of each line."""
    rows: list[list[int]] = []
    try:
        with path.open(encoding="utf-8") as file:
            for line in file:
                if line.strip() == title:
                    break
            next(file, None)
            for line in file:
                if not line.strip():
                    break
                rows.append([int(word) for word in line.split()[2:]])
    except (OSError, ValueError):
        raise SkinError(f"data file {path}: cannot be read; build the scene again") from None
    return np.array(rows, np.int64)
