"""The trajectory of a run that Python drives, written while it runs."""

from __future__ import annotations

import math
import os
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from lammps_skin.errors import SkinError
from lammps_skin.scene import Scene
from lammps_skin.trajectory.connectivity import connectivity
from lammps_skin.trajectory.convert import convert
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.frame import Frame
from lammps_skin.trajectory.store import DUMP, STORE, Store, trajectory_of
from lammps_skin.trajectory.writer import TrajectoryWriter, reason


class Recorder:
    """Writes skin.h5 at every multiple of the dump interval.

    A file in HDF5 that is being changed is broken if the process is killed at that moment. So
    there are two: a frame goes to skin.h5.next, which then takes the place of skin.h5, in one
    step of the file system; the former skin.h5 becomes the next and lacks that frame alone. At
    every moment, skin.h5 is complete and closed, and what others have open does not change. Each
    frame is written twice, at a cost that does not depend on how many there are.

    Parameters
    ----------
    directory : Path
        A built scene.
    scene : Scene
    variables : mapping
        What is given to LAMMPS instead of the scene's values. With `restart`, the frames up to
        its step are kept and the later ones replaced.
    """

    def __init__(self, directory: Path, scene: Scene, variables: Mapping[str, object]) -> None:
        self.path = directory / STORE
        self._next = directory / f"{STORE}.next"
        self._scene = scene
        self._variables = dict(variables)
        self._interval = interval("dump_interval", scene, variables)
        self._missing: list[Frame] | None = None  # in skin.h5.next; None: it has to be made
        self._last_step: int | None = None  # None: skin.h5 has to be made

    def stops(self, engine: Any, step: int) -> Iterator[int]:
        """Steps of frames on the way to a step, and that step itself."""
        every, now = self._every(engine), self._counted(engine)
        if every:
            yield from range(engine.step() + every - now % every, step, every)
        yield step

    def record(self, engine: Any) -> None:
        """Write a frame if one is due now; raises `SkinError` if it cannot be written."""
        every, step = self._every(engine), engine.step()
        if not every:
            return
        due = self._counted(engine) % every == 0
        try:
            if self._last_step is None:
                self._last_step = self._begin(step)
            if due and step != self._last_step:
                sides = self._scene.box_sides
                self._add(
                    Frame.of_engine(step, engine.time(), sides, engine.forces(), engine.cells())
                )
                self._last_step = step
        except OSError as error:
            raise SkinError(f"trajectory {self.path}: {reason(error)}") from None

    def close(self) -> None:
        """Leave skin.h5 alone behind."""
        self._missing = None
        self._next.unlink(missing_ok=True)

    def _every(self, engine: Any) -> int:
        """Steps between frames; 0 for none."""
        return steps_between(self._interval, engine)

    def _counted(self, engine: Any) -> int:
        """The step that it would be if all had been as long as this one: frames keep to times."""
        return round(engine.time() / engine.timestep())

    def _begin(self, step: int) -> int:
        """Make a skin.h5 that goes on at a step; the step of its last frame, -1 without any.

        It has the frames of a dump that came before, so that a dump that comes after is known by
        its first frame.
        """
        directory = self.path.parent
        resumed = "restart" in self._variables
        if resumed and self._is_in_dump(directory):
            convert(directory)
        if resumed and self.path.exists():
            shutil.copyfile(self.path, self._next)
            writer = TrajectoryWriter.append(self._next, until=step)
        else:
            members = connectivity(directory)
            writer = TrajectoryWriter(self._next, self._scene, *members, variables=self._variables)
        writer.close()
        self._next.replace(self.path)
        (directory / DUMP).unlink(missing_ok=True)
        return writer.last_step

    def _is_in_dump(self, directory: Path) -> bool:
        """Whether `lmp` has run the scene last, and come to a frame."""
        dump = directory / DUMP
        last = dump.exists() and trajectory_of(directory) == dump
        return last and len(Dump(dump, self._scene.kinds)) > 0

    def _add(self, frame: Frame) -> None:
        """Add to skin.h5.next what it lacks and this frame, and let the two change places."""
        with self._writer() as writer:
            missing, self._missing = self._missing or [], None
            for one in (*missing, frame):
                writer.write(one)
        former = self.path.with_name(f"{STORE}.former")
        former.unlink(missing_ok=True)
        os.link(self.path, former)
        self._next.replace(self.path)
        former.replace(self._next)
        self._missing = [frame]

    def _writer(self) -> TrajectoryWriter:
        """Writer of skin.h5.next.

        Whoever opened skin.h5 when that was its name may still read it: HDF5 then refuses, and
        a copy is taken.
        """
        if self._missing is not None:
            try:
                return TrajectoryWriter.append(self._next)
            except OSError:
                self._missing = None
        self._next.unlink(missing_ok=True)
        shutil.copyfile(self.path, self._next)
        return TrajectoryWriter.append(self._next)


def interval(name: str, scene: Scene, variables: Mapping[str, object]) -> float:
    """An interval of the variables, which nobody has checked, or of the scene's output."""
    given = variables.get(name, getattr(scene.output, name))
    try:
        value = float(str(given))
    except ValueError:
        value = math.nan
    if not 0 <= value < math.inf:
        raise SkinError(f"variable {name} = {given}: must be a number >= 0")
    return value


def steps_between(interval: float, engine: Any) -> int:
    """Steps that an interval has, as in output.in; 0 for none."""
    return math.ceil(interval / engine.timestep() - 1e-6)


def set_aside_if_damaged(directory: Path) -> str | None:
    """Read all frames of skin.h5; if that fails, give it another name, and say so in a line.

    After a kill there is skin.h5.next, which takes its place.
    """
    path, spare = directory / STORE, directory / f"{STORE}.next"
    if not path.exists() or _is_whole(path):
        return None
    aside = path.with_name(f"{STORE}.damaged")
    path.replace(aside)
    if spare.exists() and _is_whole(spare):
        spare.replace(path)
        return f"trajectory {path}: was damaged; {spare.name}, which can lack a frame, replaces it"
    return f"trajectory {path}: is damaged, now {aside.name}; a new one begins at the checkpoint"


def _is_whole(path: Path) -> bool:
    try:
        return all(len(frame.ids) for frame in Store(path))
    except (SkinError, OSError, RuntimeError, KeyError, ValueError):
        return False
