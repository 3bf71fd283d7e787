"""Error against time of all variants, with those that no other beats in both."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lammps_skin.analysis.geometry import Floats
from lammps_skin.tradeoff.report import Report, Row

NEAR = 0.06  # logarithms of ten: labels of points that are closer than this share a line


def draw(report: Report) -> Figure:
    """Panel of distances from the truth, and, with ensembles, one of biases."""
    with_bias = any(row.bias > 0 for row in report.rows)
    figure = Figure(figsize=(15 if with_bias else 8, 6), layout="constrained")
    panels: list[Axes] = list(np.atleast_1d(figure.subplots(1, 1 + with_bias)))
    _panel(panels[0], report.rows, "rms", "rms distance from the truth")
    if with_bias:
        _panel(panels[1], report.rows, "bias", "rms difference of statistics in standard errors")
        panels[1].axhline(1.0, color="0.6", ls=":", label="chance alone")
        panels[1].legend(frameon=False)
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
    shown = [row for row in rows if row.cpu > 0 and getattr(row, column) > 0]
    axes.set(
        xscale="log", yscale="log", xlabel="CPU time over that of the reference", ylabel=label
    )
    if not shown:
        return
    points = np.array([(row.cpu, getattr(row, column)) for row in shown])
    best = front(points)
    axes.step(*points[best].T, where="post", color="0.75", zorder=0)
    groups: dict[tuple[int, int], list[int]] = {}
    for n, place in enumerate(np.round(np.log10(points) / NEAR).astype(int)):
        groups.setdefault((int(place[0]), int(place[1])), []).append(n)
    for group in groups.values():
        axes.plot(*points[group].T, "o", color="C0" if set(group) & set(best) else "C7")
        axes.annotate(
            "\n".join(shown[n].variant for n in group), points[group[0]], xytext=(5, 3),
            textcoords="offset points", fontsize=8,
        )  # fmt: skip
    axes.margins(0.12)
