"""Kills, full disks and readers in the middle of a run: what is in skin.h5 is complete."""

from __future__ import annotations

import io
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from lammps_skin.errors import SkinError
from lammps_skin.trajectory import writer as writer_module
from lammps_skin.trajectory.recorder import Recorder
from lammps_skin.trajectory.store import Store
from lammps_skin.trajectory.universe import open_trajectory
from lammps_skin.trajectory.writer import TrajectoryWriter

from tests.trajectory.conftest import (
    Replay,
    equal,
    replay,
    same,
)

SKIN = [sys.executable, "-c", "from lammps_skin.cli import main; main()"]


def moments_of_writing(monkeypatch: pytest.MonkeyPatch, tick) -> None:
    """Call `tick` before and after everything that changes a file, in HDF5 each single write."""

    def around(function):
        def wrapped(*arguments, **more):
            tick()
            result = function(*arguments, **more)
            tick()
            return result

        return wrapped

    class Watched(io.FileIO):
        write = around(io.FileIO.write)

    opened = h5py.File
    modes = {"w": "w+b", "r+": "r+b"}
    watched = lambda path, mode: opened(Watched(path, modes[mode]), mode)  # noqa: E731
    monkeypatch.setattr(
        writer_module, "h5py", SimpleNamespace(File=watched, string_dtype=h5py.string_dtype)
    )
    for module, name in ((os, "link"), (shutil, "copyfile"), (Path, "replace")):
        monkeypatch.setattr(module, name, around(getattr(module, name)))


def test_killed_at_any_moment_the_file_is_complete(run, built, monkeypatch):
    """A process of its own is killed in the middle of what it writes, everywhere."""
    ticks = 0

    def count() -> None:
        nonlocal ticks
        ticks += 1

    with monkeypatch.context() as patch:
        moments_of_writing(patch, count)
        frames = replay(run, Recorder(built, run.scene, {}))
        per_frame = [ticks for _ in zip(range(5), frames, strict=False)]
    assert per_frame[-1] > 200
    for last in np.linspace(per_frame[0] + 1, per_frame[-1], 12).astype(int).tolist():
        written = killed_after(last, run, built, monkeypatch)
        assert written == sum(n < last for n in per_frame)
        store = Store(built / "skin.h5")
        assert len(store) in (written, written + 1)
        assert all(map(same, store, run.frames))


def killed_after(last: int, run, built: Path, monkeypatch) -> int:
    """Record in a child that kills itself at a tick; number of frames that it had finished."""
    receiving, sending = os.pipe()
    child = os.fork()
    if child == 0:
        ticks = 0

        def kill() -> None:
            nonlocal ticks
            ticks += 1
            if ticks == last:
                os.kill(os.getpid(), signal.SIGKILL)

        moments_of_writing(monkeypatch, kill)
        for _ in replay(run, Recorder(built, run.scene, {})):
            os.write(sending, b".")
        os._exit(0)
    os.close(sending)
    with os.fdopen(receiving, "rb") as pipe:
        written = len(pipe.read())
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL
    return written


def test_a_killed_command_leaves_its_frames(tmp_path):
    settings = (
        "membrane.lattice=[12,14]",
        "output.dump_interval=0.01",
        "numerics.accuracy=reference",
    )
    changes = [word for setting in settings for word in ("--set", setting)]
    command = [*SKIN, "run", "two-cells", *changes, "--until", "10000", "-o", str(tmp_path / "x")]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    path, deadline = tmp_path / "x" / "skin.h5", time.monotonic() + 60
    while not (path.exists() and len(Store(path)) > 5) and time.monotonic() < deadline:
        time.sleep(0.02)
    process.kill()
    process.wait()
    store = Store(path)
    assert store.steps.tolist() == list(range(len(store))) and len(store) > 5
    assert len(open_trajectory(path).trajectory) == len(store)
    assert all(np.isfinite(frame.positions).all() and len(frame.ids) == 170 for frame in store)


def test_a_failure_to_write_loses_nothing(run, built, monkeypatch):
    """And the next frame is written as if nothing had been."""
    recorder = Recorder(built, run.scene, {})
    engine = Replay(zip(run.particles, run.cells, run.next_ids, strict=True))
    for n in range(6):
        with monkeypatch.context() as patch:
            if n in (2, 4):
                full = OSError(28, "No space left on device")
                patch.setattr(
                    TrajectoryWriter, "_append", lambda *_, e=full: (_ for _ in ()).throw(e)
                )
                with pytest.raises(SkinError, match=r"skin\.h5: No space left on device"):
                    recorder.record(engine)
                assert len(Store(built / "skin.h5")) == n
        recorder.record(engine)
        engine.advance()
    assert all(map(same, Store(built / "skin.h5"), run.frames))
    assert len(Store(built / "skin.h5")) == 6


def test_who_reads_during_a_run_is_not_disturbed(run, built):
    """What was open stays as it was; what is opened now has all frames."""
    opened = {}
    for n in replay(run, Recorder(built, run.scene, {})):
        if n in (1, 2, 7):
            opened[n] = open_trajectory(built)
        assert len(Store(built / "skin.h5")) == n
    assert equal(Store(built / "skin.h5"), run.frames)
    for n, universe in opened.items():
        assert len(universe.trajectory) == n
        for ts, frame in zip(universe.trajectory, run.frames, strict=False):
            np.testing.assert_array_equal(ts.data["position"][frame.ids - 1], frame.positions)
