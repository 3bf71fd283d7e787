"""One process at a time has a run directory, also where files cannot be locked."""

from __future__ import annotations

import errno
import fcntl
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from lammps_skin.cli import main
from lammps_skin.errors import SceneError, SimulationError
from lammps_skin.run import directory_lock
from lammps_skin.run.directory_lock import DirectoryLock
from lammps_skin.start.build import build

from tests.run.disturbed import eventful, founders

HOLDER = """
import errno, fcntl, sys, time
from lammps_skin.run.directory_lock import DirectoryLock
def refuse(*_):
    raise OSError(int(sys.argv[2]), "no locks")
if int(sys.argv[2]):
    fcntl.flock = refuse
held = DirectoryLock(sys.argv[1])
print("held", flush=True)
time.sleep(100)
"""


@pytest.fixture(params=[0, errno.ENOLCK, errno.EOPNOTSUPP], ids=["flock", "ENOLCK", "EOPNOTSUPP"])
def reason(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> int:
    """Why there are no locks; 0 if there are."""
    monkeypatch.setattr(directory_lock, "PATIENCE", 0.1)
    if request.param:

        def refuse(*_: Any) -> None:
            raise OSError(request.param, os.strerror(request.param))

        monkeypatch.setattr(fcntl, "flock", refuse)
    return int(request.param)


def test_the_second_is_refused(reason: int, tmp_path: Path) -> None:
    with DirectoryLock(tmp_path):
        with pytest.raises(SimulationError, match=f"{tmp_path}: another process still runs in it"):
            DirectoryLock(tmp_path)
        DirectoryLock(tmp_path / "below", make=True).close()
    DirectoryLock(tmp_path).close()


def test_death_lets_go(reason: int, tmp_path: Path) -> None:
    command = [sys.executable, "-c", HOLDER, str(tmp_path), str(reason)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as other:
        assert other.stdout and other.stdout.readline() == b"held\n"
        with pytest.raises(SimulationError, match="another process still runs in it"):
            DirectoryLock(tmp_path)
        other.send_signal(signal.SIGKILL)
    DirectoryLock(tmp_path).close()


def test_a_fork_does_not_hold_on(reason: int, tmp_path: Path) -> None:
    """As the processes of a pool that outlives the simulation."""
    held = DirectoryLock(tmp_path)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(writing)
        os.read(reading, 1)
        os._exit(0)
    held.close()
    DirectoryLock(tmp_path).close()
    os.close(writing)
    os.waitpid(child, 0)


def test_directories_that_are_made_and_replaced(reason: int, tmp_path: Path) -> None:
    new = tmp_path / "a" / "b"
    with pytest.raises(SceneError, match=r"b: No such file or directory"):
        DirectoryLock(new)
    with DirectoryLock(new, make=True):
        assert new.is_dir()
    assert not new.parent.exists()  # nothing was put there
    with pytest.raises(SceneError, match="File name too long"):
        DirectoryLock(new / ("x" * 300), make=True)
    assert not new.parent.exists()
    new.parent.mkdir()
    with DirectoryLock(new, make=True):
        pass
    assert new.parent.is_dir() and not new.exists()  # was there before
    with DirectoryLock(new, make=True):
        (new.parent / "another").touch()
    assert [path.name for path in new.parent.iterdir()] == ["another"]
    with DirectoryLock(new, make=True):
        (new / "file").touch()
        new.rename(tmp_path / "elsewhere")
        DirectoryLock(new, make=True).close()  # is another directory
    (tmp_path / "file").touch()
    with pytest.raises(SceneError, match="file: "):
        DirectoryLock(tmp_path / "file", make=True)


@pytest.mark.parametrize(
    "command",
    [("run", "scene.toml", "-o"), ("run", "scene.toml", "--force", "-o"), ("run",),
     ("build", "scene.toml", "-o"), ("run", "--resume"), ("convert",)],
    ids=" ".join,
)  # fmt: skip
def test_a_command_is_refused_while_another_packs(
    command: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """From its first look on: nothing that it would find there has been written yet."""
    monkeypatch.setattr(directory_lock, "PATIENCE", 0.1)
    monkeypatch.chdir(tmp_path)
    build(eventful(), Path("run"), founders(eventful()))
    (tmp_path / "scene.toml").write_text((tmp_path / "run" / "scene.toml").read_text())
    before = {path.name: path.read_bytes() for path in Path("run").iterdir()}
    with DirectoryLock("run"), pytest.raises(SystemExit) as ended:
        main([*command, "run"])
    assert ended.value.code == 2
    assert capsys.readouterr().err == "error: directory run: another process still runs in it\n"
    assert {path.name: path.read_bytes() for path in Path("run").iterdir()} == before
