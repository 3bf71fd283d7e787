"""The terms of the model as LAMMPS styles: which style, which coefficients, which table.

A term whose shape is Lennard-Jones is exactly ``pair_style lj/cut``: K phi(d/D) is
4 epsilon ((sigma/d)^12 - (sigma/d)^6) with epsilon = K/12 and sigma = D/2^(1/6).

`Terms` answers for one scene.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from lammps_skin.arrays import Floats
from lammps_skin.model import potentials
from lammps_skin.model.tables import Table, bond_grid, pair_grid

if TYPE_CHECKING:  # ranks import this, and need no scene
    from lammps_skin.model.cell_kinds import CellKind
    from lammps_skin.model.scene import Scene

TERMS = (
    "dermis_dermis",
    "dermis_membrane",
    "wall",
    "stretch",
    "bend",
    "membrane_exclusion",
    "cell_membrane_exclusion",
    "adhesion",
    "binding",
    "cell_cell_exclusion",
    "cell_cell_adhesion",
    "division",
)
"""Names of all terms of the model."""

FIX_TERMS = ("adhesion", "binding", "division")
"""The terms that fix skin/cells computes, in the order of its global vector."""


@dataclass(frozen=True)
class StyledTerm:
    """A term as a LAMMPS style with its settings, its coefficients, and its table if it has one.

    `file` is the name of the table, without the suffix.
    """

    name: str
    style: str
    coefficients: str
    table: Table | None = None
    file: str = ""

    @property
    def argument(self) -> str:
        """Coefficients as a command gives them, in a directory that LAMMPS knows as `dir`."""
        return f"${{dir}}/{self.coefficients}" if self.table else self.coefficients

    def same_as(self, other: StyledTerm) -> bool:
        """Whether both are the same potential, whatever the names of their tables."""
        if self.table and other.table:
            return self.table.same_as(other.table)
        return self.coefficients == other.coefficients


@dataclass(frozen=True)
class PairPotential:
    """A pair potential K u(d/D), its range in contact lengths, and where its table begins.

    `between` names the particles that it is between, `plugin_style` is its style in the plugin, and
    `extra` what that wants to know besides K, D and the range.
    """

    name: str
    between: str
    stiffness: float
    contact: float
    range: float
    energy: Callable[[Floats], Floats]
    slope: Callable[[Floats], Floats]
    inner: float
    plugin_style: str = "skin/lj"
    extra: tuple[float, ...] = ()

    @property
    def lennard_jones(self) -> bool:
        """Whether it is exactly a stock ``lj/cut``."""
        return self.plugin_style == "skin/lj"

    def table(self, points: int) -> Table:
        # the last point is inside the range: what jumps to 0 there keeps its limit from within
        inside = np.nextafter(self.range, 0.0)

        def energy(r: Floats) -> Floats:
            return self.stiffness * self.energy(np.minimum(r / self.contact, inside))

        def force(r: Floats) -> Floats:
            slope = self.slope(np.minimum(r / self.contact, inside))
            return -self.stiffness * slope / self.contact

        grid = pair_grid(self.contact, self.inner, self.range, points)
        return Table(self.name.upper(), energy, force, grid, squared=True)


def lennard_jones(stiffness: float, contact: float, cutoff: float) -> str:
    """Coefficients epsilon, sigma and cutoff of K phi(d/D)."""
    return f"{stiffness / 12!r} {contact / 2 ** (1 / 6)!r} {cutoff!r}"


class DivisionSpring(NamedTuple):
    """Stiffness of the spring of a dividing pair; its natural length grows from start to end."""

    stiffness: float
    start: float
    rate: float
    end: float


@dataclass(frozen=True)
class Terms:
    """The terms of one scene; each property is worked out when it is first asked for.

    Parameters
    ----------
    scene : Scene
    edition : str
        What the names of table files have at their end.

    Examples
    --------
    >>> terms = Terms.of(Scene.load("two-cells"))
    >>> [term.style for term in terms.pairs]
    """

    scene: Scene
    edition: str = ""

    @staticmethod
    @lru_cache(maxsize=16)
    def of(scene: Scene) -> Terms:
        """The terms of a scene; the same ones for all that ask."""
        return Terms(scene)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the terms that the scene has, in the order of `TERMS`."""
        present = {*self.pair_potentials, "stretch", "bend"}
        if self.scene.dermis.present:
            present.add("wall")
        if self.scene.has_cells:
            present.update(FIX_TERMS)
        return tuple(name for name in TERMS if name in present)

    @cached_property
    def pair_potentials(self) -> dict[str, PairPotential]:
        """The pair terms as formulas, by name."""
        return {pair.name: pair for pair in _pair_potentials(self.scene)}

    @cached_property
    def pairs(self) -> tuple[StyledTerm, ...]:
        """The sub-styles of ``pair_style hybrid/overlay`` and their coefficients, in order."""
        return tuple(
            _styled(pair, self.scene, name + self.edition)
            for name, pair in self.pair_potentials.items()
        )

    @cached_property
    def cores(self) -> dict[str, str]:
        """Style and coefficients by which stock pair styles are watched, for pairs of particles.

        Empty where there is nothing to watch: the pair styles of the plugin know their cores. Fix
        skin/cells watches cells and the membrane, but not before a table has come to its end.
        """
        return _cores([*self.pair_potentials.values()], self.scene.numerics.pair_form)

    @cached_property
    def stretch(self) -> StyledTerm:
        """``bond_style skin/stretch``, or ``bond_style table`` where the scene wants tables."""
        numerics, membrane = self.scene.numerics, self.scene.membrane
        if numerics.pair_form == "table":
            table = stretch_table(self.scene)
            style = f"table {numerics.table_style} {len(table.distances)}"
            file = f"stretch{self.edition}"
            return StyledTerm("stretch", style, f"{file}.table {table.keyword}", table, file)
        contact = 2 * membrane.radius
        scale = contact if self.scene.force_scale == "direct" else 1.0
        coefficients = (
            f"{membrane.stretch_stiffness!r} {contact!r} {membrane.elasticity!r} "
            f"{membrane.spacing_ratio!r} {scale!r}"
        )
        return StyledTerm("stretch", "skin/stretch", coefficients)

    @cached_property
    def tables(self) -> dict[str, Table]:
        """The tables that LAMMPS reads, by the names of their files."""
        return {term.file: term.table for term in (*self.pairs, self.stretch) if term.table}

    @property
    def wall(self) -> str:
        """Coefficients of ``fix wall/lj126``: exclusion in x = z / R_d."""
        radius = self.scene.dermis.radius
        return lennard_jones(self.scene.dermis.wall_stiffness, radius, radius)

    @property
    def adhesion(self) -> float:
        """K of adhesion, of kinds that do not state theirs."""
        return self.attachment(self.scene.cells.adhesion_stiffness)

    @property
    def binding(self) -> float:
        """K of binding, of kinds that do not state theirs."""
        return self.attachment(self.scene.cells.binding_stiffness)

    def attachment(self, stiffness: float) -> float:
        """K of the attachment of a cell: with direct forces times the contact length."""
        return stiffness * (self.scene.contact if self.scene.force_scale == "direct" else 1.0)

    def kind(self, row: CellKind, present: Collection[str]) -> dict[str, str]:
        """What a kind of cells does, by the keywords of fix skin/cells.

        Parameters
        ----------
        row : CellKind
        present : collection of str
            Labels of the kinds that can occur.
        """
        values: dict[str, tuple[object, ...]] = {}
        attached = () if row.adhesion == "none" else (self.attachment(row.stiffness),)
        ends = (row.range,) if row.adhesion == "adhesive" else ()
        values["law"] = row.adhesion, *attached, *ends
        if row.detaches:
            values["detach"] = (row.range,)
        if row.daughter:
            values["cycle"] = row.cycle_delay, row.cycle_rate, row.first_phase
            values["daughter"] = (row.daughter,)
        if row.generations is not None:
            values |= {"generations": (row.generations,), "last": (row.after_last,)}
        if row.paired_with in present:
            values["paired"] = row.paired_with, self.attachment(row.paired_stiffness)
        return {key: " ".join(map(str, words)) for key, words in values.items()}

    @property
    def division(self) -> DivisionSpring:
        """The spring of dividing pairs."""
        cells = self.scene.cells
        end = 2 * cells.radius
        if cells.division_spring == "length":
            start = 2 * cells.division_separation * cells.radius
            return DivisionSpring(cells.division_stiffness, start, cells.division_rate, end)
        stiffness = cells.division_stiffness / end**2
        return DivisionSpring(stiffness, 0.0, cells.division_rate * end, end)

    @cached_property
    def cutoffs(self) -> dict[str, float]:
        """Ranges of the pair terms and of adhesion, as far as the scene has them.

        The longest ones that they have in the course of a run.
        """
        stages = self.scene.stages
        pairs = [pair for stage in stages for pair in _pair_potentials(stage)]
        found = {
            name: max(pair.contact * pair.range for pair in pairs if pair.name == name)
            for name in self.pair_potentials
        }
        if self.scene.has_cells:
            longest = max(stage.longest_range for stage in stages)
            found["adhesion"] = longest * self.scene.contact
        return found

    @property
    def longest_link(self) -> float:
        """Length at which the energy of a link of the membrane is infinite."""
        return 2 * self.scene.membrane.radius * (1 + self.scene.membrane.spacing_ratio)


def _pair_potentials(scene: Scene) -> list[PairPotential]:
    """The pair terms that a scene has."""
    dermis, membrane, cells = scene.dermis, scene.membrane, scene.cells
    ex, ex_slope = potentials.exclusion, potentials.exclusion_slope
    pairs = [
        PairPotential(
            "membrane_exclusion", "membrane_membrane",
            membrane.exclusion_stiffness, scene.spacing, 1.0,
            ex, ex_slope, 0.3,
        )
    ]  # fmt: skip
    if dermis.present:
        reach, a1, d1 = dermis.attraction_range, dermis.softening, dermis.softening_onset
        pairs += [
            PairPotential(
                "dermis_membrane", "dermal_membrane",
                dermis.membrane_stiffness, membrane.radius + dermis.radius,
                reach, lambda x: potentials.truncated(x, reach),
                lambda x: potentials.truncated_slope(x, reach), 0.3,
            ),
            PairPotential(
                "dermis_dermis", "dermal_dermal",
                dermis.stiffness, 2 * dermis.radius, reach,
                lambda x: potentials.dermis(x, reach, a1, d1),
                lambda x: potentials.dermis_slope(x, reach, a1, d1), 0.1, "skin/dermis", (a1, d1),
            ),
        ]  # fmt: skip
    if scene.has_cells:
        lam = cells.adhesion_range
        scale = 2 * cells.radius if scene.force_scale == "direct" else 1.0
        pairs += [
            PairPotential(
                "cell_membrane_exclusion", "membrane_cell",
                cells.membrane_exclusion_stiffness, scene.contact, 1.0,
                ex, ex_slope, 0.3,
            ),
            PairPotential(
                "cell_cell_exclusion", "cell_cell",
                cells.exclusion_stiffness, 2 * cells.radius, 1.0,
                ex, ex_slope, 0.3,
            ),
            PairPotential(
                "cell_cell_adhesion", "cell_cell",
                cells.cell_adhesion_stiffness * scale, 2 * cells.radius, lam,
                lambda x: potentials.shifted_adhesion(x, lam),
                lambda x: potentials.adhesion_slope(x, lam), 0.02, "skin/adhesion",
            ),
        ]  # fmt: skip
    return pairs


def _styled(pair: PairPotential, scene: Scene, file: str) -> StyledTerm:
    """A pair term as the style that the scene wants."""
    numerics, cutoff = scene.numerics, pair.contact * pair.range
    if numerics.pair_form == "skin":
        values = pair.stiffness, pair.contact, *pair.extra, pair.range
        return StyledTerm(pair.name, pair.plugin_style, " ".join(map(repr, values)))
    if pair.lennard_jones and numerics.pair_form == "analytic":
        coefficients = lennard_jones(pair.stiffness, pair.contact, cutoff)
        return StyledTerm(pair.name, f"lj/cut {cutoff!r}", coefficients)
    table = pair.table(numerics.table_points)
    style = f"table {numerics.table_style} {len(table.distances)}"
    coefficients = f"{file}.table {table.keyword} {cutoff!r}"
    return StyledTerm(pair.name, style, coefficients, table, file)


def _cores(pairs: list[PairPotential], form: str) -> dict[str, str]:
    if form == "skin":
        return {}
    found = {pair.between: "none" for pair in pairs}
    for pair in pairs:  # exclusion comes before adhesion
        particles = pair.between
        if pair.name == "cell_membrane_exclusion" and form == "analytic":
            continue
        if pair.stiffness and found[particles] == "none":
            tables = (
                one.inner for one in pairs
                if one.between == particles and not (one.lennard_jones and form == "analytic")
            )  # fmt: skip
            first = max(tables, default=0.0)
            found[particles] = f"skin/core {pair.inner!r} {pair.contact!r} {first!r}"
    return found if set(found.values()) != {"none"} else {}


def stretch_table(scene: Scene) -> Table:
    """Table of the membrane links, up to just below their singular length."""
    membrane = scene.membrane
    contact, d2 = 2 * membrane.radius, membrane.spacing_ratio
    scale = contact if scene.force_scale == "direct" else 1.0

    def energy(r: Floats) -> Floats:
        u = potentials.stretch(r / contact, membrane.elasticity, d2, scale)
        return membrane.stretch_stiffness * u

    def force(r: Floats) -> Floats:
        slope = potentials.stretch_slope(r / contact, membrane.elasticity, d2, scale)
        return -membrane.stretch_stiffness * slope / contact

    singular = contact * (1 + d2)
    grid = bond_grid(0.2 * d2 * contact, d2 * contact, singular - 0.2 * d2 * contact,
                     scene.numerics.table_points)  # fmt: skip
    return Table("STRETCH", energy, force, grid, squared=False)
