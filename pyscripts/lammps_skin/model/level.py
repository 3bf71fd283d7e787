"""Numerics of the level of accuracy of a scene whose keys are not yet validated."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

from lammps_skin.model import accuracy
from lammps_skin.model.accuracy import DEFAULT_LEVEL, LEVELS
from lammps_skin.model.interventions import stated
from lammps_skin.model.parts import USUAL_END, Cells, Output


def of_level(given: Mapping[str, Any]) -> dict[str, Any]:
    """Numerics of the level of accuracy, as far as the keys of a scene can be read.

    Parameters
    ----------
    given : mapping
        Nested keys, not yet validated.
    """
    numerics = _table(given, "numerics")
    level = numerics.get("accuracy", DEFAULT_LEVEL)
    if not isinstance(level, str) or level not in LEVELS:
        return {}
    output = _table(given, "output")
    intervals = [_number(output, *item) for item in Output().model_dump().items()]
    cycle = min(map(_cycle, stated(given)))
    end = _number(given, "end_time", USUAL_END)
    return accuracy.numerics(level, numerics, [end, *intervals], cycle)


def _cycle(given: Mapping[str, Any]) -> float:
    """Duration of the fastest cycle, as far as it can be read."""
    cells, usual = _table(given, "cells"), Cells()
    delay = _number(cells, "cycle_delay", usual.cycle_delay, zero=True)
    rate = _number(cells, "cycle_rate", usual.cycle_rate)
    kinds = _table(cells, "kinds")
    return min(
        _number(kind, "cycle_delay", delay, zero=True) + 1 / _number(kind, "cycle_rate", rate)
        for kind in ({}, *(_table(kinds, label) for label in kinds))
    )


def _table(keys: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    value = keys.get(name)
    return value if isinstance(value, Mapping) else {}


def _number(keys: Mapping[str, Any], key: str, default: float, zero: bool = False) -> float:
    value = keys.get(key, default)
    usable = isinstance(value, (int, float)) and 0 <= value <= sys.float_info.max
    usable = usable and (zero or value > 0)
    return float(value) if usable else default
