"""What all tests need of the process that they run in, and the command as its user meets it."""

import os
import signal
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pytest

# a shell starts what it runs in the background with interrupts ignored, and so would our processes
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# ranks that wait sleep instead of spinning: tests on two ranks share the cores with other tests
os.environ.setdefault("MPIR_CVAR_CH4_PROGRESS_THROTTLE", "1")


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
    """Runs of ensembles and studies without workers, which take longer to start than a short run.

    For tests that are about something else; those of workers are in `tests/study`.
    """
    from lammps_skin.study import runner

    def run_all(
        todo: Sequence[Any], _jobs: int = 1, keep: bool = False, progress: Any = None, *_: Any
    ) -> dict[Any, str]:
        failures = {}
        for member in todo:
            if error := runner._attempt(member, keep):
                failures[member] = error
            elif progress:
                progress(member, member.scene.end_time)
        return failures

    monkeypatch.setattr(runner, "run_all", run_all)
