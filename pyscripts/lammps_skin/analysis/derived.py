"""Columns of a table of observables, and those made of them, as ``--columns`` names them.

``A-B`` is the difference of two columns. ``A>LEVEL`` is when A, a column or a difference, comes to
a level.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from lammps_skin.analysis.observables import LESS, REACHES, Table, is_fraction, least
from lammps_skin.analysis.statistics import Mean, first_time, mean
from lammps_skin.arrays import Floats
from lammps_skin.model.scene_keys import near

COUNTS = ("births", "deaths")  # since the start: what counts is how many more in a window


def parts(column: str) -> list[str]:
    """Names of the columns of which a column is made."""
    return column.partition(REACHES)[0].split(LESS)


def fault(column: str, observed: Sequence[str]) -> str:
    """What is wrong with a column, where these were observed; nothing if it can be made."""
    made_of, reaches, level = column.partition(REACHES)
    for name in parts(column):
        if name not in observed:
            return f"there is no column {name or repr(name)}{near(name, observed)}"
    if made_of.count(LESS) > 1:
        return f"{made_of!r} must be the difference of two columns, no more"
    if reaches and not _is_number(level):
        return f"{level!r} must be a number, the level that {made_of} comes to"
    return ""


def course(table: Table | Mapping[str, Any], column: str) -> Floats:
    """Values (f,) of a column row by row; of ``A>LEVEL`` those of A."""
    first, *others = (np.asarray(table[name], float) for name in parts(column))
    return first - others[0] if others else first


def statistic(table: Table, column: str, window: tuple[float, float]) -> float:
    """Of one run: the mean over a window of what is defined, or the count during it.

    Of ``A>LEVEL`` the time from the beginning of the window to when A comes to the level. NaN if
    nothing is defined in the window.
    """
    inside = (table["time"] >= window[0]) & (table["time"] <= window[1])
    values = course(table[inside], column)
    _, reaches, level = column.partition(REACHES)
    if reaches:
        return first_time(table["time"][inside], values, float(level)) - window[0]
    values = values[~np.isnan(values)]
    if not len(values):
        return np.nan
    return float(values[-1] - values[0] if column in COUNTS else values.mean())


def average(values: Floats, column: str) -> Mean:
    """Mean over seeds of values (s,) of a column, its interval within what is possible."""
    return mean(values, fraction=is_fraction(column), least=least(column))


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
