"""Time courses of ensembles: mean over seeds and its 95 % confidence interval."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lammps_skin.analysis.derived import parts
from lammps_skin.analysis.labels import SYMBOLS, TIME, label
from lammps_skin.analysis.observables import Table
from lammps_skin.errors import FigureError
from lammps_skin.kinds import Kind
from lammps_skin.study.ensemble import over_time
from lammps_skin.style import in_print, name_axes, name_panels, panels, plain, size
from lammps_skin.text import counted

TISSUE = (
    "ta", "exhausted", "coverage", "height_std", "skewness", "papillae", "papilla_height",
    "papilla_spacing",
)  # fmt: skip

# of tables, told apart with each kind of colour blindness (Okabe and Ito) and in grey
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
MOST_BESIDE = 4  # names of tables side by side
LINES = ("-", "--", "-.", ":")
DARK_STEM = tuple(0.55 * part for part in Kind.STEM.colour)  # for a line on white


def draw_course(axes: Axes, table: Table, column: str, unit: float = 1.0, **style: Any) -> None:
    """Mean over seeds as a line, its 95 % confidence interval as a band.

    Where less than half of the seeds have a value there is neither. The unit is that of time.
    """
    names = table.dtype.names or ()
    for name in ("seed", "time", *parts(column)):
        if name not in names:
            raise FigureError(f"table: has no column {name!r}; it has {', '.join(names)}")
    times, means = over_time(table, column)
    value, _, low, high, count = np.array(means).T
    value, low, high = np.where(2 * count < count.max(), np.nan, (value, low, high))
    times = np.asarray(times) / unit
    (line,) = axes.plot(times, value, **style)
    axes.fill_between(times, low, high, color=line.get_color(), alpha=0.2, linewidth=0)


@plain
def draw_courses(
    tables: Mapping[str, Table], columns: Sequence[str], across: int, cycle: float | None = None
) -> Figure:
    """Figure with a panel for each column and a line for each table.

    Parameters
    ----------
    tables : mapping of label to table
    columns : sequence of str
    across : int
        Panels side by side.
    cycle : float, optional
        Mean time of a cell cycle: the unit of time in print.
    """
    figure, axes_of = panels(len(columns), across)
    for axes, column in zip(axes_of, columns, strict=True):
        for n, (name, table) in enumerate(tables.items()):
            draw_course(
                axes, table, column, _unit(cycle), label=f"{name} ({_seeds(table)})",
                color=COLOURS[n % len(COLOURS)], linestyle=LINES[n % len(LINES)],
            )  # fmt: skip
        _finish(axes, label(column).text, cycle)
    name_panels(axes_of)
    handles, labels = axes_of[0].get_legend_handles_labels()
    figure.legend(handles, labels, frameon=False, loc="outside upper center", ncols=MOST_BESIDE)
    return figure


@plain
def draw_stem_and_nd(
    tables: Mapping[str, Table], columns: Sequence[str], cycle: float | None = None
) -> Figure:
    """Figure with a row for each table and a panel for each column, for stem and ND cells."""
    figure = Figure(figsize=size(4.2 * len(columns), 2.9 * len(tables)), layout="constrained")
    unit = _unit(cycle)
    grid = figure.subplots(len(tables), len(columns), squeeze=False, sharex=True, sharey="col")
    for row, (name, table) in zip(grid, tables.items(), strict=True):
        for axes, column in zip(row, columns, strict=True):
            draw_course(axes, table, column, unit, label="stem", color=DARK_STEM)
            draw_course(
                axes, table, f"{column}_nd", unit, label="ND", color=Kind.ND.colour, linestyle="--"
            )
            _finish(axes, SYMBOLS[column], cycle)
        row[0].set_title(f"{name} ({_seeds(table)})")
    name_panels(grid.ravel().tolist())
    grid[0][0].legend(frameon=False)
    return figure


def _seeds(table: Table) -> str:
    return counted(len(np.unique(table["seed"])), "seed")


def _finish(axes: Axes, name: str, cycle: float | None) -> None:
    axes.axhline(0.0, color="0.7", linewidth=0.8, zorder=0)
    name_axes(axes, TIME if _unit(cycle) == 1.0 else "time (cycles)", name)


def _unit(cycle: float | None) -> float:
    return cycle if cycle is not None and in_print() else 1.0
