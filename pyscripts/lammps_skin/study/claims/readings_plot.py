"""Papillae, stem cells and ND cells against bending stiffness, as a figure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lammps_skin.analysis.labels import SYMBOLS, label
from lammps_skin.study.claims.readings import Reading
from lammps_skin.study.claims.readings_levels import TISSUE, of_nd
from lammps_skin.style import name_axes, plain, with_indices

LEVELS = {one.title: one for one in TISSUE}
PANELS = {
    label("papillae").text: [LEVELS["papillae"]],
    label("papilla_width_cells").text: [LEVELS["width in cells"]],
    "stem cells in the ring scene": [LEVELS["chi_H"], LEVELS["zeta"]],
    "ND less stem cells in nd-b": list(of_nd("nd-b")[-2:]),
}


@plain
def draw(series: Sequence[Reading]) -> Figure:
    """A panel for each group of levels, with intervals over seeds; see `stiffness_series`."""
    values = [reading.scene.membrane.bending_stiffness for reading in series]
    figure = Figure(figsize=(15, 3.8), layout="constrained")
    panels: list[Axes] = list(figure.subplots(1, len(PANELS)))
    for axes, (title, found) in zip(panels, PANELS.items(), strict=True):
        for one in found:
            value, _, low, high, _ = np.array([one.of(reading) for reading in series]).T
            bars = np.array([value - low, high - value])
            name = with_indices(SYMBOLS.get(one.column.removesuffix("_nd"), ""))
            when = f", t = {one.window}" if one.window else ""
            axes.errorbar(values, value, bars, fmt="o-", capsize=3, label=name + when)
        axes.set(xscale="log")
        name_axes(axes, "bending stiffness", title)
        axes.set_xticks(values, [f"{value:g}" for value in values])
        axes.minorticks_off()
        if len(found) > 1:
            axes.axhline(0.0, color="0.7", linewidth=0.8, zorder=0)
            axes.legend(frameon=False)
    return figure
