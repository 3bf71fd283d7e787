"""Error against time of all variants, with those that no other beats in both."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from lammps_skin.arrays import Floats
from lammps_skin.model.accuracy import LEVELS
from lammps_skin.study.tradeoff.report import Report, Row
from lammps_skin.style import plain

STYLES = tuple(f"C{n % 10}{'osD^v'[n // 10]}" for n in range(50))  # of the points of variants


@plain
def draw(report: Report) -> Figure:
    """Panels of distances from the truth, and, with ensembles, one of biases."""
    columns = {
        "rms": "rms distance of particles from the truth",
        "median": "median distance of particles from the truth",
        "bias": "rms difference of statistics, in standard errors",
    }
    if not any(row.bias > 0 for row in report.rows):
        del columns["bias"]
    figure = Figure(figsize=(6 * len(columns) + 2, 6), layout="constrained")
    panels: list[Axes] = list(figure.subplots(1, len(columns), sharex=True))
    for axes, (column, label) in zip(panels, columns.items(), strict=True):
        _panel(axes, report.rows, column, label)
    if "bias" in columns:
        panels[-1].axhline(1.0, color="0.6", ls=":", zorder=0)  # what chance gives
        highest = max(row.bias for row in report.rows if row.bias > 0)
        panels[-1].set(yscale="linear", ylim=(0.0, 1.1 * max(highest, 1.0)))
    named = {
        name: handle
        for axes in panels
        for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    figure.legend(named.values(), named.keys(), frameon=False, loc="outside right upper")
    figure.suptitle(report.title)
    return figure


def front(points: Floats) -> list[int]:
    """Indices of the points (n, 2) that no other beats in both, by their first coordinate."""
    best, lowest = [], np.inf
    for n in np.lexsort((points[:, 1], points[:, 0])):
        if points[n, 1] < lowest:
            best.append(int(n))
            lowest = points[n, 1]
    return best


def _panel(axes: Axes, rows: Sequence[Row], column: str, label: str) -> None:
    axes.set(xscale="log", yscale="log", xlabel="CPU time over that of the reference", ylabel=label)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_locator(LogLocator(subs=(2, 3, 5)))
    axes.xaxis.set_minor_formatter("{x:.2g}")
    shown = []
    for row, style in zip(rows, cycle(STYLES), strict=False):
        if row.cpu > 0 and getattr(row, column) > 0:
            shown.append((row.cpu, getattr(row, column)))
            level = row.variant in LEVELS
            axes.plot(
                *shown[-1], style, ms=12 if level else 7, zorder=3 if level else 2,
                markeredgecolor="k" if level else "w", label=row.variant,
            )  # fmt: skip
    if shown:
        points = np.array(shown)
        axes.step(*points[front(points)].T, where="post", color="0.75", zorder=0)
