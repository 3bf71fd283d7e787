"""What a run has come to, as plain data: all that `skin stats` tells."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.analysis.energies import read_energies
from lammps_skin.analysis.lineage import Events, clone_sizes, turnover, with_added
from lammps_skin.analysis.observables import Observables, Run, Table, is_fraction, least, open_run
from lammps_skin.analysis.series import CloneMixing
from lammps_skin.analysis.state import State, StateAnalysis
from lammps_skin.analysis.statistics import mean_in_time, trend
from lammps_skin.arrays import Floats, Ints
from lammps_skin.errors import SkinError
from lammps_skin.event_log import ADDITION, BIRTH, LEAVING, by_intervention

LATE = 0.6  # of the time that a trajectory covers: where its late window begins
CUMULATIVE = ("time", "births", "deaths")
Window = tuple[float, float]


def summary(path: str | Path, window: Window | None = None) -> dict[str, Any]:
    """Summary of a run on disk.

    Parameters
    ----------
    path : path
        Run directory, or trajectory in HDF5.
    window : (start, end), optional
        Times over which to average; the last two fifths if not given.

    Returns
    -------
    dict
        ``run``: what was run and how far. ``observables``: list over frames for each column.
        ``window``: its times, frames, and the mean of each column with error and 95 % interval,
        see `statistics.mean_in_time`, and its `statistics.trend`. ``events``: births, removals by
        cause, interventions, clones, mixing; None without an event log. ``energies``: of each term
        at the start, at the end and its mean in the window; None without a log. Undefined values
        are NaN.

    Raises
    ------
    SkinError
        If there is no trajectory, or no frame in the window.
    """
    path = Path(path)
    with open_run(path) as run:
        table: Table = Observables(run.universe, run.events).run().results.table
        times = table["time"]
        start, end = window or (times[0] + LATE * (times[-1] - times[0]), times[-1])
        inside = (times >= start) & (times <= end)
        if not inside.any():
            raise SkinError(
                f"window = {start:g}-{end:g}: holds no frame of {path}; its frames are from "
                f"{times[0]:g} to {times[-1]:g}"
            )
        events = None if run.events is None else _events(run, run.events, (start, end))
    return {
        "run": {
            "path": str(path),
            "scene": run.scene.name,
            "parameters": run.scene.parameters,
            "seed": run.scene.seed,
            "cell_seed": run.seed,
            "dermis_seed": run.scene.dermis_seed,
            "frames": len(table),
            "from": float(times[0]),
            "to": float(times[-1]),
            "end_time": run.scene.end_time,
        },
        "observables": {name: table[name].tolist() for name in table.dtype.names or ()},
        "window": {
            "start": float(start),
            "end": float(end),
            "frames": int(inside.sum()),
            "means": {
                name: _mean(name, table[name][inside])
                for name in table.dtype.names or ()
                if name not in CUMULATIVE
            },
        },
        "events": events,
        "energies": _energies(path if path.is_dir() else path.parent, (start, end)),
    }


def without_nan(value: Any) -> Any:
    """The same data with None for what is not finite, as JSON wants it."""
    if isinstance(value, dict):
        return {key: without_nan(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _mean(name: str, values: Floats) -> dict[str, Any]:
    """The mean of a column over a window, and whether it has a trend."""
    found = mean_in_time(values, fraction=is_fraction(name), least=least(name))
    return {**found._asdict(), "trend": trend(values)}


class _Cells(StateAnalysis):
    """``rows``: time, ids and kinds of the cells of each frame."""

    def _measure(self, state: State) -> tuple[Any, ...]:
        return state.ids, state.kinds

    def _conclude(self) -> None:
        self.rows = self._rows


def _events(run: Run, events: Events, window: Window) -> dict[str, Any]:
    """Births and removals up to the last frame, their rates in the window, clones, mixing.

    Raises `SkinError` if they are not those of the trajectory.
    """
    last = len(run.universe.trajectory) - 1
    cells = _Cells(run.universe).run(frames=[0, last])
    (start, founders, kinds), (end, living, _) = cells.rows
    events = Events(*(column[events.time <= end] for column in events))
    births, deaths = events.of(BIRTH), events.of(*LEAVING)
    try:
        mixing = CloneMixing(run.universe, events).run(start=last).results.mixing
        begins = math.isclose(start, run.scene.begins, abs_tol=1e-9)
        clones = _clones(run, events, founders, kinds, (start, end)) if begins else []
    except ValueError as error:
        raise SkinError(f"events.csv does not go with the trajectory: {error}") from None
    return {
        "births": len(births.id),
        "removals": len(deaths.id),
        "removals_by_cause": dict(Counter(deaths.cause.tolist())),
        "interventions": by_intervention(events.kind.tolist(), events.cause.tolist()),
        "births_per_time": _rate(births, window),
        "removals_per_time": _rate(deaths, window),
        "cells": len(living),
        "clones": clones,
        "mixing": float(mixing[-1]),
    }


def _clones(
    run: Run, events: Events, founders: Ints, kinds: Ints, between: Window
) -> list[dict[str, Any]]:
    """Founder, births, removals and size at the end of each clone, the largest first."""
    start, end = between
    added = events.of(ADDITION)
    founders, kinds = with_added(founders, events), np.concatenate([kinds, added.type])
    happened = turnover(events, founders, [start, max(end, start + 1.0)])
    sizes = clone_sizes(events, founders, [end])[0]
    columns = {
        "founder": founders.tolist(),
        "kind": [run.scene.kind(number).label for number in kinds.tolist()],
        "births": happened.births[0].tolist(),
        "removals": happened.removals[0].tolist(),
        "size": sizes.tolist(),
    }
    largest_first = np.argsort(-sizes, kind="stable").tolist()
    return [{name: column[n] for name, column in columns.items()} for n in largest_first]


def _rate(events: Events, window: Window) -> float:
    """Events per time unit of the window; NaN for a window of one moment."""
    start, end = window
    number = int(((events.time > start) & (events.time <= end)).sum())
    return number / (end - start) if end > start else math.nan


def _energies(directory: Path, window: Window) -> dict[str, Any] | None:
    log = directory / "log.lammps"
    if not log.exists():
        return None
    found = read_energies(log)
    inside = (found["time"] >= window[0]) & (found["time"] <= window[1])
    return {
        name: {
            "first": float(values[0]),
            "last": float(values[-1]),
            "mean": float(values[inside].mean()) if inside.any() else math.nan,
        }
        for name, values in found.items()
        if name != "time"
    }
