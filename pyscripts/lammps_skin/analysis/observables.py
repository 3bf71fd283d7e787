"""One table of observables for a trajectory: a row for every frame, a column for each observable.

The columns (see docs/analysis.md): numbers of cells, what has happened to them, how much of the
membrane they cover and whether in one layer, its height, its papillae, the cells on their tips,
the order parameters of stem cells, of ND cells, and of kinds that the scene adds. What is not
defined in a frame is NaN.
"""

from __future__ import annotations

import gzip
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lammps_skin.analysis.coverage import count_by_kind
from lammps_skin.analysis.lineage import Events, read_events
from lammps_skin.analysis.state import State, StateAnalysis, scene_and_triangles
from lammps_skin.errors import MembraneError, SkinError
from lammps_skin.event_log import BIRTH, LEAVING
from lammps_skin.files import atomic_write
from lammps_skin.kinds import KINDS, Kind, is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.universe import open_trajectory

Table = NDArray[np.void]

VERSION = 3  # to be raised when a column changes or means something else
ORDERS = ("chi_H", "chi_G", "zeta", "sigma")
TIPS = ("on_tips", "tips_expected", "tips_sd", "tips_z", "tips_p")
LAYER = (
    "none_below", "cells_below", "most_on_particle", "particles_holding", "membrane_area",
    "cell_area", "long_link",
)  # fmt: skip
RELIEF = (
    "skewness", "skewness_low", "skewness_high",
    "papillae", "papilla_height", "papilla_width", "papilla_spacing", "papilla_width_cells",
)  # fmt: skip
FRACTIONS = ("coverage", "none_below", "particles_holding")
LESS = "-"  # in the name of a difference of columns
REACHES = ">"  # between a column and a level: when it comes to that
SIGNED = ("skewness", "chi_", "zeta")  # how columns begin whose values may be negative


def columns(cells: Sequence[Kind]) -> tuple[str, ...]:
    """Columns of the table of a scene that has these kinds of cells."""
    placed = placed_kinds(cells)
    return (
        "time", *(kind.label for kind in cells), "births", "deaths", "coverage",
        *LAYER, "height", "height_std", *RELIEF,
        *(f"{kind.label}_{name}" for kind in placed for name in TIPS),
        *ORDERS, *(f"{name}_{kind.label}" for kind in placed[1:] for name in ORDERS),
    )  # fmt: skip


def placed_kinds(cells: Sequence[Kind]) -> tuple[Kind, ...]:
    """Kinds whose places are told of: stem and ND cells, and those that the scene adds."""
    return tuple(kind for kind in cells if kind not in (Kind.TA, Kind.EXHAUSTED))


COLUMNS = columns([kind for kind in KINDS if is_cell(kind)])
"""Columns of the table of a scene without kinds of its own."""


def is_fraction(column: str) -> bool:
    """Whether the values of a column, or of what is made of columns, are from 0 to 1."""
    if LESS in column or REACHES in column:
        return False
    return column in FRACTIONS or column.endswith(("_on_tips", "_tips_expected"))


def least(column: str) -> float:
    """What the values of a column, or of what is made of columns, cannot be below."""
    if REACHES in column:
        return 0.0
    signed = LESS in column or column.startswith(SIGNED) or column.endswith("_tips_z")
    return -np.inf if signed else 0.0


class Observables(StateAnalysis):
    """All columns of the table, for the frames of a trajectory.

    ``results.table`` (f,) is a structured array with the fields `columns`, all float64;
    ``results`` also has each column (f,) by its name.

    Parameters
    ----------
    universe : Universe
        From `open_trajectory`.
    events : Events, optional
        Of the same run, for births and deaths; NaN without.

    Examples
    --------
    >>> with open_run("runs/one-stem") as run:
    ...     table = Observables(run.universe, run.events).run().results.table
    >>> table["time"], table["zeta"]
    """

    columns = COLUMNS[1:]

    def __init__(self, universe: Any, events: Events | None = None, **options: Any) -> None:
        super().__init__(universe, **options)
        self.columns = columns(self.scene.kinds_of_cells)[1:]
        logged = (BIRTH,), LEAVING
        self._logged = [events.of(*kinds).time for kinds in logged] if events else []

    def _measure(self, state: State) -> tuple[float, ...]:
        until = state.time * (1 + 1e-9)  # times in the log have ten digits
        happened = [np.searchsorted(times, until, side="right") for times in self._logged]
        z = state.membrane[:, 2]
        cells = state.scene.kinds_of_cells
        return (
            *count_by_kind(state.kinds, cells).values(),
            *(happened or (np.nan, np.nan)),
            state.coverage, *_layer(state),
            z.mean(), (z - z[0]).std(), *_relief(state),  # 0 of what is flat
            *(value for kind in placed_kinds(cells) for value in state.order(kind)),
        )  # fmt: skip

    def _conclude(self) -> None:
        super()._conclude()
        rows = [tuple(map(float, row)) for row in self._rows]
        self.results.table = np.array(rows, [(name, float) for name in ("time", *self.columns)])


def _layer(state: State) -> tuple[float, ...]:
    """Columns `LAYER`: lengths as they are, areas over that of the box and of the membrane."""
    area = state.sheet.area
    cells = len(state.cells) * np.pi * state.scene.cells.radius**2
    box = float(np.prod(state.box))
    return *state.layering, area / box, cells / area, state.sheet.long_link


def _relief(state: State) -> tuple[float, ...]:
    """Columns from the skewness to the tips; NaN where the membrane is no sheet over the box."""
    placed = placed_kinds(state.scene.kinds_of_cells)
    diameter = 2 * state.scene.cells.radius
    try:
        height, width, spacing = state.papilla_means()
        return (
            *state.skewness(), len(state.papillae.height), height, width, spacing,
            width / diameter,
            *(value for kind in placed for value in state.tips(kind)),
        )  # fmt: skip
    except MembraneError:
        return (np.nan,) * (len(RELIEF) + len(placed) * len(TIPS))


# ---- runs on disk


class Run(NamedTuple):
    """A run on disk: its scene, the universe of its trajectory, its events if it has a log.

    `seed` is that of the cells of the run, which may be another one than the scene's.
    """

    scene: Scene
    seed: int
    universe: Any
    events: Events | None


@contextmanager
def open_run(path: str | Path) -> Iterator[Run]:
    """Open a run directory, or a trajectory with the event log beside it.

    Raises
    ------
    SkinError
        If there is no trajectory, or if it is none.
    """
    path = Path(path)
    log = (path if path.is_dir() else path.parent) / "events.csv"
    universe = open_trajectory(path)
    try:
        scene, _ = scene_and_triangles(universe)
        events = read_events(log) if log.exists() else None
        yield Run(scene, universe.trajectory.seed, universe, events)
    finally:
        universe.trajectory.close()


def observables(path: str | Path) -> Table:
    """Table of observables of a run directory or a trajectory."""
    with open_run(path) as run:
        table: Table = Observables(run.universe, run.events).run().results.table
    return table


# ---- tables on disk


def write_table(table: Table, path: Path, comments: Iterable[str] = ()) -> None:
    """Write a table as CSV, packed if the name ends in .gz; the same table gives the same bytes.

    Numbers have 7 digits. A file that is there is replaced when the new one is complete.
    """
    names = table.dtype.names or ()
    lines = [f"# {comment}" for comment in comments]
    lines += [",".join(names), *(",".join(f"{x:.7g}" for x in row) for row in table.tolist())]
    content = ("\n".join(lines) + "\n").encode()
    if path.suffix == ".gz":
        content = gzip.compress(content, mtime=0)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path) as part:
            part.write_bytes(content)
    except OSError as error:
        raise SkinError(f"table {path}: {error.strerror}") from None


def read_table(path: str | Path) -> Table:
    """Structured array of a table that `write_table` has written."""
    path = Path(path)
    try:
        content = path.read_bytes()
        text = (gzip.decompress(content) if path.suffix == ".gz" else content).decode()
        names, *rows = (line for line in text.splitlines() if not line.startswith("#"))
        values = [tuple(map(float, row.split(","))) for row in rows]
        return np.array(values, [(name, float) for name in names.split(",")])
    except OSError as error:
        raise SkinError(f"table {path}: {error.strerror or error}") from None
    except (ValueError, EOFError):
        raise SkinError(f"table {path}: is no table of observables") from None
