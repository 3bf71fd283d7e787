"""Conditions side by side: against a key of their scenes, or one below the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from lammps_skin.analysis.labels import label
from lammps_skin.study.compare.comparison import Row
from lammps_skin.style import name_axes, panels, plain


@plain
def draw_against(rows: Sequence[Row], key: str, places: Mapping[str, float], across: int) -> Figure:
    """Figure with a panel for each column, and in it a line for each window.

    Parameters
    ----------
    rows : sequence of Row
        What is drawn: means with their intervals over seeds.
    key : str
        Of the scenes.
    places : mapping
        Values of the key, by condition.
    across : int
        Panels side by side.
    """
    columns = list(dict.fromkeys(row.column for row in rows))
    figure, axes_of = panels(len(columns), across)
    for axes, column in zip(axes_of, columns, strict=True):
        for window in dict.fromkeys(row.window for row in rows):
            chosen = sorted(
                (row for row in rows if (row.column, row.window) == (column, window)),
                key=lambda row: places[row.condition],
            )
            means = np.array([row.value[:4] for row in chosen]).reshape(-1, 4)
            value, _, low, high = means.T
            axes.errorbar(
                [places[row.condition] for row in chosen], value, [value - low, high - value],
                marker="o", markersize=4, capsize=3, label=f"t = {window}",
            )  # fmt: skip
        name_axes(axes, key, label(column).text)
    axes_of[0].legend(frameon=False)
    return figure


@plain
def draw_conditions(rows: Sequence[Row], across: int) -> Figure:
    """Figure with a panel for each column, in it a line for each condition, from top to bottom.

    Windows lie below each other, and the means of the first condition are dotted lines.

    Parameters
    ----------
    rows : sequence of Row
        What is drawn: means with their intervals over seeds.
    across : int
        Panels side by side.
    """
    columns = list(dict.fromkeys(row.column for row in rows))
    names = list(dict.fromkeys(row.condition for row in rows))
    windows = list(dict.fromkeys(row.window for row in rows))
    figure, axes_of = panels(len(columns), across, height=1.2 + 0.25 * len(names))
    drawn: dict[str, Any] = {}  # of each window, in the last panel that has it
    for n, (axes, column) in enumerate(zip(axes_of, columns, strict=True)):
        for number, window in enumerate(windows):
            chosen = [row for row in rows if (row.column, row.window) == (column, window)]
            if not chosen:
                continue
            value, _, low, high = np.array([row.value[:4] for row in chosen]).T
            shift = 0.4 * (number - (len(windows) - 1) / 2) / len(windows)
            drawn[f"t = {window}"] = axes.errorbar(
                value, [names.index(row.condition) + shift for row in chosen],
                xerr=[value - low, high - value], fmt="o", markersize=4, capsize=3,
                color=f"C{number}",
            )  # fmt: skip
            axes.axvline(value[0], color=f"C{number}", linestyle=":", linewidth=0.8)
        axes.set(ylim=(len(names) - 0.5, -0.5))
        name_axes(axes, label(column).text)
        axes.set_yticks(range(len(names)), ["" for _ in names] if n % across else names)
    handles, labels = list(drawn.values()), list(drawn)
    figure.legend(handles, labels, frameon=False, loc="outside upper right", ncols=len(labels))
    return figure
