"""The script for Slurm: what it says, and its tasks one by one, as Slurm would start them."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import pytest
from lammps_skin.study.studies.runs import Study

from tests.conftest import Answer
from tests.study.studies.conftest import events
from tests.study.studies.processes import TIMEOUT, Process, process, running, wait_for
from tests.study.studies.test_killed import attempts_at, compare

LONG = """
    [set]
    end_time = 20.0
    cells.generations = 1
    output.checkpoint_interval = 1.0
    [grid]
    membrane.noise = [0.01, 0.02]
    """


def test_what_the_script_says(
    study: Callable[..., Study], skin: Callable[..., Answer], tmp_path: Path
) -> None:
    """Words with blanks stay words, for the shell and for Slurm; there are no idle tasks."""
    study(end=LONG)
    (tmp_path / "my tiny.toml").write_text((tmp_path / "tiny.toml").read_text())
    answer = skin("study", "slurm", "my tiny.toml", "--tasks", "9", "--cpus", "2")
    assert answer.code == 0 and answer.out.startswith("my tiny.sh: 4 tasks, about ")
    assert "start it with sbatch 'my tiny.sh'" in " ".join(answer.out.split())
    assert subprocess.run(["sh", "-n", "my tiny.sh"], cwd=tmp_path).returncode == 0
    first, *lines = (tmp_path / "my tiny.sh").read_text().splitlines()
    assert first == "#!/bin/sh"
    assert [shlex.split(line)[1:] for line in lines if line.startswith("#SBATCH ")] == [
        ["--job-name=my tiny"], ["--array=1-4"], ["--ntasks=1"], ["--cpus-per-task=2"],
        ["--output=my tiny-%a.log"],
    ]  # fmt: skip
    run, program, *words = shlex.split(lines[-1])
    assert run == "exec" and os.access(program, os.X_OK)
    assert words == [
        "study", "run", str(tmp_path / "my tiny.toml"), "-o", str(tmp_path / "studies/my tiny"),
        "--share", "$SLURM_ARRAY_TASK_ID/4",
    ]  # fmt: skip


@pytest.mark.slow
def test_an_array_of_tasks(
    study: Callable[..., Study], skin: Callable[..., Answer], tmp_path: Path
) -> None:
    """At the same time, one of them killed and repeated; what is left to do is to gather."""
    ours = study(end=LONG)
    assert skin("study", "slurm", "tiny.toml", "-o", "study", "--tasks", "2").code == 0

    def task(number: int) -> AbstractContextManager[Process]:
        environment = os.environ | {"SLURM_ARRAY_TASK_ID": str(number)}
        return process("sh", "tiny.sh", cwd=tmp_path, env=environment, start_new_session=True)

    with task(1) as one, task(2) as two:
        wait_for(lambda: running(ours.runs[::2]), one)
        os.killpg(one.pid, signal.SIGKILL)
        out, err = two.communicate(timeout=TIMEOUT)
        assert two.returncode == 0, (out, err)
    assert all(run.done for run in ours.runs[1::2]) and not ours.runs[0].done
    with task(1) as again:
        out, err = again.communicate(timeout=TIMEOUT)
        assert again.returncode == 0 and "share 1/2: 2 runs to do" in out, (out, err)
    happened = events(ours.runs)
    assert len(attempts_at(ours.runs)) == 4 + 1
    answer = skin("study", "run", "tiny.toml", "-o", "study")
    assert answer.code == 0 and "4 runs, 4 of them done" in answer.out
    assert events(ours.runs) == happened
    compare(ours, study(end=LONG, folder="peace"))
