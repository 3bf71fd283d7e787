"""Conditions side by side, against a key of their scenes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lammps_skin.study.compare.comparison import Row
from lammps_skin.style import plain


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
    down = -(-len(columns) // across)
    figure = Figure(figsize=(4.6 * across, 3.4 * down), layout="constrained")
    panels: list[Axes] = list(figure.subplots(down, across, squeeze=False).ravel())
    for axes, column in zip(panels, columns, strict=False):
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
        axes.set(xlabel=key, ylabel=column)
    for axes in panels[len(columns) :]:
        axes.set_axis_off()
    panels[0].legend(frameon=False)
    return figure
