"""A run as it goes on, from the files in its directory."""

from __future__ import annotations

import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lammps_skin.analysis.energies import read_energies
from lammps_skin.analysis.observables import Observables, Run, Table, open_run
from lammps_skin.errors import SkinError
from lammps_skin.event_log import BIRTH, LEAVING
from lammps_skin.model.scene import Scene
from lammps_skin.run.checkpoints import DATA, checkpoint_times
from lammps_skin.run.directory_lock import is_held
from lammps_skin.run.results import LOG


class Look(NamedTuple):
    """A run at one moment.

    Attributes
    ----------
    scene : Scene
    time : float
        What the run has reached, by its log or its last frame.
    running : bool
        Whether it goes on.
    speed : float
        Time units in a second, of late; NaN if that is not known.
    checkpoint : float
        Time of the last checkpoint; NaN without one.
    births : int
    removals : dict of str to int
        Cells that have left, by cause.
    table : Table
        Observables of all frames so far.
    """

    scene: Scene
    time: float
    running: bool
    speed: float
    checkpoint: float
    births: int
    removals: dict[str, int]
    table: Table

    @property
    def seconds_left(self) -> float:
        """NaN if it is not known."""
        return (self.scene.end_time - self.time) / self.speed if self.speed > 0 else np.nan

    @property
    def ended(self) -> bool:
        """Whether the run has reached its end, or was stopped."""
        return not self.running or self.time >= self.scene.end_time * (1 - 1e-9)


class Watched:
    """A run directory that is looked at again and again; each frame is measured once."""

    def __init__(self, directory: Path) -> None:
        if not directory.is_dir():
            raise SkinError(f"directory {directory}: is none; only a run's directory is watched")
        self.directory = directory
        self._table: Table | None = None
        self._reached = -np.inf

    def look(self) -> Look:
        """What there is now.

        Raises
        ------
        SkinError
            If there is no trajectory, or if it or the event log cannot be read.
        """
        with open_run(self.directory) as run:
            table = self._measured(run)
            scene, events = run.scene, run.events
        reached = max(float(table["time"][-1]), self._logged())
        running = is_held(self.directory) or reached > self._reached > -np.inf
        self._reached = reached
        saved = checkpoint_times(self.directory)
        return Look(
            scene=scene,
            time=reached,
            running=running,
            speed=self._speed(reached, scene.begins, saved) if running else np.nan,
            checkpoint=max(saved, default=np.nan),
            births=len(events.of(BIRTH).id) if events else 0,
            removals=dict(Counter(events.of(*LEAVING).cause.tolist())) if events else {},
            table=table,
        )

    def _measured(self, run: Run) -> Table:
        """Observables of all frames; only those of new ones are measured."""
        times = np.asarray(run.universe.trajectory.frames.times)
        known = self._table
        if known is not None and np.array_equal(known["time"], times[: len(known)]):
            new = list(range(len(known), len(times)))
        else:
            known, new = None, list(range(len(times)))
        if new:
            more: Table = Observables(run.universe, run.events).run(frames=new).results.table
            known = more if known is None else np.concatenate([known, more])
        assert known is not None
        self._table = known
        return known

    def _logged(self) -> float:
        """Time of the last line of the log."""
        try:
            return float(read_energies(self.directory / LOG)["time"][-1])
        except SkinError:  # none yet
            return -np.inf

    def _speed(self, reached: float, begins: float, saved: dict[float, Path]) -> float:
        """Since the oldest checkpoint that is kept, or since the run was built."""
        since, path = next(iter(saved.items()), (begins, self.directory / DATA))
        try:
            seconds = time.time() - path.stat().st_mtime
        except OSError:
            return np.nan
        return (reached - since) / seconds if seconds > 0 and reached > since else np.nan
