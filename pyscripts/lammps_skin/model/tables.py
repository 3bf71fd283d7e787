"""Potential tables in the formats of ``pair_style table`` and ``bond_style table``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lammps_skin.arrays import Floats

Potential = Callable[[Floats], Floats]


@dataclass(frozen=True)
class Table:
    """One tabulated term.

    Parameters
    ----------
    keyword : str
        Name of the section in the file.
    energy, force : callable
        Energy and force -dU/dr at distances r, vectorised.
    distances : (n,) array
        Grid, uniform in r^2 for a pair and in r for a bond.
    squared : bool
        Whether the grid is uniform in r^2.
    """

    keyword: str
    energy: Potential
    force: Potential
    distances: Floats
    squared: bool

    @property
    def outer(self) -> float:
        """Largest distance, the cutoff of a pair."""
        return float(self.distances[-1])

    def same_as(self, other: Table) -> bool:
        """Whether both have the same values."""
        r = self.distances
        return np.array_equal(r, other.distances) and np.array_equal(
            self.energy(r), other.energy(r)
        )

    def interpolation_error(self) -> float:
        """Largest error of the force between grid points, linear interpolation.

        Sampled at fractions of each interval; relative to the force there or to the median of
        the forces that are not 0, whichever is larger. `pair_style table` interpolates F/r
        over r^2, `bond_style table` F over r.
        """
        r = self.distances
        weight = r if self.squared else np.ones_like(r)
        stored, grid = self.force(r) / weight, r**2 if self.squared else r
        forces = np.abs(self.force(r))
        floor = np.median(forces[forces > 0]) if (forces > 0).any() else 1.0
        worst = 0.0
        for fraction in (0.02, 0.2, 0.5, 0.8, 0.98):
            at = (1 - fraction) * grid[:-1] + fraction * grid[1:]
            distance = np.sqrt(at) if self.squared else at
            between = (1 - fraction) * stored[:-1] + fraction * stored[1:]
            between *= distance if self.squared else 1.0
            exact = self.force(distance)
            error = np.abs(between - exact) / np.maximum(np.abs(exact), floor)
            worst = max(worst, float(np.max(error)))
        return worst

    def write(self, path: Path) -> None:
        """Write the file, all digits."""
        r = self.distances
        grid = f" RSQ {r[0]:.17g} {r[-1]:.17g}" if self.squared else ""
        rows = np.column_stack([np.arange(1, len(r) + 1), r, self.energy(r), self.force(r)])
        with path.open("w", encoding="utf-8") as file:
            file.write(
                f"# {self.keyword}: index, distance, energy, force; written by lammps-skin\n"
                f"# largest relative force error of linear interpolation: "
                f"{self.interpolation_error():.1e}\n\n{self.keyword}\nN {len(r)}{grid}\n\n"
            )
            np.savetxt(file, rows, fmt=["%d", "%.17g", "%.17g", "%.17g"])


def pair_grid(contact: float, inner: float, outer: float, points: int) -> Floats:
    """Distances uniform in r^2 from about `inner` to `outer` (both in contact lengths).

    The contact length is one of the points: the potentials have a kink in their force there.
    """
    beyond = outer**2 - 1
    if beyond <= 0:
        return contact * np.sqrt(np.linspace(inner**2, outer**2, points))
    steps = max(round(beyond / (outer**2 - inner**2) * (points - 1)), 1)
    step = beyond / steps
    below = int((1 - inner**2) / step)
    return contact * np.sqrt(1 + step * np.arange(-below, steps + 1))


def bond_grid(inner: float, kink: float, outer: float, points: int) -> Floats:
    """Distances uniform in r within [inner, outer], the kink being one of them."""
    step = (outer - inner) / (points - 1)
    step = kink / np.ceil(kink / step)
    first = int(np.ceil(inner / step))
    last = int(np.floor(outer / step))
    return step * np.arange(first, last + 1)
