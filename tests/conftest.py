"""What all tests need of the process that they run in, and the command as its user meets it."""

import os
import pickle
import signal
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import pytest

# a shell starts what it runs in the background with interrupts ignored, and so would our processes
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# ranks that wait soon sleep instead of spinning: those of tests share the cores with other tests
os.environ.setdefault("MPIR_CVAR_CH4_PROGRESS_THROTTLE", "1")
os.environ.setdefault("MPIR_CVAR_CH4_PROGRESS_THROTTLE_NO_PROGRESS_COUNT", "256")  # not 4096


def pytest_xdist_auto_num_workers() -> int | None:
    """One process more than there are cores: tests that wait for files or processes use none."""
    from lammps_skin.engine.machine import cores

    return None if "PYTEST_XDIST_AUTO_NUM_WORKERS" in os.environ else cores() + 1


LONGEST = ("tests/test_readme.py", "tests/test_tutorial.py", "tests/study/studies/test_killed.py")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest tests begin first: at the end, one process would wait for another's."""
    items.sort(key=lambda item: not item.nodeid.startswith(LONGEST))


class Answer(NamedTuple):
    """What a command has left."""

    code: int
    out: str
    err: str


@pytest.fixture
def skin(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[..., Answer]:
    """Call ``skin`` with arguments, in an empty directory."""
    from lammps_skin.cli import main

    monkeypatch.chdir(tmp_path)

    def call(*arguments: object) -> Answer:
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            main([str(argument) for argument in arguments])
        return Answer(end.value.code, *capsys.readouterr())

    return call


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Many runs without processes of their own, which take longer to start than short runs take.

    Jobs are copies, like those that other processes get.
    """
    from lammps_skin.study import runner

    def run_share(
        todo: Sequence[runner.Job],
        keep: bool = False,
        progress: Callable[[runner.Job, float], None] | None = None,
    ) -> dict[runner.Job, str]:
        failures = {}
        for job in todo:
            tell = partial(progress, job) if progress else None
            error = runner._attempt(pickle.loads(pickle.dumps(job)), keep, tell)
            if error:
                failures[job] = error
        return failures

    monkeypatch.setattr(runner, "find_spec", lambda name: None)  # no dask
    monkeypatch.setattr(runner, "run_share", run_share)
