"""Who runs a study is killed in the middle of it, and it goes on afterwards."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Sequence
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest
from lammps_skin.study.runner import LIVES, _attempt, run_all
from lammps_skin.study.studies.runs import Branch, Study, StudyRun, Trunk
from lammps_skin.study.studies.tables import write_tables

from tests.conftest import Answer
from tests.study.studies.conftest import events
from tests.study.studies.processes import SKIN, TIMEOUT, cluster, process, running, wait_for

LONG = """
    [set]
    end_time = 10.0
    cells.generations = 1
    output.checkpoint_interval = 1.0
    [grid]
    membrane.noise = [0.01, 0.02, 0.03]
    """
FORKED = """
    [set]
    end_time = {end}
    cells.generations = 1
    output.checkpoint_interval = 0.5
    [conditions.none]
    [conditions.stiff]
    membrane.bending_stiffness = 2.0
    """


def test_killed_in_the_middle(
    study: Callable[..., Study],
    skin: Callable[..., Answer],
    tmp_path: Path,
    request: pytest.FixtureRequest,
) -> None:
    """Every finished run is kept, none is run twice, and the table is that of a study in peace."""
    ours = study(end=LONG)

    def done() -> list[Path]:
        return [run.table for run in ours.runs if run.done]

    with cluster(tmp_path, 2) as dask:
        command = [*SKIN, "study", "tiny.toml", "-o", "study", "--scheduler", dask.address]
        with process(*command, cwd=tmp_path) as client:
            first = wait_for(lambda: done() and running(ours.runs), client)[0]
            dask.workers.pop(first).send_signal(signal.SIGKILL)
            ((last, worker),) = dask.workers.items()
            wait_for(lambda: len(done()) >= 3 and last in running(ours.runs), client)
            dask.scheduler.send_signal(signal.SIGKILL)
            _, err = client.communicate(timeout=TIMEOUT)
        assert client.returncode == 2
        assert err.startswith(f"error: scheduler {dask.address}: has ended")
        assert err.count("\n") == 1
        worker.wait(TIMEOUT)  # it abandons its run, and ends

    kept = {table: table.stat().st_mtime_ns for table in done()}
    assert 3 <= len(kept) < 6
    request.getfixturevalue("in_this_process")  # who goes on does not matter
    answer = skin("study", "tiny.toml", "-o", "study", "--jobs", "1")
    assert answer.code == 0, answer
    assert f"6 runs, {len(kept)} of them done" in answer.out
    assert kept == {table: table.stat().st_mtime_ns for table in kept}
    attempts = attempts_at(ours.runs)
    assert len(attempts) == 6 + 2 and "resumed" in attempts  # those of the two kills go on

    compare(ours, study(end=LONG, folder="peace"))


def attempts_at(runs: Sequence[StudyRun]) -> list[str]:
    """Whether runs have begun or been resumed, each time; each is done once, in the end."""
    found = []
    for happened in events(runs):
        assert happened[0] == "begun" and happened.index("done") == len(happened) - 1
        found += happened[:-1]
    return found


def compare(ours: Study, theirs: Study) -> None:
    """The tables are those of a study that is run in peace, in another order."""
    for run in reversed(theirs.runs):
        assert _attempt(run, False) is None
    for mine, other in zip(write_tables(ours), write_tables(theirs), strict=True):
        assert mine.read_bytes() == other.read_bytes()


def trunks(study: Study) -> list[Trunk]:
    return list({run.trunk: None for run in study.runs if isinstance(run, Branch)})


def run_until_killed(run: StudyRun, time: float) -> None:
    """In a process of its own, which is killed at a time of the run."""

    def look(reached: float) -> None:
        if reached >= time:
            os.kill(os.getpid(), signal.SIGKILL)

    run.run(progress=look)


def test_a_fork_is_killed_before_and_after_its_time(study: Callable[..., Study]) -> None:
    """Both parts go on, and neither is run twice."""
    begin, end = 'seeds = "1"\nfork = 1.5', FORKED.format(end=3.0)
    ours = study(begin, end)
    first, second = ours.runs
    for time in (1.0, 2.5):
        killed = get_context("spawn").Process(target=run_until_killed, args=(first, time))
        killed.start()
        killed.join(TIMEOUT)
        assert killed.exitcode == -signal.SIGKILL
    for run in ours.todo():
        assert _attempt(run, False) is None
    assert events([*trunks(ours), first]) == [["begun", "resumed", "done"]] * 2
    assert events([second]) == [["begun", "done"]]
    compare(ours, study(begin, end, folder="peace"))


@pytest.mark.slow
def test_workers_of_a_fork_are_killed(study: Callable[..., Study], tmp_path: Path) -> None:
    """One in the common part of a seed, one later."""
    end = FORKED.format(end=20.0)
    ours = study("fork = 10.0", end)
    with cluster(tmp_path, 3) as dask:
        command = [*SKIN, "study", "tiny.toml", "-o", "study", "--scheduler", dask.address]
        with process(*command, cwd=tmp_path) as client:
            for runs in (trunks(ours), ours.runs):
                busy = wait_for(lambda runs=runs: running(runs), client)[0]
                dask.workers.pop(busy).send_signal(signal.SIGKILL)
            out, err = client.communicate(timeout=TIMEOUT)
        assert client.returncode == 0, (out, err)
    assert len(attempts_at([*trunks(ours), *ours.runs])) == 2 + 4 + 2
    compare(ours, study("fork = 10.0", end, folder="peace"))


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
