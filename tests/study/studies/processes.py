"""Processes that run studies, and are killed."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from lammps_skin.study.studies.runs import StudyRun

SKIN = [sys.executable, "-c", "from lammps_skin.cli import main; main()"]
TIMEOUT = 300.0  # seconds

Process = subprocess.Popen[str]


@contextmanager
def process(*command: str, **options: Any) -> Iterator[Process]:
    """A process, which is killed at the end if it still lives."""
    started = subprocess.Popen(
        command, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options
    )
    try:
        yield started
    finally:
        started.kill()
        started.communicate()


def wait_for(what: Callable[[], Any], client: Process) -> Any:
    """Wait until something is so; not longer than the client lives."""
    deadline = time.monotonic() + TIMEOUT
    while not (found := what()):
        assert time.monotonic() < deadline
        if client.poll() is not None:
            pytest.fail(f"the client has ended: {client.communicate()}")
        time.sleep(0.02)
    return found


class Cluster(NamedTuple):
    """A scheduler of dask, its address, and its workers by their process ids."""

    scheduler: Process
    address: str
    workers: dict[int, Process]


@contextmanager
def cluster(place: Path, workers: int) -> Iterator[Cluster]:
    """A scheduler and workers, each a process as users start it."""
    file = place / "scheduler.json"

    def dask(part: str, *options: str) -> Any:
        module = f"distributed.cli.dask_{part}"
        return process(
            sys.executable, "-m", module, "--no-dashboard", "--scheduler-file", str(file),
            *options, cwd=place,
        )  # fmt: skip

    with ExitStack() as stack:
        scheduler = stack.enter_context(dask("scheduler", "--host", "127.0.0.1", "--port", "0"))
        alone = ("--nthreads", "1", "--no-nanny", "--memory-limit", "0")
        started = [stack.enter_context(dask("worker", *alone)) for _ in range(workers)]
        address = json.loads(wait_for(lambda: file.exists() and file.read_text(), scheduler))
        yield Cluster(scheduler, address["address"], {one.pid: one for one in started})


def running(runs: Iterable[StudyRun]) -> list[int]:
    """Processes in the middle of a run."""
    last = [run.history[-1] for run in runs if not run.done and run.history]
    return [int(line["process"]) for line in last if line["event"] in ("begun", "resumed")]
