"""All that the page tells of a study, from its tables: means over seeds, and time courses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from lammps_skin.analysis.derived import average, course, parts
from lammps_skin.analysis.observables import Table
from lammps_skin.analysis.observables import columns as observed
from lammps_skin.analysis.statistics import Mean
from lammps_skin.analysis.summary import without_nan
from lammps_skin.engine.built import SCENE_FILE
from lammps_skin.errors import SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.report.record import Record, record
from lammps_skin.report.words import titles
from lammps_skin.study.ranges import Window
from lammps_skin.study.studies.answer import SHOWN
from lammps_skin.study.studies.runs import DESIGN
from lammps_skin.study.studies.sensitivity import has_indices, sensitivities
from lammps_skin.study.studies.tables import MEANS, read_courses, read_means, read_sample
from lammps_skin.text import counted
from lammps_skin.trajectory.store import STORE

MOST_CURVES = 24  # points whose time courses are drawn
DIGITS = 4
UNDEFINED = (np.nan, np.nan, np.nan, 0)
INDICES = {  # of a sample, and what they are
    "morris": {
        "mu_star": "mean absolute effect (mu*)", "mu": "mean effect (mu)",
        "sigma": "standard deviation of effects (sigma)",
    },
    "sobol": {"first": "first-order index of Sobol", "total": "total index of Sobol"},
}  # fmt: skip


def is_study(folder: Path) -> bool:
    """Whether a directory is that of a study which has its tables."""
    return (folder / MEANS).is_file()


class StudyTables:
    """The tables of a study.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    SkinError
        If there are no tables, or no run is done.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.means = folder, read_means(folder)
        self.labels = list(dict.fromkeys(self.means["point"]))
        self.windows = list(dict.fromkeys(self.means["window"]))
        self._point = np.array(self.means["point"], object)
        self._window = np.array(self.means["window"], object)
        self.status = np.array(self.means["status"], object)
        if not (self.status == "done").any():
            raise SkinError(f"study {folder}: no run is done")

    def runs(self, label: str) -> list[tuple[str, int, str]]:
        """Name, seed and status of each run of a point."""
        mine = np.flatnonzero((self._point == label) & (self._window == self.windows[0]))
        return [(self.means["run"][n], self.means["seed"][n], self.status[n]) for n in mine]

    def directory(self, run: str) -> Path:
        """Where a run is."""
        return self.folder / "runs" / run

    def mean(self, label: str, window: str, column: str) -> Mean:
        """Mean over the seeds of a point in a window."""
        mine = (self._point == label) & (self._window == window)
        return average(course(self.means, column)[mine], column)

    def drawn(self, label: str) -> dict[str, Any]:
        """Keys and values of a point of a sample; of others the label has them."""
        if not label.rpartition(", ")[2].startswith("sample "):
            return {}
        names = list(self.means)
        keys = names[names.index("condition") + 1 : names.index("seed")]
        row = int(np.flatnonzero(self._point == label)[0])
        return {key: self.means[key][row] for key in keys}

    def scenes(self) -> Iterator[Scene]:
        """The scene of each point of which a run is done."""
        for label in self.labels:
            done = [name for name, _, status in self.runs(label) if status == "done"]
            if done:
                yield Scene.load(self.directory(done[0]) / SCENE_FILE)

    def kept(self) -> dict[str, tuple[Path, int]]:
        """The first run of each point that has a trajectory, and its seed."""
        found: dict[str, tuple[Path, int]] = {}
        for label in self.labels:
            for name, seed, _ in self.runs(label):
                if (self.directory(name) / STORE).is_file():
                    found.setdefault(label, (self.directory(name), seed))
        return found


def study_pages(
    folder: Path, most: int, frames: int | None = None, dermis: bool = False
) -> tuple[dict[str, Any], list[Record]]:
    """What the page tells of a study, and of a run of each point whose trajectory was kept.

    Parameters
    ----------
    folder : Path
        Of the study.
    most : int
        Most runs on a page.
    frames : int, optional
    dermis : bool
        See `record`.

    Raises
    ------
    SkinError
        If there are no tables, if no run is done, or if a run cannot be read.
    """
    tables = StudyTables(folder)
    kept = tables.kept()
    pictured = dict(list(kept.items())[:most])
    records = []
    for label, (directory, seed) in pictured.items():
        one = record(directory, frames, dermis, len(pictured))
        records.append(one._replace(told={**one.told, "name": f"{label}, seed {seed}"}))
    return without_nan(_told(tables, kept, most)), records


def _told(tables: StudyTables, kept: dict[str, Any], most: int) -> dict[str, Any]:
    courses = read_courses(tables.folder)
    scenes = list(tables.scenes())
    kinds = list(dict.fromkeys(kind for scene in scenes for kind in scene.kinds_of_cells))
    measured = next(iter(courses.values())).dtype.names or ()
    columns = titles([name for name in observed(kinds) if name in measured])
    known = {one["name"] for one in columns}
    first = [
        {**one, "group": "At a glance"}
        for one in titles(SHOWN) if known.issuperset(parts(one["name"]))
    ]  # fmt: skip
    wanted = list(dict.fromkeys(one["name"] for one in (*first, *columns)))
    means = {
        window: {
            column: [_digits(tables.mean(label, window, column)) for label in tables.labels]
            for column in wanted
        }
        for window in tables.windows
    }
    return {
        "name": tables.folder.resolve().name,
        "scene": scenes[0].description or scenes[0].name,
        "parameters": scenes[0].parameters,
        "points": [
            {"name": label, "done": sum(status == "done" for *_, status in tables.runs(label)),
             "runs": len(tables.runs(label)), "drawn": tables.drawn(label)}
            for label in tables.labels
        ],
        "windows": tables.windows,
        "columns": [*first, *columns],
        "means": means,
        "indices": list(_indices(tables, courses, [one["name"] for one in first])),
        "curves": [
            _curve(label, courses[label], columns)
            for label in tables.labels[:MOST_CURVES] if label in courses
        ],
        "warnings": list(_warnings(tables)),
        "remarks": list(_remarks(tables, kept, most)),
        "file": _design(tables.folder),
    }  # fmt: skip


def _indices(
    tables: StudyTables, courses: Mapping[str, Table], wanted: Sequence[str]
) -> Iterator[dict[str, Any]]:
    """What a sample of Morris or Sobol tells in each window: of each key, of each column."""
    sample = read_sample(tables.folder)
    if not sample or not has_indices(sample):
        return
    for window in tables.windows:
        span = Window(*(float(end) for end in window.split("-")))
        found = sensitivities(sample, tables.labels, courses, wanted, span)
        known = [one for one in found if len(one.values)]
        for head in INDICES[sample.method]:
            yield {
                "window": window, "title": INDICES[sample.method][head],
                "keys": list(sample.ranges), "columns": [one.title for one in known],
                "values": [
                    [[float(f"{row[one.heads.index(name)]:.{DIGITS}g}")
                      for name in (head, f"{head}_error") if name in one.heads]
                     for one, row in zip(known, rows, strict=True)]
                    for rows in zip(*(one.values for one in known), strict=True)
                ],
            }  # fmt: skip


def _curve(label: str, table: Table, columns: Sequence[dict[str, str]]) -> dict[str, Any]:
    """Means of a point over time, with the ends of their intervals.

    Where less than half of the seeds have a value there is none: means are of most of them.
    """
    times = np.unique(table["time"])
    found: dict[str, dict[str, list[float]]] = {part: {} for part in ("table", "low", "high")}
    found["table"]["time"] = times.tolist()
    for one in columns:
        name = one["name"]
        means = [_digits(average(table[name][table["time"] == time], name)) for time in times]
        most = max(mean[-1] for mean in means)
        means = [mean if 2 * mean[-1] >= most else UNDEFINED for mean in means]
        for n, part in enumerate(("table", "low", "high")):
            found[part][name] = [mean[n] for mean in means]
    return {
        "name": label, "from": float(times[0]), "to": float(times[-1]), "columns": columns,
        **found,
    }  # fmt: skip


def _digits(mean: Mean) -> tuple[float, float, float, int]:
    """Value, ends of the interval, number of seeds, in few digits."""
    value, low, high = (float(f"{x:.{DIGITS}g}") for x in (mean.value, mean.low, mean.high))
    return value, low, high, mean.n


def _warnings(tables: StudyTables) -> Iterator[str]:
    """What is missing."""
    for word in ("failed", "missing"):
        lost = [
            f"{label}, seed {seed}"
            for label in tables.labels
            for _, seed, status in tables.runs(label) if status == word
        ]  # fmt: skip
        if lost:
            more = f" and {counted(len(lost) - 3, 'other')}" if len(lost) > 3 else ""
            yield f"{word.capitalize()}: {'; '.join(lost[:3])}{more}. Means are of the others."
    sample = read_sample(tables.folder)
    if sample and sample.remark:
        yield sample.remark
    if max(len(tables.runs(label)) for label in tables.labels) < 2:
        yield "Each point has one seed, so there are no intervals."


def _remarks(tables: StudyTables, kept: dict[str, Any], most: int) -> Iterator[str]:
    """What the page shows of the study."""
    if len(tables.labels) > MOST_CURVES:
        yield f"Curves show the first {MOST_CURVES} of {len(tables.labels)} points."
    if not kept:
        yield "There are no pictures: with --keep, skin study keeps the trajectories."
    elif len(kept) > most or len(kept) < len(tables.labels):
        yield (
            f"Pictures are of {min(len(kept), most)} of {len(tables.labels)} points: of at most "
            f"{most}, and of runs whose trajectory was kept."
        )


def _design(folder: Path) -> str:
    with suppress(OSError, UnicodeDecodeError):
        return (folder / DESIGN).read_text("utf-8")
    return ""
