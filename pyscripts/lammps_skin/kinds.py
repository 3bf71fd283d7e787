"""The kinds of particles: six that every scene knows, and those of cells that a scene adds."""

from __future__ import annotations

from typing import Any, ClassVar, overload

Colour = tuple[float, float, float]  # red, green, blue, from 0 to 1

FIRST_CELL = 3
"""Kinds of this number and higher ones are cells."""


class Kind(int):
    """A kind of particle: the number by which the model names it, and what it is called.

    A scene defines LAMMPS types only for the kinds that it has.

    Parameters
    ----------
    number : int
    label : str
        Label of its LAMMPS atom type.
    name : str
        In legends and reports; the label if not given.
    colour : (red, green, blue)
        In pictures.
    """

    label: str
    name: str
    colour: Colour

    DERMAL: ClassVar[Kind]
    MEMBRANE: ClassVar[Kind]
    STEM: ClassVar[Kind]
    TA: ClassVar[Kind]
    EXHAUSTED: ClassVar[Kind]
    ND: ClassVar[Kind]

    def __new__(
        cls, number: int, label: str, name: str = "", colour: Colour = (0.5, 0.5, 0.5)
    ) -> Kind:
        kind = super().__new__(cls, number)
        kind.label, kind.name, kind.colour = label, name or label, colour
        return kind

    def __reduce__(self) -> tuple[Any, ...]:
        return Kind, (int(self), self.label, self.name, self.colour)

    def __repr__(self) -> str:
        return f"<Kind {self.label}: {int(self)}>"

    __str__ = int.__repr__


# told apart with each of the three kinds of colour blindness and, by their lightness, in grey
Kind.DERMAL = Kind(1, "dermal", colour=(0.93, 0.90, 0.82))
Kind.MEMBRANE = Kind(2, "membrane", colour=(0.87, 0.68, 0.56))
Kind.STEM = Kind(3, "stem", colour=(0.50, 0.93, 0.36))
Kind.TA = Kind(4, "ta", "TA", (0.36, 0.18, 0.50))
Kind.EXHAUSTED = Kind(5, "exhausted", "exhausted TA", (0.62, 0.56, 0.68))
Kind.ND = Kind(6, "nd", "ND", (0.80, 0.16, 0.10))

KINDS = (Kind.DERMAL, Kind.MEMBRANE, Kind.STEM, Kind.TA, Kind.EXHAUSTED, Kind.ND)
"""The kinds that every scene knows; cells that a scene adds have the numbers after these."""


@overload
def is_cell(kinds: int) -> bool: ...
@overload
def is_cell(kinds: Any) -> Any: ...
def is_cell(kinds: Any) -> Any:
    """Whether a kind, or which of an array of them (n,), are cells."""
    return kinds >= FIRST_CELL
