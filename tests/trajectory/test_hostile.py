"""Trajectories from strangers are refused in one line before anything of them is used."""

from __future__ import annotations

import os
import re
import shutil
import tracemalloc
from pathlib import Path

import h5py
import numpy as np
import pytest
from lammps_skin.cli import main
from lammps_skin.errors import DamagedError, SkinError
from lammps_skin.trajectory import check
from lammps_skin.trajectory.dump import Dump
from lammps_skin.trajectory.store import Store
from lammps_skin.trajectory.universe import open_trajectory

from tests.trajectory.conftest import FRAMES, equal
from tests.trajectory.hostile import BYTES, IN_DUMP, IN_HDF5, damage_dump, damage_hdf5

COMMANDS = {
    "stats": ["stats", "."],
    "vtk": ["export", ".", "--to", "vtk", "-o", "vtk"],
    "dump": ["export", ".", "--to", "dump", "-o", "other.dump"],
    "snapshot": ["snapshot", ".", "-o", "picture.png"],
    "convert": ["convert", "."],
}


@pytest.fixture
def said(capsys, monkeypatch, tmp_path):
    """The one line with which a command refuses, in the directory of the test."""
    monkeypatch.chdir(tmp_path)

    def call(words: list[str]) -> str:
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            main(words)
        told = capsys.readouterr().err.splitlines()
        assert end.value.code == 2, told
        assert len(told) == 1 and told[0].startswith("error: "), told
        return told[0]

    return call


def refused_hdf5(run, directory: Path, name: str, said, commands) -> None:
    shutil.copytree(run.driven, directory, dirs_exist_ok=True)
    expected = damage_hdf5(directory / "skin.h5", name)
    for command in commands:
        line = said(COMMANDS[command])
        assert "trajectory" in line and "skin.h5" in line, (command, line)
        assert re.search(expected, line), (command, line)


def refused_dump(run, directory: Path, name: str, said, commands) -> None:
    shutil.copytree(run.directory, directory, dirs_exist_ok=True)
    (directory / "skin.h5").unlink()
    expected = damage_dump(directory / "skin.dump", name)
    for command in commands:
        line = said(COMMANDS[command])
        assert "skin.dump: is not a dump of this scene" in line, (command, line)
        assert re.search(expected, line), (command, line)
    left = {path.name for path in directory.iterdir()}
    assert not {"skin.h5", "other.dump"} & left and not any(".part-" in name for name in left)


NAMES = [*IN_HDF5, *BYTES]


@pytest.mark.parametrize("name", NAMES)
def test_hostile_hdf5(run, tmp_path, said, name):
    """Commands take turns; MDAnalysis, and without large arrays, everywhere."""
    commands = [command for command in COMMANDS if command != "convert"]
    refused_hdf5(run, tmp_path, name, said, [commands[NAMES.index(name) % len(commands)]])
    tracemalloc.start()
    with pytest.raises(DamagedError):
        list(Store(tmp_path / "skin.h5"))
    with pytest.raises(DamagedError):
        for _ in open_trajectory(tmp_path).trajectory:
            pass
    assert tracemalloc.get_traced_memory()[1] < 30e6
    tracemalloc.stop()


@pytest.mark.parametrize("name", IN_DUMP)
def test_hostile_dumps(run, tmp_path, said, name):
    commands = list(COMMANDS)
    refused_dump(run, tmp_path, name, said, [commands[[*IN_DUMP].index(name) % len(commands)]])
    with pytest.raises(DamagedError):
        list(Dump(tmp_path / "skin.dump"))


@pytest.mark.slow
@pytest.mark.parametrize("name", [*NAMES, *IN_DUMP])
def test_hostile_files_in_every_command(run, tmp_path, said, name):
    if name in IN_DUMP:
        refused_dump(run, tmp_path, name, said, COMMANDS)
    else:
        refused_hdf5(run, tmp_path, name, said, [c for c in COMMANDS if c != "convert"])


# ---- what a moment's fault is not


WHY = {11: "another process has it open; try again when that has closed it$"}


def test_what_cannot_be_read_now_is_not_damaged(run, tmp_path, monkeypatch):
    path = tmp_path / "skin.h5"
    shutil.copy(run.driven / "skin.h5", path)
    faults = {
        13: PermissionError(13, "Permission denied"),
        5: OSError("Unable to synchronously open file (file read failed: errno = 5, error ...)"),
        37: OSError(37, "No locks available"),
        11: BlockingIOError(11, "Resource temporarily unavailable"),
    }
    for number, fault in faults.items():
        with monkeypatch.context() as patch:
            patch.setattr(check, "open_hdf5", lambda *_, fault=fault: (_ for _ in ()).throw(fault))
            with pytest.raises(SkinError, match=WHY.get(number, os.strerror(number))) as raised:
                Store(path)
        assert not isinstance(raised.value, DamagedError)
    assert equal(Store(path), run.frames)


def test_a_second_group_of_particles_is_ignored(run, tmp_path):
    """Whatever its name; ours is read."""
    path = tmp_path / "skin.h5"
    shutil.copy(run.driven / "skin.h5", path)
    with h5py.File(path, "r+") as file:
        for name in ("all", "zebra"):
            other = file.create_group(f"particles/{name}/position")
            other["value"] = np.zeros((3, 7, 3))
            file[f"particles/{name}/linked"] = h5py.ExternalLink("secret.h5", "/")
    universe = open_trajectory(path)
    assert len(universe.trajectory) == FRAMES
    assert equal(Store(path), run.frames)


def test_the_check_finds_nothing_in_good_files(run):
    for frames in (Store(run.driven / "skin.h5"), Dump(run.directory / "skin.dump")):
        assert equal(frames, run.frames)
