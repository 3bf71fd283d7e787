"""What the observables need of one moment, and a pass over a trajectory that provides it."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from lammps_skin.analysis.basal_layer import Layering, Sheet, layering, links, sheet
from lammps_skin.analysis.coverage import coverage
from lammps_skin.analysis.curvature import curvature
from lammps_skin.analysis.geometry import nearest
from lammps_skin.analysis.order import Order, order
from lammps_skin.analysis.papillae import (
    Papillae,
    Skewness,
    TipFraction,
    blocks,
    find_papillae,
    on_tip,
    skewness,
    tip_fraction,
)
from lammps_skin.analysis.surface import height_field, smooth
from lammps_skin.arrays import Bools, Floats, Ints
from lammps_skin.errors import SkinError
from lammps_skin.kinds import Kind, is_cell
from lammps_skin.model.scene import Scene

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of packages that MDAnalysis imports
    from MDAnalysis.analysis.base import AnalysisBase
    from MDAnalysis.analysis.results import ResultsGroup

BLOCK = 10.0  # side of the blocks of a height field that count as independent, length
RESAMPLES = 500


@dataclass(frozen=True)
class State:
    """The membrane and the c cells of one moment.

    Attributes
    ----------
    scene : Scene
    time : float
    box : (2,) array
        L_x, L_y.
    membrane : (n, 3) array
        Positions, wrapped or not.
    triangles : (t, 3) array of int
        Indices of membrane particles, counterclockwise seen from the side of the cells.
    links : (2, l) array of int
        Indices of the ends of each side of the triangles.
    kinds : (c,) array of int
        `Kind` of each cell.
    cells : (c, 3) array
        Positions.
    below : (c,) array of int
        Index of the membrane particle nearest to each cell.
    ids : (c,) array of int
    """

    scene: Scene
    time: float
    box: Floats
    membrane: Floats
    triangles: Ints
    links: Ints
    kinds: Ints
    cells: Floats
    below: Ints
    ids: Ints

    @cached_property
    def curvature_below(self) -> tuple[Floats, Floats]:
        """Mean and Gaussian curvature (c,) of the membrane at the particle nearest each cell."""
        wanted = np.zeros(len(self.membrane), bool)
        wanted[self.below] = True
        around = wanted[self.triangles].any(axis=1)  # all triangles of the wanted particles
        bent = curvature(self.membrane, self.triangles[around], self.box)
        return bent.mean[self.below], bent.gaussian[self.below]

    def order(self, of: Kind = Kind.STEM) -> Order:
        """Order parameters of the cells of one kind."""
        radius = self.scene.cells.radius
        return order(self.kinds, self.cells, *self.curvature_below, self.box, radius, of)

    @cached_property
    def coverage(self) -> float:
        """Fraction of membrane particles within lambda (R_c + R_m) of the centre of a cell."""
        reach = self.scene.cells.adhesion_range * self.scene.contact
        return coverage(self.membrane, self.cells, self.box, reach)

    @cached_property
    def layering(self) -> Layering:
        """How the cells lie over each other and on the membrane."""
        radius = self.scene.cells.radius
        return layering(self.cells, self.below, len(self.membrane), self.box, radius)

    @cached_property
    def sheet(self) -> Sheet:
        """How far the membrane is stretched."""
        return sheet(self.membrane, self.triangles, self.links, self.box)

    @cached_property
    def height(self) -> Floats:
        """Height field (g_x, g_y) of the membrane, its nodes one rest spacing apart."""
        return height_field(self.membrane, self.triangles, self.box, self.scene.spacing)

    @cached_property
    def papillae(self) -> Papillae:
        """Peaks of the height smoothed over R_c/2 that have a prominence of R_c/2."""
        scale = self.scene.cells.radius / 2
        return find_papillae(smooth(self.height, self.box, scale), self.box, scale)

    @cached_property
    def on_tip(self) -> Bools:
        """Which cells (c,) are nearest to the membrane in the upper half of a papilla."""
        return on_tip(self.membrane[self.below], self.papillae, self.box)

    def papilla_means(self) -> tuple[float, float, float]:
        """Mean height, width and spacing of the papillae; NaN where there are none to average."""
        found = self.papillae
        height, width, spacing = (
            float(part.mean()) if len(part) else np.nan
            for part in (found.height, found.width, found.spacing)
        )
        return height, width, spacing

    def skewness(self) -> Skewness:
        """Skewness of the height field, its 95 % interval from square blocks of side `BLOCK`."""
        per_side = max(round(float(self.box.min()) / BLOCK), 1)
        return skewness(blocks(self.height, per_side), resamples=RESAMPLES)

    def tips(self, of: Kind = Kind.STEM, others: Sequence[Kind] | None = None) -> TipFraction:
        """Fraction of the cells of a kind on tips against that of others; NaN without papillae.

        The others are those of all other kinds that may detach, if not given.
        """
        if others is None:
            table = self.scene.cell_table.values()
            others = [row.kind for row in table if row.detaches and row.kind != of]
        if not len(self.papillae.height):
            return TipFraction(*[np.nan] * 5)
        mine, theirs = self.kinds == of, np.isin(self.kinds, others)
        return tip_fraction(self.on_tip[mine], self.on_tip[theirs])


class StateAnalysis(AnalysisBase, ABC):  # type: ignore[misc]
    """Base of analyses of a universe of `open_trajectory`: one `State` for every frame.

    A subclass says in `_measure` what it wants of a state, as a tuple of numbers or arrays of
    the same shape in every frame, and in `columns` how they are called; `results` then has an
    array of each, the frames first, and `results.time` (f,).

    Parameters
    ----------
    universe : Universe
        From `trajectory.universe.open_trajectory`.
    **options
        Of `AnalysisBase`: ``verbose`` shows a progress bar.

    Raises
    ------
    SkinError
        If the universe is not from there.
    """

    columns: tuple[str, ...] = ()

    def __init__(self, universe: Any, **options: Any) -> None:
        super().__init__(universe.trajectory, **options)
        self.scene, ids = scene_and_triangles(universe)
        self._members = np.flatnonzero(universe.atoms.types == Kind.MEMBRANE.label)
        self._triangles = np.searchsorted(self._members, ids - 1)
        self._links = links(self._triangles)

    def run(self, *frames: Any, **options: Any) -> Self:
        """Analyse frames, see `AnalysisBase`; raises `SkinError` where they cannot be read."""
        try:
            super().run(*frames, **options)
        except OSError as error:
            raise SkinError(f"trajectory {self._trajectory.filename}: {error}") from None
        return self

    @classmethod
    def get_supported_backends(cls) -> tuple[str, ...]:
        """Where frames may be analysed: each is on its own."""
        return "serial", "multiprocessing", "dask"

    _analysis_algorithm_is_parallelizable = True

    def _get_aggregator(self) -> ResultsGroup:
        return ResultsGroup({"rows": ResultsGroup.flatten_sequence})

    def _prepare(self) -> None:
        self.results.rows = []

    @property
    def _rows(self) -> list[tuple[Any, ...]]:
        """Of each frame, its time and the values of the columns."""
        rows: list[tuple[Any, ...]] = self.results.rows
        return rows

    def _single_frame(self) -> None:
        state = self._state(self._ts)
        self._rows.append((state.time, *self._measure(state)))

    @abstractmethod
    def _measure(self, state: State) -> tuple[Any, ...]:
        """Values of the columns after the time."""

    def _conclude(self) -> None:
        names = ("time", *self.columns)
        columns = zip(*self._rows, strict=True) if self._rows else [()] * len(names)
        for name, values in zip(names, columns, strict=True):
            self.results[name] = np.array(values)

    def _state(self, timestep: Any) -> State:
        data, positions = timestep.data, timestep.data["position"]
        cells = np.flatnonzero(is_cell(data["species"]))
        box = np.array(data["edges"][:2])
        membrane = positions[self._members]
        places = positions[cells]
        return State(
            scene=self.scene,
            time=float(timestep.time),
            box=box,
            membrane=membrane,
            triangles=self._triangles,
            links=self._links,
            kinds=np.asarray(data["species"][cells], np.int64),
            cells=places,
            below=self._nearest(data["partner"][cells], places, membrane, box),
            ids=cells + 1,
        )

    def _nearest(self, partner: Ints, cells: Floats, membrane: Floats, box: Floats) -> Ints:
        """Nearest membrane particle (c,): the one recorded, or searched for where none was."""
        below = np.searchsorted(self._members, np.asarray(partner, np.int64) - 1)
        unknown = np.asarray(partner) <= 0
        if unknown.any():
            below[unknown] = nearest(cells[unknown], membrane, box)[0]
        return below


def scene_and_triangles(universe: Any) -> tuple[Scene, Ints]:
    """Scene of the trajectory of a universe, and ids (t, 3) of the corners of its triangles.

    Raises `SkinError` for a universe that is not from `open_trajectory`.
    """
    try:
        return universe.trajectory.scene, universe.trajectory.triangles
    except AttributeError:
        raise SkinError(f"universe {universe}: is not from open_trajectory") from None
