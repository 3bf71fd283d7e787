"""A run that comes to its end undisturbed, and others that something happens to on their way."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from lammps_skin import files
from lammps_skin.engine.engine import Engine
from lammps_skin.errors import SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.run import checkpoints
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration
from lammps_skin.trajectory.frame import Frame
from lammps_skin.trajectory.store import Store
from lammps_skin.trajectory.writer import TrajectoryWriter

from tests.cells.conftest import busy_scene, crowd
from tests.trajectory.conftest import same

CHECKPOINT, PIECE, END = 1.0, 0.1, 8.0
PATIENCE = 120.0  # seconds to wait for a process, on a busy machine

# processes are forked from one that has imported all this, and opened no LAMMPS
processes = multiprocessing.get_context("forkserver")
processes.set_forkserver_preload(["tests.run.disturbed"])


def eventful() -> Scene:
    return busy_scene(
        **{
            "membrane.lattice": (16, 18), "end_time": END,
            "output.checkpoint_interval": CHECKPOINT, "output.dump_interval": 0.3,
        }
    )  # fmt: skip


def founders(scene: Scene) -> Configuration:
    return crowd(scene, across=4, amplitude=0.3, above=2.2)


class Outcome(NamedTuple):
    """What a run has come to: event log, frames, and ids and positions at its end."""

    events: str
    frames: list[Frame]
    ids: np.ndarray
    positions: np.ndarray


def outcome(directory: Path, ended: Simulation) -> Outcome:
    particles = ended.forces()
    log, store = (directory / "events.csv").read_text(), Store(directory / "skin.h5")
    return Outcome(log, list(store), particles.ids, particles.positions)


def finish(directory: Path) -> Outcome:
    """Resume a run and let it come to its end."""
    with Simulation.resume(directory) as resumed:
        resumed.run()
        return outcome(directory, resumed)


def assert_same(found: Outcome, expected: Outcome) -> None:
    """The same to the last bit."""
    assert found.events == expected.events
    np.testing.assert_array_equal(found.ids, expected.ids)
    np.testing.assert_array_equal(found.positions, expected.positions)
    assert len(found.frames) == len(expected.frames)
    assert all(map(same, found.frames, expected.frames))


def assert_close(found: Outcome, expected: Outcome) -> None:
    """The same events, and the same places but for rounding."""
    assert [line.split(",")[1:5] for line in found.events.splitlines()] == [
        line.split(",")[1:5] for line in expected.events.splitlines()
    ]
    np.testing.assert_array_equal(found.ids, expected.ids)
    np.testing.assert_allclose(found.positions, expected.positions, atol=1e-10)
    assert [frame.step for frame in found.frames] == [frame.step for frame in expected.frames]


class Runner:
    """Runs what is built in a directory, or goes on with it, in another process.

    Attributes
    ----------
    process : Process
    reached : float
        Time that it has told of.
    """

    def __init__(
        self,
        directory: Path,
        prepare: Callable[..., None] | None = None,
        *more: Any,
        ranks: int = 1,
    ) -> None:
        self._ours, theirs = processes.Pipe(duplex=False)
        arguments = (directory, ranks, theirs, prepare, *more)
        self.process = processes.Process(target=_run, args=arguments, daemon=False)
        self.process.start()
        theirs.close()
        self.reached = -1.0

    def __enter__(self) -> Runner:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def wait_for(self, time: float) -> None:
        """Until the run has reached a time."""
        while self.reached < time:
            assert self._ours.poll(PATIENCE)
            self.reached = self._ours.recv()

    def end(self) -> int:
        """Exit code; what it has told last counts."""
        self.process.join(PATIENCE)
        try:
            while self._ours.poll():
                self.reached = self._ours.recv()
        except EOFError:
            pass
        assert self.process.exitcode is not None
        return self.process.exitcode


def _run(
    directory: Path, ranks: int, told: Any, prepare: Callable[..., None] | None, *more: Any
) -> None:
    if prepare:
        prepare(*more)
    begun = (directory / checkpoints.MANIFEST).exists()
    start = Simulation.resume if begun else Simulation.begin_built
    with start(directory, ranks=ranks) as driven:
        told.send(driven.time)
        driven.run(progress=lambda time, _: told.send(time), every=PIECE)


def kill_at(tick: int) -> None:
    """In a process: kill it at some change that it makes to its files."""
    ticks = 0

    def around(function: Callable[..., Any]) -> Callable[..., Any]:
        def wrapped(*arguments: Any, **more: Any) -> Any:
            count()
            result = function(*arguments, **more)
            count()
            return result

        return wrapped

    def count() -> None:
        nonlocal ticks
        ticks += 1
        if ticks == tick:
            os.kill(os.getpid(), signal.SIGKILL)

    for place, name in (
        (checkpoints, "sync"), (files, "sync"), (Path, "replace"), (Path, "unlink"),
        (Path, "write_text"), (TrajectoryWriter, "_append"), (TrajectoryWriter, "write"),
        (Engine, "run_to"),
    ):  # fmt: skip
        setattr(place, name, around(getattr(place, name)))


def assert_whole(directory: Path) -> None:
    """Every file of a run that was killed can be read, and at most one interval is lost."""
    if (directory / "skin.h5").exists():
        assert all(len(frame.ids) for frame in Store(directory / "skin.h5"))
    for line in (directory / "events.csv").read_text().splitlines()[:-1]:
        assert line.count(",") == 9


def time_of_checkpoint(directory: Path) -> float:
    """Of the one from which the run would go on."""
    try:
        restart = checkpoints.find_resumption(directory).restart
    except SkinError:
        return 0.0
    return 0.0 if restart is None else int(restart.split(".")[1][4:]) * 0.02


def cut(path: Path, share: float = 0.7) -> None:
    """Keep so much of a file."""
    os.truncate(path, int(path.stat().st_size * share))
