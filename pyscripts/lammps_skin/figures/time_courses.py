"""Time courses of ensembles: mean over seeds and its 95 % confidence interval."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lammps_skin.analysis.observables import Table
from lammps_skin.errors import FigureError
from lammps_skin.study.ensemble import over_time
from lammps_skin.style import plain

ORDERS = {"chi_H": "$\\chi_H$", "chi_G": "$\\chi_G$", "zeta": "$\\zeta$", "sigma": "$\\sigma$"}
TISSUE = {
    "ta": "TA cells", "exhausted": "exhausted TA cells", "coverage": "coverage",
    "height_std": "standard deviation of height", "skewness": "skewness of height",
    "papillae": "papillae", "papilla_height": "height of papillae",
    "papilla_spacing": "spacing of papillae",
}  # fmt: skip


def draw_course(axes: Axes, table: Table, column: str, **style: str) -> None:
    """Mean over seeds as a line, its 95 % confidence interval as a band.

    Where less than half of the seeds have a value there is neither.
    """
    names = table.dtype.names or ()
    for name in ("seed", "time", column):
        if name not in names:
            raise FigureError(f"table: has no column {name!r}; it has {', '.join(names)}")
    times, means = over_time(table, column)
    value, _, low, high, count = np.array(means).T
    value, low, high = np.where(2 * count < count.max(), np.nan, (value, low, high))
    (line,) = axes.plot(times, value, **style)  # type: ignore[arg-type]
    axes.fill_between(times, low, high, color=line.get_color(), alpha=0.2, linewidth=0)


@plain
def draw_courses(tables: Mapping[str, Table], columns: Mapping[str, str], across: int) -> Figure:
    """Figure with a panel for each column and a line for each table.

    Parameters
    ----------
    tables : mapping of label to table
    columns : mapping of column to what it is called
    across : int
        Panels side by side.
    """
    rows = -(-len(columns) // across)
    figure = Figure(figsize=(4.6 * across, 3.4 * rows), layout="constrained")
    panels: list[Axes] = list(figure.subplots(rows, across, squeeze=False).ravel())
    for axes, (column, name) in zip(panels, columns.items(), strict=False):
        for label, table in tables.items():
            draw_course(axes, table, column, label=f"{label} ({_seeds(table)})")
        _finish(axes, name)
    for axes in panels[len(columns) :]:
        axes.set_axis_off()
    panels[0].legend(frameon=False)
    return figure


@plain
def draw_stem_and_nd(tables: Mapping[str, Table], columns: Sequence[str]) -> Figure:
    """Figure with a row for each table and a panel for each column, for stem and ND cells."""
    figure = Figure(figsize=(4.2 * len(columns), 2.9 * len(tables)), layout="constrained")
    panels = figure.subplots(len(tables), len(columns), squeeze=False, sharex=True, sharey="col")
    for row, (label, table) in zip(panels, tables.items(), strict=True):
        for axes, column in zip(row, columns, strict=True):
            draw_course(axes, table, column, label="stem", color="tab:green")
            draw_course(axes, table, f"{column}_nd", label="ND", color="darkred")
            _finish(axes, ORDERS[column])
        row[0].set_title(f"{label} ({_seeds(table)})")
    panels[0][0].legend(frameon=False)
    return figure


def _seeds(table: Table) -> str:
    number = len(np.unique(table["seed"]))
    return f"{number} seed{'s' if number > 1 else ''}"


def _finish(axes: Axes, name: str) -> None:
    axes.axhline(0.0, color="0.7", linewidth=0.8, zorder=0)
    axes.set(xlabel="time", ylabel=name)
