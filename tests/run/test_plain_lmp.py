"""Runs of plain lmp that were killed or damaged are resumed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

from lammps_skin.run.checkpoints import find_resumption
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import build

from tests.run.disturbed import (
    END,
    PATIENCE,
    Outcome,
    assert_same,
    cut,
    eventful,
    finish,
    founders,
    outcome,
)


def plain_lmp(directory: Path) -> subprocess.Popen[bytes]:
    lmp = [Path(sys.executable).parent / "lmp", "-in", "skin.in", "-var", "dump_interval", "0.3"]
    return subprocess.Popen(
        lmp, cwd=directory, stdout=subprocess.DEVNULL, start_new_session=True
    )  # fmt: skip


def kill_plain_lmp(directory: Path) -> None:
    """Kill it while its files are written in turns; the command starts a program of its own."""
    process = plain_lmp(directory)
    while not (directory / "skin.2.restart").exists() and process.poll() is None:
        time.sleep(0.001)
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait(PATIENCE)


def test_a_killed_run_of_plain_lmp_is_resumed(tmp_path: Path, undisturbed: Outcome) -> None:
    scene = eventful()
    for attempt in range(20):  # a run can be at its end before the kill: it takes 0.05 s
        directory = tmp_path / str(attempt)
        build(scene, directory, founders(scene))
        kill_plain_lmp(directory)
        with Simulation.resume(directory) as resumed:
            if resumed.time < END:
                resumed.run()
                assert_same(outcome(directory, resumed), undisturbed)
                return
    raise AssertionError("all runs had come to their end")


def test_a_damaged_run_of_plain_lmp_is_resumed(built: Path, undisturbed: Outcome) -> None:
    """The newer of its two files is cut off."""
    assert plain_lmp(built).wait(PATIENCE) == 0
    newer, older = sorted(
        built.glob("skin.[12].restart"), key=lambda path: path.stat().st_mtime, reverse=True
    )
    cut(newer)
    found = find_resumption(built)
    assert found.restart == older.name
    assert found.notes == [f"checkpoint {newer}: is damaged"]
    assert_same(finish(built), undisturbed)
