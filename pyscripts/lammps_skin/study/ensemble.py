"""Runs of scenes with many seeds, each reduced to its table of observables.

In a folder of an ensemble, ``runs/NAME-SEED-KEY.csv`` is the table of one run, and
``NAME.csv.gz`` has those of all seeds of a scene below each other, with a column for the seed.
The key is a hash of all that the scene says and of the versions of LAMMPS, of the package, of the
plugin and of the observables: a run whose table is there is not run again. Where ``NAME.csv.gz``
is there with another key, it stays, and the gathered table is ``NAME-KEY.csv.gz``.
"""

from __future__ import annotations

import gzip
import json
import os
import re
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.lib import recfunctions

from lammps_skin.analysis import observables
from lammps_skin.analysis.derived import average, course
from lammps_skin.analysis.observables import Table, open_run, read_table, write_table
from lammps_skin.analysis.statistics import Mean
from lammps_skin.arrays import Floats
from lammps_skin.errors import SceneError, SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.run.directory_lock import DirectoryLock
from lammps_skin.run.provenance import Provenance
from lammps_skin.run.results import holds_results
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration
from lammps_skin.study import cost
from lammps_skin.study.result_keys import result_key, without_seed
from lammps_skin.study.runner import Job, Progress
from lammps_skin.trajectory.store import Store
from lammps_skin.versions import versions

REPORTS = 200  # of the time of a run to the bar
SCENE = "scene: "  # begins the comment of a gathered table that says what was given
KEY = re.compile(r", key ([0-9a-f]+)$")  # how the first comment of a gathered table ends


@dataclass(frozen=True)
class Member(Job):
    """One run of an ensemble: a scene with its seed, in the folder of the ensemble.

    Attributes
    ----------
    scene : Scene
    folder : Path
    """

    scene: Scene
    folder: Path

    @property
    def seed(self) -> int:
        """Seed of the cells, by which runs of one key differ."""
        return self.scene.cell_seed

    @property
    def label(self) -> str:
        return f"{self.scene.name}, seed {self.seed}"

    @property
    def length(self) -> float:
        return self.scene.end_time

    def placed(self) -> Self:
        return replace(self, folder=self.folder.absolute())

    @property
    def key(self) -> str:
        """Of what the seeds of a scene have in common, of versions, of what is observed."""
        return result_key(observables.VERSION, without_seed(self.scene), made_by=dict(self.made_by))

    @property
    def directory(self) -> Path:
        """Run directory."""
        return self.folder / "runs" / f"{self.scene.name}-{self.seed}-{self.key}"

    @property
    def table(self) -> Path:
        """Where the observables are stored."""
        return self.directory.with_name(self.directory.name + ".csv")

    @property
    def done(self) -> bool:
        return self.table.is_file()

    @property
    def gathered(self) -> Path:
        """Where the tables of all seeds of the scene are gathered."""
        return self.folder / f"{self.scene.name}.csv.gz"

    @property
    def seconds(self) -> float:
        """Expected cost on one core."""
        return cost.estimate(self.scene).seconds

    @property
    def begun(self) -> Scene:
        """The scene, with the state with which the run begins."""
        return self.scene

    def run(self, keep: bool = False, progress: Progress | None = None) -> None:
        """Run to the end time, store the observables, remove the run directory.

        What an earlier process has left there goes on from its last checkpoint. If it cannot, it
        is left as it is, and a `SkinError` says why.
        """

        def report(time: float, _: Simulation) -> None:
            if progress:
                progress(time)

        with DirectoryLock(self.directory, make=True) as lock:
            if self.done:  # by another process, while it held the directory
                return
            with self._simulation(lock) as simulation:
                simulation.run(progress=report, every=self.scene.end_time / REPORTS)
            self.store(self.directory)
            self.note("done")
            if not keep:
                self.tidy()

    def tidy(self) -> None:
        """Remove what is not needed once the observables are stored."""
        shutil.rmtree(self.directory)

    def _simulation(self, lock: DirectoryLock) -> Simulation:
        if not holds_results(self.directory):
            self.note("begun")
            return Simulation.begin(self.begun, self.directory, ranks=None, lock=lock)
        self.note("resumed")
        try:
            return Simulation.resume(self.directory, ranks=None, lock=lock)
        except SkinError as error:
            raise SkinError(
                f"{error}; the run is kept: move {self.directory} away to begin anew"
            ) from None

    def store(self, directory: Path) -> None:
        """Store the observables of a run of this scene that has come to its end."""
        found = observables.observables(directory)
        reached, end = found["time"][-1], self.scene.end_time
        # the last frame of a run comes at most one interval before its end
        if reached + self.scene.output.dump_interval < end:
            raise SkinError(f"run {directory}: its trajectory ends at t = {reached:g} of {end:g}")
        write_table(found, self.table, [f"{self.label}, key {self.key}"])


def members(scenes: Iterable[Scene], seeds: Sequence[int], folder: Path) -> list[Member]:
    """Every scene with every seed.

    Raises `SceneError` for scenes of the same name, or whose runs would not differ.
    """
    scenes = list(scenes)
    names = [scene.name for scene in scenes]
    for scene in scenes:
        if names.count(scene.name) > 1:
            raise SceneError(f"name = {scene.name!r}: two scenes of an ensemble have this name")
        if scene.cells.seed is not None and len(seeds) > 1:
            raise SceneError(
                f"cells.seed = {scene.cells.seed}: must not be given in an ensemble, whose seeds "
                "are those of the scenes"
            )
        if not scene.output.dump_interval:
            raise SceneError("output.dump_interval = 0: an ensemble needs trajectories")
    begun = [
        Configuration.from_scene(scene).described(scene) if scene.start.run else scene
        for scene in scenes
    ]
    return [Member(scene.replace(seed=seed), folder) for scene in begun for seed in seeds]


def provenance(folder: Path, scenes: Iterable[Scene], seeds: Sequence[int]) -> Provenance:
    """What tells in a folder of each time that ensembles are run there."""
    names = ", ".join(scene.name for scene in scenes)
    used = {"scenes": names, "seeds": ", ".join(map(str, seeds))}
    about = "Ensembles of scenes with many seeds, with lammps-skin"
    return Provenance(folder, folder.resolve().name, about, used, (), ["*.csv.gz"], goes_on=True)


def expected_seconds(members: Iterable[Member]) -> float:
    """Expected cost on one core; it is the same for all seeds of a scene."""
    members = list(members)
    keys = [member.key for member in members]
    one_of_each = dict(zip(keys, members, strict=True))
    return sum(keys.count(key) * member.seconds for key, member in one_of_each.items())


def member_of(directory: Path, folder: Path) -> Member:
    """The member that was run in a directory, in the folder of an ensemble.

    Its versions are those that skin.h5 names; a dump names none, and those of today are taken.
    """
    with open_run(directory) as run:
        frames = run.universe.trajectory.frames
        made_by = versions()
        if isinstance(frames, Store):
            made_by = {name: frames.versions.get(name, "unknown") for name in made_by}
        return Member(run.scene, folder, made_by=tuple(made_by.items()))


# ---- results


def gather(members: Iterable[Member]) -> list[Path]:
    """Gather the tables of each scene, of these and of all other seeds that are there.

    Seeds that the gathered table has already, and that have no table of their own any more, stay
    in it. A gathered table of another key is left as it is, and this one has its key in its name.
    The same tables give the same bytes. Scenes without a table are left out.

    Returns
    -------
    list of Path
        Tables that were written.
    """
    written = []
    for member in {(member.gathered, member.key): member for member in members}.values():
        name, key, plain = member.scene.name, member.key, member.gathered
        keyed = plain.with_name(f"{name}-{key}.csv.gz")
        ours = [path for path in (keyed, plain) if _key_of(path) == key]
        tables: dict[int, Table] = {}
        for earlier in ours:
            tables |= by_seed(read_table(earlier))
        tables |= {
            int(file.name.split("-")[-2]): with_seed(
                read_table(file), int(file.name.split("-")[-2])
            )
            for file in member.table.parent.glob(f"{name}-*-{key}.csv")
            if file.name.removeprefix(f"{name}-").removesuffix(f"-{key}.csv").isdigit()
        }
        if not tables:
            continue
        path = keyed if os.path.lexists(plain) and plain not in ours else plain
        comments = [
            f"{name}, seeds {', '.join(map(str, sorted(tables)))}, key {key}",
            f"{SCENE}{json.dumps(member.scene.given(), sort_keys=True)}",
            f"made by: {', '.join(' '.join(pair) for pair in member.made_by)}",
        ]
        write_table(np.concatenate([tables[seed] for seed in sorted(tables)]), path, comments)
        if keyed in ours and path != keyed:
            keyed.unlink()
        written.append(path)
    return written


def scene_of(path: Path) -> dict[str, Any]:
    """What was given of the scene of a gathered table, as nested keys; nothing if it does not say.

    The seed and the description, in which runs of one ensemble may differ, are left out.
    """
    try:
        with gzip.open(path, "rt", encoding="utf-8") as file:
            lines = [line[2:] for line in islice(file, 3) if line.startswith(f"# {SCENE}")]
        given = json.loads(lines[0].removeprefix(SCENE)) if lines else {}
    except (OSError, EOFError, ValueError):
        return {}
    return {key: value for key, value in given.items() if key not in ("seed", "description")}


def _key_of(path: Path) -> str | None:
    """Key of a gathered table; None if there is no table that names one."""
    try:
        with gzip.open(path, "rt", encoding="utf-8") as file:
            found = KEY.search(file.readline().rstrip())
    except (OSError, EOFError, ValueError):
        return None
    return found[1] if found else None


def by_seed(table: Table) -> dict[int, Table]:
    """The table of each seed of a gathered table."""
    return {int(seed): table[table["seed"] == seed] for seed in np.unique(table["seed"])}


def with_seed(table: Table, seed: int) -> Table:
    """The table with a first column for the seed."""
    new = np.full(len(table), float(seed)).view([("seed", float)])
    together: Table = recfunctions.merge_arrays([new, table], flatten=True)
    return together


def window_means(table: Table, column: str, start: float, end: float) -> Floats:
    """Mean (s,) of a column over the times from start to end, for each seed, ascending.

    NaN in frames is left out; a seed without a value in the window is NaN.
    """
    seeds, place = np.unique(table["seed"], return_inverse=True)
    values, times = table[column], table["time"]
    inside = (times >= start) & (times <= end) & ~np.isnan(values)
    numbers = np.bincount(place[inside], minlength=len(seeds))
    sums = np.bincount(place[inside], values[inside], len(seeds))
    return np.where(numbers > 0, sums / np.maximum(numbers, 1), np.nan)


def window_mean(table: Table, column: str, start: float, end: float) -> Mean:
    """Mean over seeds of the means over a window, with standard error and 95 % interval (t)."""
    return average(window_means(table, column, start, end), column)


def over_time(table: Table, column: str) -> tuple[Floats, list[Mean]]:
    """Mean over seeds at every time (t,), with standard error and 95 % interval."""
    times, values = np.unique(table["time"]), course(table, column)
    return times, [average(values[table["time"] == time], column) for time in times]
