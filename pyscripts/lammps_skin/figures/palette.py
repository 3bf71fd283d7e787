"""Colours of the kinds of particles, in all figures."""

from __future__ import annotations

from lammps_skin.kinds import Kind

Colour = tuple[float, float, float]

SKIN: Colour = (0.96, 0.80, 0.69)
COLOURS: dict[Kind, Colour] = {
    Kind.DERMAL: (0.90, 0.84, 0.72),
    Kind.MEMBRANE: SKIN,
    Kind.STEM: (0.50, 0.93, 0.36),
    Kind.TA: (0.36, 0.18, 0.50),
    Kind.EXHAUSTED: (0.62, 0.56, 0.68),
    Kind.ND: (0.60, 0.06, 0.10),
}
NAMES: dict[Kind, str] = {
    Kind.STEM: "stem",
    Kind.TA: "TA",
    Kind.EXHAUSTED: "TA, exhausted",
    Kind.ND: "ND",
}
