"""The kinds of particles and the numbers by which the model names them."""

from __future__ import annotations

from enum import IntEnum


class Kind(IntEnum):
    """Kind of a particle. A scene defines LAMMPS types only for the kinds that it has."""

    DERMAL = 1
    MEMBRANE = 2
    STEM = 3
    TA = 4
    EXHAUSTED = 5
    ND = 6

    @property
    def label(self) -> str:
        """Label of its LAMMPS atom type."""
        return self.name.lower()


CELLS = (Kind.STEM, Kind.TA, Kind.EXHAUSTED, Kind.ND)
