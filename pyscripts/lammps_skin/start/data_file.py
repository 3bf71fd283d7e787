"""Writing LAMMPS data files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

import numpy as np

from lammps_skin.arrays import Floats, Ints

NUMBERS_OF_STATE = ["%d"] * 4 + ["%.17g"] * 4  # those of a cell, as state.in defines them
CHUNK = 10_000  # rows that become text together


def write_data_file(
    path: Path, labels: Sequence[str], box: Floats, ids: Ints, types: Ints, positions: Floats,
    bonds: Ints, dihedrals: Ints, state: Floats | None,
) -> None:  # fmt: skip
    """Write a data file of atom style molecular.

    Parameters
    ----------
    path : Path
    labels : sequence of str
        Of the atom types.
    box : (3,) array
        Sides; the box starts at the origin.
    ids, types : (n,) arrays of int
    positions : (n, 3) array
        In the box.
    bonds, dihedrals : (b, 2) and (d, 4) arrays of int
        IDs of their particles.
    state : (n, 8) array or None
        Values of the section ``state``; None for a file without it.
    """
    with path.open("w", encoding="utf-8") as file:
        file.write("LAMMPS data file, written by lammps-skin\n\n")
        file.write(f"{len(ids)} atoms\n{len(bonds)} bonds\n{len(dihedrals)} dihedrals\n")
        file.write(f"{len(labels)} atom types\n1 bond types\n1 dihedral types\n\n")
        for side, axis in zip(box, "xyz", strict=True):
            file.write(f"0 {side:.17g} {axis}lo {axis}hi\n")
        file.write("\nAtom Type Labels\n\n")
        file.writelines(f"{number} {label}\n" for number, label in enumerate(labels, 1))
        file.write("\nMasses\n\n")
        file.writelines(f"{number} 1\n" for number in range(1, len(labels) + 1))
        file.write("\nAtoms # molecular\n\n")
        atoms = np.column_stack([ids, np.zeros(len(ids)), types, positions])
        _write_rows(file, atoms, ["%d", "%d", "%d", "%.17g", "%.17g", "%.17g"])
        for title, members in (("Bonds", bonds), ("Dihedrals", dihedrals)):
            if len(members):
                file.write(f"\n{title}\n\n")
                _write_topology(file, members)
        if state is not None:
            file.write("\nstate\n\n")
            _write_rows(file, np.column_stack([ids, state]), ["%d", *NUMBERS_OF_STATE])


def _write_topology(file: TextIO, members: Ints) -> None:
    """Rows of the ids of the particles that bonds or dihedrals join, all of type 1."""
    numbers = np.arange(1, len(members) + 1)
    rows = np.column_stack([numbers, np.ones_like(numbers), members])
    _write_rows(file, rows, ["%d"] * rows.shape[1])


def _write_rows(file: TextIO, rows: Floats | Ints, formats: Sequence[str]) -> None:
    """What ``np.savetxt`` writes, in a third of the time."""
    line = " ".join(formats) + "\n"
    for first in range(0, len(rows), CHUNK):
        chunk = rows[first : first + CHUNK]
        file.write(line * len(chunk) % tuple(chunk.ravel().tolist()))
