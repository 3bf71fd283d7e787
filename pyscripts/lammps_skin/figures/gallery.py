"""Snapshots side by side: the ring run at several times, the scenes with ND cells."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from matplotlib.figure import Figure

from lammps_skin.figures.look import Look
from lammps_skin.figures.moments import last_time, read_moments
from lammps_skin.figures.snapshot import draw_view, legend
from lammps_skin.kinds import Kind
from lammps_skin.style import name_panels, plain, size

LOOK = Look(size=600)  # of a panel
PARTS_OF_THE_TIME = (0.1, 0.3, 0.6, 1.0)


@plain
def draw_run(run: Path) -> Figure:
    """One run at several times: stem cells alone, and all cells below."""
    end = last_time(run)
    moments = read_moments(run, [part * end for part in PARTS_OF_THE_TIME])
    figure = Figure(figsize=size(4.5 * len(moments), 8.2), layout="constrained")
    panels = figure.subplots(2, len(moments))
    cells = moments[-1].scene.kinds_of_cells
    for row, kinds in zip(panels, ((Kind.STEM,), cells), strict=True):
        for axes, moment in zip(row, moments, strict=True):
            draw_view(axes, moment, kinds, LOOK)
    name_panels(panels.ravel().tolist())
    legend(figure, moments[-1], cells)
    return figure


@plain
def draw_scenes(runs: Mapping[str, Path]) -> Figure:
    """Several runs at their start and, below, at their end: stem and ND cells."""
    kinds = Kind.STEM, Kind.ND
    figure = Figure(figsize=size(4.5 * len(runs), 8.2), layout="constrained")
    panels = figure.subplots(2, len(runs), squeeze=False)
    for column, (label, run) in zip(panels.T, runs.items(), strict=True):
        moments = read_moments(run, [0.0, None])
        for axes, moment in zip(column, moments, strict=True):
            draw_view(axes, moment, kinds, LOOK)
            axes.set_title(f"{label}, t = {moment.time:g}")
    name_panels(panels.ravel().tolist())
    legend(figure, moments[-1], kinds)
    return figure
