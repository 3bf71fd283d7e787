"""Whatever ends a run, it goes on from its last checkpoint as if nothing had happened."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.errors import SkinError
from lammps_skin.run import directory_lock
from lammps_skin.run.checkpoints import find_resumption
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory.store import Store

from tests.run.disturbed import (
    CHECKPOINT,
    END,
    PATIENCE,
    PIECE,
    Outcome,
    Runner,
    assert_close,
    assert_same,
    assert_whole,
    finish,
    kill_at,
    outcome,
    time_of_checkpoint,
)

SKIN = [sys.executable, "-c", "from lammps_skin.cli import main; main()"]


def assert_little_is_lost(directory: Path, reached: float) -> None:
    assert_whole(directory)
    assert time_of_checkpoint(directory) > reached - CHECKPOINT - PIECE / 2


# ---- SIGKILL


def kill_at_random(directory: Path, rng: np.random.Generator) -> None:
    """Once, some time after the start of a run or of its continuation."""
    with Runner(directory) as runner:
        runner.wait_for(0)
        time.sleep(rng.uniform(0, 1))
        runner.process.kill()
    assert_little_is_lost(directory, runner.reached)


def test_killed_again_and_again(built: Path, undisturbed: Outcome) -> None:
    rng = np.random.default_rng(1)
    for _ in range(3):
        kill_at_random(built, rng)
    assert_same(finish(built), undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_killed_at_thirty_moments(seed: int, built: Path, undisturbed: Outcome) -> None:
    """Five in each of six runs."""
    rng = np.random.default_rng([2, seed])
    for _ in range(5):
        kill_at_random(built, rng)
    assert_same(finish(built), undisturbed)


def test_killed_between_changes_of_files(built: Path, undisturbed: Outcome) -> None:
    """While frames are written, checkpoints are synced and renamed, the list is replaced."""
    for tick in (5, 61, 88, 97, 133, 134, 135, 138, 141, 144):
        with Runner(built, kill_at, tick) as runner:
            assert runner.end() == -signal.SIGKILL
        if runner.reached > 0:
            assert_little_is_lost(built, runner.reached)
    assert_same(finish(built), undisturbed)


def kill_when_there_is(directory: Path, pattern: str) -> None:
    """In a process: kill it as soon as a file is there, before it has its name."""
    rename = Path.replace

    def wait_for_the_end(path: Path, target: Path) -> Path:
        while path.match(pattern):
            time.sleep(PATIENCE)
        return rename(path, target)

    Path.replace = wait_for_the_end  # type: ignore[method-assign]

    def watch() -> None:
        while not any(directory.glob(pattern)):
            pass
        os.kill(os.getpid(), signal.SIGKILL)

    threading.Thread(target=watch, daemon=True).start()


def test_killed_while_lammps_writes(built: Path, undisturbed: Outcome) -> None:
    with Runner(built, kill_when_there_is, built, "skin.step150.restart.part") as runner:
        assert runner.end() == -signal.SIGKILL
    assert not (built / "skin.step150.restart").exists()
    assert_little_is_lost(built, runner.reached)
    assert_same(finish(built), undisturbed)
    assert not list(built.glob("*.part"))


# ---- signals that can be heeded


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 1)])
def test_a_signal_ends_with_a_checkpoint(
    number: int, code: int, built: Path, undisturbed: Outcome
) -> None:
    """Nothing is lost; a checkpoint that the undisturbed run has not costs rounding."""
    with Runner(built) as runner:
        runner.wait_for(2.3)
        os.kill(runner.process.pid, number)
        assert runner.end() == code
    assert time_of_checkpoint(built) >= runner.reached
    assert_close(finish(built), undisturbed)


def test_the_command_is_terminated_and_resumed(built: Path, undisturbed: Outcome) -> None:
    process = subprocess.Popen([*SKIN, "run", str(built)], stdout=subprocess.PIPE, text=True)
    deadline = time.monotonic() + PATIENCE
    while not list(built.glob("skin.step*.restart")) and time.monotonic() < deadline:
        time.sleep(0.01)
    process.terminate()
    out, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 143
    assert "test: terminated at t = " in out and f"go on: skin run {built} --resume" in out
    resumed = subprocess.run([*SKIN, "run", str(built), "--resume"], capture_output=True, text=True)
    assert resumed.returncode == 0, resumed.stderr
    assert "test: goes on at t = " in resumed.stdout and "test: reached t = 8," in resumed.stdout
    log = (built / "log.lammps").read_text()
    assert log.count("Total wall time") == 2
    with Simulation.begin_built(
        built, variables={"restart": find_resumption(built).restart}
    ) as ended:
        assert ended.time == pytest.approx(END)
        assert_close(outcome(built, ended), undisturbed)
    again = subprocess.run([*SKIN, "run", str(built), "--resume"], capture_output=True, text=True)
    assert again.returncode == 2
    assert again.stderr == (
        f"error: directory {built}: has reached t = 8; --until takes it further\n"
    )


def test_a_run_is_resumed_with_another_timestep(halfway: Path, tmp_path: Path) -> None:
    """As the error of a run that was unstable says; frames keep to multiples of their interval."""
    directory = tmp_path / "run"
    shutil.copytree(halfway, directory)
    command = [*SKIN, "run", str(directory), "--resume", "--timestep", "0.01"]
    resumed = subprocess.run(command, capture_output=True, text=True)
    assert resumed.returncode == 0, resumed.stderr
    assert "test: reached t = 8," in resumed.stdout
    with Simulation.resume(directory) as ended:
        assert (ended.timestep, ended.time) == (0.01, pytest.approx(END))
        interval = ended.scene.output.dump_interval
    store = Store(directory / "skin.h5")
    times = [frame.time for frame in store]
    np.testing.assert_allclose(times, np.arange(len(times)) * interval, atol=1e-6)
    assert END - interval < times[-1] <= END


# ---- other deaths


def descendants(pid: int) -> list[int]:
    """Processes below a process, the lowest last."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [p for child in map(int, children) for p in (child, *descendants(child))]


def test_one_rank_of_two_is_killed(built: Path, undisturbed: Outcome) -> None:
    def kill(time: float, driven: Simulation) -> None:
        if time > 1.2:
            os.kill(descendants(driven._engine._process.pid)[-1], signal.SIGKILL)

    named = pytest.raises(SkinError, match=r"last checkpoint: .*skin\.step50\.restart\)")
    with named, Simulation.begin_built(built, ranks=2) as driven:
        driven.run(progress=kill, every=PIECE)
    assert_little_is_lost(built, 1.3)
    assert_close(finish(built), undisturbed)


def test_ranks_may_outlive_a_killed_run(built: Path, undisturbed: Outcome) -> None:
    """They still change its files, for some steps: the resumed run waits."""
    with Runner(built, None, ranks=2) as runner:
        runner.wait_for(1.1)
        runner.process.kill()
        runner.process.join()
        ended = finish(built)
    assert_close(ended, undisturbed)


def test_a_run_that_died_at_once_begins_again(built: Path, undisturbed: Outcome) -> None:
    """Before its first step it has made a log, and an event log without events."""
    Simulation.begin_built(built).close()
    assert (built / "events.csv").read_text().count("\n") == 1
    assert_same(finish(built), undisturbed)


def test_a_run_that_goes_on_is_left_alone(
    halfway: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    directory = tmp_path / "run"
    shutil.copytree(halfway, directory)
    monkeypatch.setattr(directory_lock, "PATIENCE", 0.1)
    with Simulation.resume(directory):
        before = {path.name: path.read_bytes() for path in directory.iterdir()}
        with pytest.raises(SkinError, match=f"{directory}: another process still runs in it"):
            Simulation.resume(directory)
        assert before == {path.name: path.read_bytes() for path in directory.iterdir()}
    Simulation.resume(directory).close()


def limit_files(kilobytes: int) -> None:
    """In a process, once MPI has begun: no file can become larger, as if the disk were full."""
    run, limit = Simulation.run, kilobytes * 1024

    def limited(*arguments: Any, **more: Any) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        run(*arguments, **more)

    Simulation.run = limited  # type: ignore[method-assign]


@pytest.mark.parametrize("kilobytes", [2, 60, 100, 140, 200])
def test_the_disk_is_full(
    kilobytes: int, halfway: Path, undisturbed: Outcome, tmp_path: Path
) -> None:
    """The event log, a restart file, or the trajectory cannot grow."""
    directory = tmp_path / "run"
    shutil.copytree(halfway, directory)
    before = time_of_checkpoint(directory)
    with Runner(directory, limit_files, kilobytes) as runner:
        assert runner.end() == 1
    assert time_of_checkpoint(directory) >= before
    assert_little_is_lost(directory, runner.reached)
    assert_same(finish(directory), undisturbed)
