"""Energy of every term over time, from the log of a run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.errors import SkinError
from lammps_skin.model.terms import FIX_TERMS, TERMS

COLUMNS = {
    "Time": "time",
    **{f"c_{name}": name for name in TERMS},
    "f_wall": "wall",
    **{f"f_cells[{n}]": name for n, name in enumerate(FIX_TERMS, 1)},
}


def read_energies(path: str | Path) -> dict[str, Floats]:
    """Energies in the thermo output of a log.lammps.

    Parameters
    ----------
    path : path
        Also of a run that has not ended. The log may hold several runs, the later ones going on
        from, or back to, some step of the earlier: every step is there once, as it was last.

    Returns
    -------
    dict of (m,) arrays
        "time", the terms of the model that the scene has, and "total", their sum: energy.

    Raises
    ------
    SkinError
        If there is no such output.
    """
    rows: dict[float, dict[str, float]] = {}
    try:
        for row in _rows(Path(path)):
            rows[row["Step"]] = row
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not text"
        raise SkinError(f"log {path}: {reason}") from None
    if not rows:
        raise SkinError(f"log {path}: holds no thermo output")
    ordered = [rows[step] for step in sorted(rows)]
    if any(row.keys() != ordered[0].keys() for row in ordered):
        raise SkinError(f"log {path}: its thermo output has other columns later on")
    found = {
        name: np.array([row[column] for row in ordered])
        for column, name in COLUMNS.items()
        if column in ordered[0]
    }
    terms = [values for name, values in found.items() if name != "time"]
    return {**found, "total": np.sum(terms, axis=0)}


def _rows(path: Path) -> Iterator[dict[str, float]]:
    """Rows of thermo output: what stands below a heading and has a number for every column."""
    heading: list[str] = []
    with path.open(encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words[:2] == ["Step", "Time"]:
                heading = words
            elif line.startswith("Loop time"):
                heading = []
            elif heading and len(words) == len(heading) and line.endswith("\n"):
                try:
                    yield dict(zip(heading, map(float, words), strict=True))
                except ValueError:  # a warning of as many words
                    continue
