"""Ensembles of the paper's scenes, as they lie in a folder, and their means over windows of time.

The gathered table of a scene is SIZE-SCENE.csv.gz, such as quarter-ring.csv.gz.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.analysis.basal_layer import COVERED, LAYER
from lammps_skin.analysis.observables import Table, read_table
from lammps_skin.analysis.statistics import Mean, mean
from lammps_skin.arrays import Floats
from lammps_skin.errors import SkinError
from lammps_skin.model.scenes import ARRANGEMENTS, BUILT_IN, SIZES
from lammps_skin.study.ensemble import scene_of, window_means
from lammps_skin.study.ranges import Window

END = 1000.0  # of the paper's runs
LATER = 500.0  # length of windows after it


WINDOWS = (Window(400, 600), Window(600, 800), Window(800, 1000))
"""What is to last is tested in each of them, and in windows of `LATER` after the last one."""


@dataclass
class Ensemble:
    """The runs of one scene with several seeds.

    Attributes
    ----------
    scene : str
        One of `ARRANGEMENTS`.
    table : Table
        Observables, with a column ``seed``.
    given : mapping
        What was given of the scene; empty if that is not known.
    path : Path
        Of the table.
    """

    scene: str
    table: Table
    given: Mapping[str, Any] = field(default_factory=dict)
    path: Path = Path()
    _means: dict[tuple[str, Window], Floats] = field(default_factory=dict, repr=False)

    @property
    def seeds(self) -> int:
        return len(np.unique(self.table["seed"]))

    @property
    def end(self) -> float:
        """Time of the last frame of all seeds."""
        seeds = np.unique(self.table["seed"])
        return float(min(self.table["time"][self.table["seed"] == seed].max() for seed in seeds))

    @property
    def later(self) -> list[Window]:
        """Windows after those of the paper."""
        starts = np.arange(END, self.end - LATER + 1e-9, LATER)
        return [Window(float(start), float(start) + LATER) for start in starts]

    @property
    def windows(self) -> list[Window]:
        return [*WINDOWS, *self.later]

    @property
    def late(self) -> Window:
        """From the begin of the first of the windows to the end of the last."""
        return Window(WINDOWS[0].start, self.windows[-1].end)

    def mean(self, column: str, window: Window) -> Floats:
        """Mean (s,) of a column over a window, for each seed; raises `SkinError` without it."""
        if column not in (self.table.dtype.names or ()):
            raise SkinError(f"table {self.path}: has no column {column}")
        if (column, window) not in self._means:
            self._means[column, window] = window_means(self.table, column, *window)
        return self._means[column, window]

    def none_below(self) -> dict[Window, Mean]:
        """Fraction of the cells with no other cell straight below, while they cover the membrane.

        In each of the windows; empty without the column.
        """
        if "none_below" not in (self.table.dtype.names or ()):
            return {}
        covered = self.table[self.table["coverage"] >= COVERED]
        return {
            window: mean(window_means(covered, "none_below", *window), fraction=True)
            for window in self.windows
        }

    def first_time(self, column: str, level: float) -> Floats:
        """First time (s,) at which a column reaches a level; that of the last frame if never."""
        reached = self.table[column] >= level
        times = np.where(reached, self.table["time"], np.inf)
        seeds = np.unique(self.table["seed"])
        first = np.array([times[self.table["seed"] == seed].min() for seed in seeds])
        return np.minimum(first, self.end)


def load(folder: Path) -> dict[str, dict[str, Ensemble]]:
    """The ensembles in a folder, by size and scene, in the order of the built-in scenes.

    Raises
    ------
    SkinError
        If there is none, if a table is damaged, or if it is none of an ensemble.
    """
    found: dict[str, dict[str, Ensemble]] = {size: {} for size in SIZES}
    for size in SIZES:
        for scene in ARRANGEMENTS:
            path = folder / f"{size}-{scene}.csv.gz"
            if path.exists():
                table = read_table(path)
                lacking = {"seed", "time"} - set(table.dtype.names or ())
                if lacking or not len(table):
                    raise SkinError(f"table {path}: is no table of an ensemble")
                found[size][scene] = Ensemble(scene, table, scene_of(path), path)
    there = {size: scenes for size, scenes in found.items() if scenes}
    if not there:
        raise SkinError(
            f"folder {folder}: has no table of an ensemble of the paper's scenes, such as "
            f"quarter-ring.csv.gz; the sizes are {', '.join(SIZES)}, the scenes "
            f"{', '.join(ARRANGEMENTS)}"
        )
    return there


def settings(size: str, ensembles: Mapping[str, Ensemble]) -> dict[str, list[str]]:
    """What was given beside the built-in scenes, in words: the scenes with which it was."""
    found: dict[str, list[str]] = {}
    for scene, ensemble in ensembles.items():
        own = set_keys(size, ensemble)
        words = ", ".join(f"{key} = {json.dumps(own[key])}" for key in sorted(own))
        found.setdefault(words or "not known", []).append(scene)
    return found


def set_keys(size: str, ensemble: Ensemble) -> dict[str, Any]:
    """What was given beside the built-in scene, by dotted keys; nothing if that is not known."""
    name = f"{size}-{ensemble.scene}"
    usual = {"name": name, **dict(flat(BUILT_IN[name]))}
    return {key: value for key, value in flat(ensemble.given) if value != usual.get(key)}


def flat(keys: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys of nested ones, with their values."""
    for key, value in keys.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def layer_remarks(ensembles: Mapping[str, Ensemble]) -> list[str]:
    """Which tissues are no basal layer once they cover the membrane, and of which it is unknown."""
    remarks, unknown = [], []
    for scene, ensemble in ensembles.items():
        values = ensemble.none_below()
        if not values:
            unknown.append(scene)
            continue
        lowest = min(values, key=lambda window: np.nan_to_num(values[window].value, nan=1.0))
        if values[lowest].value < LAYER:
            remarks.append(
                f"{scene} is not a basal layer: over t = {lowest} only "
                f"{values[lowest].value:.2f} of the cells have no other cell straight below "
                f"(in a basal layer it is at least {LAYER:g}); its papillae, and cells on their "
                "tips, are those of a heap of cells"
            )
    if unknown:
        remarks.append(
            f"not known whether a basal layer, for want of the column none_below: "
            f"{', '.join(unknown)}"
        )
    return remarks
