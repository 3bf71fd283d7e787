"""The results of a run are not lost to another one."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from lammps_skin.cli import application
from lammps_skin.errors import SkinError
from lammps_skin.run import directory_lock
from lammps_skin.run.simulation import Simulation
from typer.testing import CliRunner

NAMES = ("events.csv", "skin.h5", "checkpoints.json", "skin.step250.restart")


@pytest.fixture
def run(halfway: Path, tmp_path: Path) -> Iterator[Path]:
    """A run that has ended early, with an event after its last checkpoint; all is still there in
    the end.
    """
    directory = tmp_path / "run"
    shutil.copytree(halfway, directory)
    with (directory / "events.csv").open("a") as file:
        file.write("5.01,death,999,0,5,1,1,1,0,detached\n")
    before = {name: (directory / name).read_bytes() for name in NAMES}
    yield directory
    assert {name: (directory / name).read_bytes() for name in NAMES} == before


def test_a_simulation_does_not_replace_results(run: Path) -> None:
    with pytest.raises(SkinError, match=r"holds results of a run; Simulation\.resume goes on"):
        Simulation.begin_built(run)


def test_looking_at_a_run_changes_nothing(run: Path) -> None:
    with Simulation.resume(run) as simulation:
        assert simulation.energies()["bend"] > 0.0


def test_a_time_that_is_past_is_refused(run: Path) -> None:
    result = CliRunner().invoke(application("run"), ["run", str(run), "--resume", "--until", "3"])
    assert result.exit_code != 0


def test_a_new_run_that_cannot_begin_leaves_the_old_one(run: Path) -> None:
    (run / "cells.in").write_text("nonsense\n")
    result = CliRunner().invoke(application("run"), ["run", str(run), "--force"])
    assert result.exit_code != 0
    assert not (run / ".replaced").exists()


def test_a_running_simulation_is_left_alone(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(directory_lock, "PATIENCE", 0.2)
    with Simulation.resume(run):
        with pytest.raises(SkinError, match="another process still runs in it"):
            Simulation.begin_built(run, replace=True)
        result = CliRunner().invoke(application("run"), ["run", str(run), "--force"])
        assert result.exit_code != 0


def test_plain_lmp_leaves_a_running_simulation_alone(run: Path) -> None:
    with Simulation.resume(run):
        lmp = subprocess.run(
            [Path(sys.executable).parent / "lmp", "-in", "skin.in", "-log", "none"],
            cwd=run, capture_output=True, text=True,
        )  # fmt: skip
    assert lmp.returncode != 0
    assert "another simulation writes the event log ./events.csv" in lmp.stdout


# ---- what --force removes


def begin_anew(run: Path) -> None:
    """With --force, up to the end of the start."""
    result = CliRunner().invoke(application("run"), ["run", str(run), "--force", "--until", "0.02"])
    assert result.exit_code == 0, result.output


def test_force_follows_no_link(halfway: Path, tmp_path: Path) -> None:
    """Not that of an earlier version's folder, nor one in the place of a file of the run."""
    run, foreign = tmp_path / "run", tmp_path / "foreign"
    shutil.copytree(halfway, run)
    foreign.mkdir()
    for name in ("thesis.tex", "skin.h5", "log.lammps", "skin.1.restart"):
        (foreign / name).write_text("mine")
    (run / ".replaced").symlink_to(foreign)
    for name in ("skin.h5", "log.lammps", "skin.1.restart"):
        (run / name).unlink(missing_ok=True)
        (run / name).symlink_to(foreign / name)
    begin_anew(run)
    assert {path.name: path.read_text() for path in foreign.iterdir()} == dict.fromkeys(
        ("thesis.tex", "skin.h5", "log.lammps", "skin.1.restart"), "mine"
    )
    assert (run / ".replaced").is_symlink()
    assert not list(run.glob(".replaced-*"))


def test_force_removes_own_files_alone(halfway: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    shutil.copytree(halfway, run)
    kept = ("skin.h5.copy", "skin.h5.damaged", "skin.good.restart", "events.csv.old", "notes")
    for name in kept:
        (run / name).write_text("mine")
    (run / "skin.2.restart").mkdir()
    begin_anew(run)
    assert all((run / name).read_text() == "mine" for name in kept)
    assert (run / "skin.2.restart").is_dir()
    assert not (run / "skin.step250.restart").exists()
    Simulation.resume(run).close()  # nor is a foreign restart file taken for one of the run
    assert (run / "skin.good.restart").read_text() == "mine"
