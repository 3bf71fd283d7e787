"""What a sample of Morris or Sobol tells: on which keys the observables depend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from lammps_skin.analysis.labels import label
from lammps_skin.analysis.observables import Table
from lammps_skin.arrays import Floats
from lammps_skin.study.ranges import Window
from lammps_skin.study.studies.answer import mean_of
from lammps_skin.study.studies.samples import Sample
from lammps_skin.style import name_axes, panels, plain

CHANCE = "cells.seed"  # a key whose effect is that of chance alone
DRAWN = {"morris": "mu_star", "sobol": "total"}
MEASURE = {"mu_star": "μ*", "total": "total index"}


class Sensitivity(NamedTuple):
    """Of one observable, in a window of time.

    Attributes
    ----------
    what : str
        The observable, after the condition and the values of the grid if there are any.
    heads : tuple of str
        Of the columns, see `Sample.sensitivity`.
    values : (k, c) array
        A row for each key; without rows if not all points have a value.
    """

    what: str
    heads: tuple[str, ...]
    values: Floats

    @property
    def title(self) -> str:
        """The observable in words, before the condition and the values of the grid."""
        of, _, column = self.what.rpartition(", ")
        return f"{label(column).text}{of and f', {of}'}"


def has_indices(sample: Sample | None) -> bool:
    """Whether it is a sample that tells of sensitivity."""
    return sample is not None and sample.method in DRAWN


def sensitivities(
    sample: Sample, labels: Sequence[str], courses: Mapping[str, Table], wanted: Sequence[str],
    window: Window,
) -> list[Sensitivity]:  # fmt: skip
    """Of each condition and choice of the grid, of each column.

    Parameters
    ----------
    sample : Sample
        With indices.
    labels : sequence of str
        Of all points of the study, in order.
    courses : mapping
        Their time courses.
    wanted : sequence of str
        Columns.
    window : Window
        Of time, over which means are taken.
    """
    found = []
    for first, column in product(range(0, len(labels), sample.number), wanted):
        mine = labels[first : first + sample.number]
        results = np.array([mean_of(courses, label, column, window).value for label in mine])
        what = labels[first].rpartition("sample")[0] + column
        if np.isnan(results).any():
            found.append(Sensitivity(what, (), np.empty((0, 0))))
        else:
            found.append(Sensitivity(what, *sample.sensitivity(results)))
    return found


def effects(sample: Sample, found: Sequence[Sensitivity]) -> list[str]:
    """Lines of a table in Markdown: mean effects of Morris with 95 % intervals, a row for each key.

    Effects whose interval does not hold 0 are bold.
    """
    lines = [" | ".join(["| key", *(one.what for one in found)]) + " |",
             "|" + " --- |" * (len(found) + 1)]  # fmt: skip
    for n, key in enumerate(sample.ranges):
        cells = []
        for one in found:
            value, error = (one.values[n, one.heads.index(name)] for name in ("mu", "mu_error"))
            text = f"{value:.2g} ± {error:.2g}"
            cells.append(f"**{text}**" if abs(value) > error else text)
        lines.append(" | ".join([f"| `{key}`", *cells]) + " |")
    return lines


@plain
def draw(sample: Sample, found: Sequence[Sensitivity]) -> Figure:
    """A panel for each: mu* of Morris or the total index of Sobol, of each key, with intervals.

    If the seed of the cells is among the keys, a line shows what chance does.
    """
    keys = [*sample.ranges]
    figure, axes_of = panels(len(found), height=0.22 * len(keys) + 1.0)
    for n, (axes, one) in enumerate(zip(axes_of, found, strict=True)):
        head = DRAWN[sample.method]
        name_axes(axes, f"{MEASURE[head]} of {one.title}")
        axes.set_yticks(range(len(keys)), keys if n % 3 == 0 else [""] * len(keys))
        axes.invert_yaxis()
        if not len(one.values):
            continue
        value, error = (one.values[:, one.heads.index(name)] for name in (head, f"{head}_error"))
        axes.errorbar(value, range(len(keys)), xerr=error, fmt="o", capsize=3)
        axes.set_xlim(left=0)
        if CHANCE in keys:
            axes.axvline(value[keys.index(CHANCE)], color="grey", linewidth=0.8, linestyle="--")
    return figure
