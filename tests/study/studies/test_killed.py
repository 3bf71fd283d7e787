"""A worker and the scheduler are killed in the middle of a study, which goes on afterwards."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from lammps_skin.study.runner import LIVES, _attempt, run_all
from lammps_skin.study.studies.runs import Study, StudyRun
from lammps_skin.study.studies.tables import write_tables

from tests.conftest import Answer

SKIN = [sys.executable, "-c", "from lammps_skin.cli import main; main()"]
LONG = """
    [set]
    end_time = 20.0
    cells.generations = 1
    output.checkpoint_interval = 1.0
    [grid]
    membrane.noise = [0.01, 0.02, 0.03]
    """
TIMEOUT = 300.0  # seconds


@contextmanager
def process(*command: str, **options: Any) -> Iterator[subprocess.Popen[str]]:
    """A process, which is killed at the end if it still lives."""
    started = subprocess.Popen(
        command, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options
    )
    try:
        yield started
    finally:
        started.kill()
        started.communicate()


def dask(part: str, file: Path) -> list[str]:
    """A scheduler or a worker, as users start it."""
    of_part = {
        "scheduler": ["--host", "127.0.0.1", "--port", "0"],
        "worker": ["--nthreads", "1", "--no-nanny", "--memory-limit", "0"],
    }
    module = f"distributed.cli.dask_{part}"
    return [sys.executable, "-m", module, "--no-dashboard", "--scheduler-file", str(file),
            *of_part[part]]  # fmt: skip


def wait_for(what: Callable[[], Any], client: subprocess.Popen[str]) -> Any:
    """Wait until something is so; not longer than the client lives."""
    deadline = time.monotonic() + TIMEOUT
    while not (found := what()):
        assert time.monotonic() < deadline
        if client.poll() is not None:
            pytest.fail(f"the client has ended: {client.communicate()}")
        time.sleep(0.02)
    return found


def running(study: Study) -> set[int]:
    """Processes in the middle of a run."""
    last = [run.history[-1] for run in study.runs if not run.done and run.history]
    return {int(line["process"]) for line in last if line["event"] in ("begun", "resumed")}


def events(study: Study) -> list[list[str]]:
    return [[line["event"] for line in run.history] for run in study.runs]


def test_killed_in_the_middle(
    study: Callable[..., Study], skin: Callable[..., Answer], tmp_path: Path
) -> None:
    """Every finished run is kept, none is run twice, and the table is that of a study in peace."""
    ours = study(end=LONG)
    file = tmp_path / "scheduler.json"

    def done() -> list[Path]:
        return [run.table for run in ours.runs if run.done]

    with (
        process(*dask("scheduler", file)) as scheduler,
        process(*dask("worker", file), cwd=tmp_path) as one,
        process(*dask("worker", file), cwd=tmp_path) as other,
    ):
        address = wait_for(lambda: file.exists() and file.read_text(), scheduler)
        command = [*SKIN, "study", "tiny.toml", "-o", "study",
                   "--scheduler", json.loads(address)["address"]]  # fmt: skip
        with process(*command, cwd=tmp_path) as client:
            wait_for(lambda: done() and one.pid in running(ours), client)
            os.kill(one.pid, signal.SIGKILL)
            wait_for(lambda: len(done()) >= 3 and other.pid in running(ours), client)
            os.kill(scheduler.pid, signal.SIGKILL)
            _, err = client.communicate(timeout=TIMEOUT)
        assert client.returncode == 2
        assert err.startswith(f"error: scheduler {command[-1]}: has ended") and err.count("\n") == 1
        other.wait(TIMEOUT)  # it abandons its run, and ends

    kept = {table: table.stat().st_mtime_ns for table in done()}
    assert 3 <= len(kept) < 6
    answer = skin("study", "tiny.toml", "-o", "study", "--jobs", "1")
    assert answer.code == 0, answer
    assert f"6 runs, {len(kept)} of them done" in answer.out
    assert kept == {table: table.stat().st_mtime_ns for table in kept}
    for happened in events(ours):
        assert happened[0] == "begun" and happened.index("done") == len(happened) - 1
    attempts = [event for happened in events(ours) for event in happened if event != "done"]
    assert len(attempts) == 6 + 2 and "resumed" in attempts  # those of the two kills go on

    theirs = study(end=LONG, folder="peace")
    for run in reversed(theirs.runs):
        assert _attempt(run, False) is None
    for mine, other_table in zip(write_tables(ours), write_tables(theirs), strict=True):
        assert mine.read_bytes() == other_table.read_bytes()


class Deadly(StudyRun):
    """A run that kills its process."""

    def run(self, *_: Any) -> None:
        self.note("begun")
        os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.slow
def test_a_run_that_kills_its_workers(study: Callable[..., Study]) -> None:
    """After some deaths it has failed, and the others are done."""
    first, *others = study(end="[grid]\ncells.generations = [2, 3]").runs
    deadly = Deadly(first.scene, first.folder)
    failures = run_all([deadly, *others], jobs=2)
    assert failures == {deadly: f"{LIVES} processes that ran it were killed"}
    assert [line["event"] for line in deadly.history] == ["begun"] * LIVES + ["failed"]
    assert all(run.done for run in others)


@pytest.mark.slow
def test_many_runs_need_no_more_memory(study: Callable[..., Study]) -> None:
    """200 runs on two workers: what the client has after 50 is enough for all."""
    found = study('windows = "0-0.5"', "[set]\nend_time = 0.5\n[grid]\nmembrane.noise = "
                  f"{[n / 1000 for n in range(1, 101)]}")  # fmt: skip
    assert len(found.runs) == 200
    memory = []

    def look(*_: object) -> None:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        memory.append(pages * os.sysconf("SC_PAGE_SIZE"))

    assert run_all(found.runs, jobs=2, progress=look) == {}
    assert len(memory) >= 200 and memory[-1] - memory[len(memory) // 4] < 5e6
    assert all(run.done for run in found.runs)
