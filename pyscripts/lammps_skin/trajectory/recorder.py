"""The trajectory of a run that Python drives, written while it runs."""

from __future__ import annotations

import math
import os
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from lammps_skin.errors import DamagedError, SkinError
from lammps_skin.files import set_aside
from lammps_skin.model.scene import Scene
from lammps_skin.trajectory.connectivity import connectivity
from lammps_skin.trajectory.convert import convert
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.frame import Frame
from lammps_skin.trajectory.packed import PackedFrame, pack
from lammps_skin.trajectory.store import DUMP, STORE, Store, trajectory_of
from lammps_skin.trajectory.writer import Note, TrajectoryWriter, reason


class Recorder:
    """Writes skin.h5 at the start of a run, and at every multiple of the dump interval.

    A file in HDF5 that is being changed is broken if the process is killed at that moment. So
    there are two: a frame goes to skin.h5.next, which then takes the place of skin.h5, in one
    step of the file system; the former skin.h5 becomes the next and lacks that frame alone. At
    every moment, skin.h5 is complete and closed, and what others have open does not change. Each
    frame is packed once and written twice, at a cost that does not depend on how many there are.

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
        self._notes: list[Note] = []  # not yet in skin.h5
        # in skin.h5.next; None: that has to be made
        self._missing: list[PackedFrame | Note] | None = None
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
                self._last_step = self._begin(step, engine.time())
                due = due or "restart" not in self._variables
            if due and step != self._last_step:
                state = engine.box(), engine.forces(), engine.cells(), engine.next_id()
                self._add(Frame.of_engine(step, engine.time(), *state))
                self._last_step = step
        except OSError as error:
            raise self._failure(error) from None

    def note(self, engine: Any, text: str) -> None:
        """Have a line in the history that skin.h5 holds: something was changed at this moment."""
        self._notes.append(Note(engine.step(), engine.time(), text))

    def close(self, sound: bool = True) -> None:
        """Leave skin.h5 alone behind; with all notes in it, if the run has ended well."""
        try:
            if sound and self._notes and self._last_step is not None:
                self._add()
            self._next.unlink(missing_ok=True)
        except OSError as error:
            raise self._failure(error) from None
        finally:
            self._missing = None

    def _failure(self, error: OSError) -> SkinError:
        return SkinError(f"trajectory {self.path}: {reason(error)}")

    def _every(self, engine: Any) -> int:
        """Steps between frames; 0 for none."""
        return steps_between(self._interval, engine)

    def _counted(self, engine: Any) -> int:
        """The step that it would be if all had been as long as this one: frames keep to times."""
        return round(engine.time() / engine.timestep())

    def _begin(self, step: int, time: float) -> int:
        """Make a skin.h5 that goes on at a step; the step of its last frame, -1 without any.

        It has the frames of a dump that came before, so that a dump that comes after is known by
        its first frame.
        """
        directory = self.path.parent
        resumed = "restart" in self._variables
        if resumed and self._is_in_dump(directory):
            convert(directory)
        self._next.unlink(missing_ok=True)
        if resumed and self.path.exists():
            shutil.copyfile(self.path, self._next)
            writer = TrajectoryWriter.append(self._next, until=step)
            writer.go_on(step, time, self._variables)
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
        return last and len(Dump(dump)) > 0

    def _add(self, *frames: Frame) -> None:
        """Add to skin.h5.next what it lacks and a frame, and let the two change places.

        Where the former skin.h5 can have no second name, it is gone, and the next is a copy.
        """
        news: list[PackedFrame | Note] = [*self._notes, *map(pack, frames)]
        with self._writer() as writer:
            missing, self._missing = [*(self._missing or []), *news], None
            for one in missing:
                writer.add(one)
        former = self.path.with_name(f"{STORE}.former")
        former.unlink(missing_ok=True)
        try:
            os.link(self.path, former)
        except OSError:  # a file system without hard links
            self._next.replace(self.path)
        else:
            self._next.replace(self.path)
            former.replace(self._next)
            self._missing = news
        self._notes = []

    def _writer(self) -> TrajectoryWriter:
        """Writer of skin.h5.next.

        Whoever opened skin.h5 when that was its name may still read it: HDF5 then refuses, and
        a copy is taken. So it is where files cannot be locked.
        """
        if self._missing is not None:
            try:
                return TrajectoryWriter.append(self._next, alone=True)
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
    """Read all frames of skin.h5; if it is damaged, give it another name, and say so in a line.

    After a kill there is skin.h5.next, which takes its place. Raises `SkinError` for a file that
    cannot be read now, as one that somebody else has locked: it may be whole.
    """
    path, spare = directory / STORE, directory / f"{STORE}.next"
    if not path.exists() or _is_whole(path):
        return None
    takes_over = spare.exists() and _is_whole(spare)
    aside = set_aside(path)
    if takes_over:
        spare.replace(path)
        return (
            f"trajectory {path}: was damaged, now {aside.name}; {spare.name}, which can lack a "
            "frame, replaces it"
        )
    return f"trajectory {path}: is damaged, now {aside.name}; a new one begins at the checkpoint"


def _is_whole(path: Path) -> bool:
    try:
        return all(len(frame.ids) for frame in Store(path))
    except DamagedError:
        return False
