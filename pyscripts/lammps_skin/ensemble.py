"""Runs of scenes with many seeds, each reduced to its table of observables.

In a folder of an ensemble, ``runs/NAME-SEED-KEY.csv`` is the table of one run, and
``NAME.csv.gz`` has those of all seeds of a scene below each other, with a column for the seed.
The key is a hash of all that the scene says and of the version of the observables: a run whose
table is there is not run again.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import signal
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.lib import recfunctions

from lammps_skin import cost, observables
from lammps_skin.analysis.geometry import Floats
from lammps_skin.analysis.statistics import Mean, mean
from lammps_skin.checkpoints import wait_for_others
from lammps_skin.errors import SceneError, SkinError
from lammps_skin.observables import Table, open_run, save
from lammps_skin.observables import load as load
from lammps_skin.scene import Scene
from lammps_skin.simulation import Simulation

REPORTS = 200  # of the time of a run to the bar
Progress = Callable[[float], None]


@dataclass(frozen=True)
class Member:
    """One run of an ensemble: a scene with its seed, in the folder of the ensemble."""

    scene: Scene
    folder: Path

    @property
    def label(self) -> str:
        return f"{self.scene.name}, seed {self.scene.seed}"

    @property
    def key(self) -> str:
        """Hash of what the seeds of a scene have in common, and of what is observed."""
        content = self.scene.model_dump(mode="json", exclude={"seed", "description"})
        text = json.dumps([observables.VERSION, content], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:12]

    @property
    def directory(self) -> Path:
        """Run directory."""
        return self.folder / "runs" / f"{self.scene.name}-{self.scene.seed}-{self.key}"

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

    def run(self, keep: bool = False, progress: Progress | None = None) -> None:
        """Run to the end time, store the observables, remove the run directory.

        What an earlier process has left there goes on from its last checkpoint.
        """

        def report(time: float, _: Simulation) -> None:
            if progress:
                progress(time)

        with self._simulation() as simulation:
            simulation.run(progress=report, every=self.scene.end_time / REPORTS)
        self.store(self.directory)
        if not keep:
            shutil.rmtree(self.directory)

    def _simulation(self) -> Simulation:
        wait_for_others(self.directory)
        try:
            return Simulation.resume(self.directory)
        except SkinError:
            shutil.rmtree(self.directory, ignore_errors=True)
            return Simulation(self.scene, self.directory)

    def store(self, directory: Path) -> None:
        """Store the observables of a run of this scene that has come to its end."""
        found = observables.observables(directory)
        reached, end = found["time"][-1], self.scene.end_time
        # the last frame of a run comes at most one interval before its end
        if reached + self.scene.output.dump_interval < end:
            raise SkinError(f"run {directory}: its trajectory ends at t = {reached:g} of {end:g}")
        save(found, self.table, [f"{self.label}, key {self.key}"])


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
    return [Member(scene.replace(seed=seed), folder) for scene in scenes for seed in seeds]


def member_of(directory: Path, folder: Path) -> Member:
    """The member that was run in a directory, in the folder of an ensemble."""
    with open_run(directory) as run:
        return Member(run.scene, folder)


# ---- running


class Running(NamedTuple):
    """A run in a process of its own."""

    member: Member
    process: Any


def run_all(
    todo: Sequence[Member],
    jobs: int = 1,
    keep: bool = False,
    progress: Callable[[Member, float], None] | None = None,
) -> dict[Member, str]:
    """Run members in processes, `jobs` at a time.

    Parameters
    ----------
    todo : sequence of Member
    jobs : int
    keep : bool
        Keep the run directories.
    progress : callable, optional
        Called as ``progress(member, time)`` with the time that a run has reached.

    Returns
    -------
    dict of Member to str
        What went wrong in the runs that failed; their directories are kept.
    """
    context = get_context("spawn")
    waiting, failures = list(reversed(todo)), {}
    running: dict[Connection, Running] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                member = waiting.pop()
                receiver, sender = context.Pipe(duplex=False)
                process = context.Process(target=_work, args=(member, keep, sender), daemon=True)
                process.start()
                sender.close()
                running[receiver] = Running(member, process)
            for connection in wait(list(running)):
                assert isinstance(connection, Connection)
                member, process = running[connection]
                try:
                    news = connection.recv()
                except EOFError:
                    process.join()
                    news = f"its process ended with exit code {process.exitcode}"
                if isinstance(news, float):
                    if progress:
                        progress(member, news)
                    continue
                if news is not None:
                    failures[member] = news
                del running[connection]
                connection.close()
                process.join()
    finally:
        for _, process in running.values():
            process.terminate()
            process.join()
    return failures


def _work(member: Member, keep: bool, sender: Connection) -> None:
    """In a process of its own: times as they are reached, then None or an error."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its children
    try:
        member.run(keep, lambda time: sender.send(float(time)))
        sender.send(None)
    except (SkinError, OSError) as error:
        sender.send(str(error))


# ---- results


def gather(members: Iterable[Member]) -> list[Path]:
    """Gather the tables of each scene, of these and of all other seeds that are there.

    The same tables give the same bytes. Scenes without a table are left out.
    """
    written = []
    for member in {member.gathered: member for member in members}.values():
        name, key = member.scene.name, member.key
        tables = {
            int(path.name.split("-")[-2]): load(path)
            for path in member.table.parent.glob(f"{name}-*-{key}.csv")
            if path.name.removeprefix(f"{name}-").removesuffix(f"-{key}.csv").isdigit()
        }
        if tables:
            together = [with_seed(tables[seed], seed) for seed in sorted(tables)]
            comments = [
                f"{name}, seeds {', '.join(map(str, sorted(tables)))}, key {key}",
                f"scene: {json.dumps(member.scene.given(), sort_keys=True)}",
            ]
            save(np.concatenate(together), member.gathered, comments)
            written.append(member.gathered)
    return written


def with_seed(table: Table, seed: int) -> Table:
    """The table with a first column for the seed."""
    new = np.full(len(table), float(seed)).view([("seed", float)])
    together: Table = recfunctions.merge_arrays([new, table], flatten=True)
    return together


def window_means(table: Table, column: str, start: float, end: float) -> Floats:
    """Mean (s,) of a column over the times from start to end, for each seed, ascending.

    NaN in frames is left out; a seed without a value in the window is NaN.
    """
    inside = table[(table["time"] >= start) & (table["time"] <= end)]
    means = []
    for seed in np.unique(table["seed"]):
        values = inside[column][inside["seed"] == seed]
        values = values[~np.isnan(values)]
        means.append(values.mean() if len(values) else np.nan)
    return np.array(means, float)


def window_mean(table: Table, column: str, start: float, end: float) -> Mean:
    """Mean over seeds of the means over a window, with standard error and 95 % interval (t)."""
    return mean(window_means(table, column, start, end))


def over_time(table: Table, column: str) -> tuple[Floats, list[Mean]]:
    """Mean over seeds at every time (t,), with standard error and 95 % interval."""
    times = np.unique(table["time"])
    return times, [mean(table[column][table["time"] == time]) for time in times]
