"""Longest stable timesteps against what is varied, one line for each method."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lammps_skin.study.stability.report import Row
from lammps_skin.style import plain

HEIGHT, WIDTH = 4.0, 3.4  # inches of a panel


@plain
def draw(rows: Sequence[Row], title: str) -> Figure:
    """A panel for each that is varied; full lines are found, dashed ones estimated."""
    varied = list(dict.fromkeys(row.varied for row in rows))
    names = list(dict.fromkeys(row.method for row in rows))
    colors = {name: f"C{n}" for n, name in enumerate(names)}
    figure = Figure(figsize=(WIDTH * len(varied) + 2, HEIGHT), layout="constrained")
    panels: Sequence[Axes] = figure.subplots(1, len(varied), sharey=True, squeeze=False)[0]
    for axes, what in zip(panels, varied, strict=True):
        for name in names:
            _line(axes, [r for r in rows if (r.varied, r.method) == (what, name)], colors[name])
        axes.set(xscale="log", yscale="log", xlabel=f"{what}, factor")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.grid(color="0.9")
    panels[0].set_ylabel("longest stable timestep")
    panels[0].yaxis.set_major_formatter("{x:g}")
    handles = [Line2D([], [], color=colors[name], marker="o", label=name) for name in names]
    handles += [
        Line2D([], [], color="0.4", ls="--", label="estimate at the end"),
        Line2D([], [], color="0.4", ls="", marker="^", label="at least"),
        Line2D([], [], color="0.4", ls="", marker="v", label="at most"),
        Line2D([], [], color="0.4", ls="", marker="o", mfc="w", label="not monotone"),
    ]
    figure.legend(handles=handles, frameon=False, loc="outside right center")
    figure.suptitle(title)
    return figure


def _line(axes: Axes, rows: Sequence[Row], color: str) -> None:
    """What was found and what was estimated, by factor."""
    rows = sorted(rows, key=lambda row: row.factor)
    factors = [row.factor for row in rows]
    found = [row.limit or row.unstable for row in rows]
    axes.plot(factors, found, color=color)
    for row, value in zip(rows, found, strict=True):
        marker = "v" if not row.limit else "^" if np.isinf(row.unstable) else "o"
        face = color if row.monotone else "w"
        axes.plot(row.factor, value, marker, color=color, mfc=face, zorder=3)
    estimates = [row.estimate_end for row in rows]
    axes.plot(factors, estimates, "--", color=color, alpha=0.6)
