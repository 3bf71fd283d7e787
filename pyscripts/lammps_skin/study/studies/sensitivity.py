"""What a sample of Morris or Sobol tells: on which keys the observables depend."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from lammps_skin.analysis.labels import label
from lammps_skin.arrays import Floats
from lammps_skin.study.studies.answer import answers
from lammps_skin.study.studies.design import Design
from lammps_skin.style import name_axes, panels, plain

CHANCE = "cells.seed"  # a key whose effect is that of chance alone
DRAWN = {"morris": "mu_star", "sobol": "total"}
MEASURE = {"mu_star": "μ*", "total": "total index"}


class Sensitivity(NamedTuple):
    """Of one observable, in the last window.

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


def has_indices(design: Design) -> bool:
    """Whether it is a sample that tells of sensitivity."""
    return design.sample is not None and design.sample.method in DRAWN


def sensitivities(design: Design, means: Any, wanted: Sequence[str]) -> list[Sensitivity]:
    """Of each condition and choice of the grid, of each column of the table of means."""
    sample, window = design.sample, design.windows[-1]
    assert sample
    number = sample.number
    found = []
    for first, column in product(range(0, len(design.points), number), wanted):
        results = [one.mean.value for one in answers(design, means, [column])
                   if one.window == window]  # fmt: skip
        what = design.points[first].label.rpartition("sample")[0] + column
        mine = np.array(results[first : first + number])
        if np.isnan(mine).any():
            found.append(Sensitivity(what, (), np.empty((0, 0))))
        else:
            found.append(Sensitivity(what, *sample.sensitivity(mine)))
    return found


def effects(design: Design, found: Sequence[Sensitivity]) -> list[str]:
    """Lines of a table in Markdown: mean effects of Morris with 95 % intervals, a row for each key.

    Effects whose interval does not hold 0 are bold.
    """
    assert design.sample
    lines = [" | ".join(["| key", *(one.what for one in found)]) + " |",
             "|" + " --- |" * (len(found) + 1)]  # fmt: skip
    for n, key in enumerate(design.sample.ranges):
        cells = []
        for one in found:
            value, error = (one.values[n, one.heads.index(name)] for name in ("mu", "mu_error"))
            text = f"{value:.2g} ± {error:.2g}"
            cells.append(f"**{text}**" if abs(value) > error else text)
        lines.append(" | ".join([f"| `{key}`", *cells]) + " |")
    return lines


@plain
def draw(design: Design, found: Sequence[Sensitivity]) -> Figure:
    """A panel for each: mu* of Morris or the total index of Sobol, of each key, with intervals.

    If the seed of the cells is among the keys, a line shows what chance does.
    """
    sample = design.sample
    assert sample
    keys = [*sample.ranges]
    figure, axes_of = panels(len(found), height=0.22 * len(keys) + 1.0)
    for n, (axes, one) in enumerate(zip(axes_of, found, strict=True)):
        head = DRAWN[sample.method]
        of, _, column = one.what.rpartition(", ")
        name_axes(axes, f"{MEASURE[head]} of {label(column).text}{of and f', {of}'}")
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
