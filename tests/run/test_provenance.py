"""Each run directory says where its results come from, as an RO-Crate that a validator accepts."""

from __future__ import annotations

import shutil
import subprocess
import sys
import venv
from datetime import datetime
from pathlib import Path

import pytest
from lammps_skin.errors import SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.run import provenance
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory.writer import source_commit
from lammps_skin.versions import versions

from tests.run.crates import activities, crate, links

SCENE = {
    "name": "small", "end_time": 1.0, "seed": 7, "dermis": {"present": False},
    "membrane": {"lattice": [12, 14]}, "cells": {"stem": 1, "seed": 8},
    "numerics": {"accuracy": "reference"}, "output": {"checkpoint_interval": 0.5},
}  # fmt: skip


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run to t = 1, resumed to t = 2: copy it."""
    directory = tmp_path_factory.mktemp("provenance")
    with Simulation.begin(Scene.from_dict(SCENE), directory) as simulation:
        simulation.run()
        simulation.run(1.0)
    with Simulation.resume(directory, variables={"timestep": "0.005"}) as simulation:
        simulation.run(2.0)
    return directory


def test_what_a_run_says(run: Path) -> None:
    found = crate(run)
    first, second = activities(found)
    for one in (first, second):
        assert one["actionStatus"] == "http://schema.org/CompletedActionStatus"
        assert datetime.fromisoformat(one["startTime"]) <= datetime.fromisoformat(one["endTime"])
        assert {"scene.toml", "skin.data"} <= {*links(one["object"])}
        assert {"skin.h5", "events.csv", "log.lammps"} <= {*links(one["result"])}
        assert one["name"].startswith(Path(sys.argv[0]).name)
    values = [
        {found[name]["name"]: found[name]["value"] for name in links(one["object"]) if "#" in name}
        for one in (first, second)
    ]
    assert values[0] == {
        "parameters": "earlier", "seed of the cells": 8, "seed of the dermis": 7
    }  # fmt: skip
    assert values[1]["variable timestep"] == "0.005"
    assert values[1]["variable restart"].endswith(".restart")
    told = {
        one["name"]: one["softwareVersion"]
        for one in found.values()
        if one["@type"] == "SoftwareApplication"
    }
    assert sorted(told.values()) == sorted(versions().values())
    (ours,) = (found[name] for name in links(first["instrument"]))
    assert ours["name"] == "lammps-skin"
    commit = source_commit()
    assert ours.get("identifier") == (f"commit {commit}" if commit else None)


def test_a_new_run_forgets_the_former(run: Path, tmp_path: Path) -> None:
    directory = tmp_path / "run"
    shutil.copytree(run, directory)
    scene = Scene.from_dict(SCENE | {"name": "other"})
    with Simulation.begin(scene, directory, replace=True) as simulation:
        simulation.run(0.1)
    found = crate(directory)
    assert len(activities(found)) == 1 and found["./"]["name"] == "other"


def test_a_run_that_was_killed_and_resumed(halfway: Path, tmp_path: Path) -> None:
    """Its first activity has no end; a file that says nothing of it is no obstacle."""
    directory = tmp_path / "run"
    shutil.copytree(halfway, directory)
    with Simulation.resume(directory) as simulation:
        simulation.run(simulation.time + 0.1)
    killed, resumed = activities(crate(directory))
    assert "endTime" not in killed and "endTime" in resumed
    for content in ("", "{}", '{"@graph": [3]}', '{"@graph": [{"@id": "x"}]}', "[" * 100_000):
        (directory / provenance.PROVENANCE).write_text(content)
        assert provenance._activities(directory / provenance.PROVENANCE) == []
        provenance.refresh(directory)


def test_a_run_that_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Simulation.begin(Scene.from_dict(SCENE), tmp_path) as simulation:

        def fail(*_: object) -> None:
            raise SkinError("it is unstable")

        monkeypatch.setattr(simulation._engine, "run_to", fail)
        with pytest.raises(SkinError, match="it is unstable"):
            simulation.run()
    (one,) = activities(crate(tmp_path))
    assert one["actionStatus"] == "http://schema.org/FailedActionStatus"
    assert one["error"] == "it is unstable"


def test_a_file_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / provenance.PROVENANCE).mkdir()
    message = f"provenance {tmp_path / provenance.PROVENANCE}: "
    refused = pytest.raises(SkinError, match=message)
    with Simulation.begin(Scene.from_dict(SCENE), tmp_path) as simulation, refused:
        simulation.run()


def test_files_that_are_gone_and_new(run: Path, tmp_path: Path) -> None:
    directory = tmp_path / "run"
    shutil.copytree(run, directory)
    for name in ("skin.h5", "skin.data", "log.lammps"):
        (directory / name).unlink()
    (directory / "observables.csv").touch()
    provenance.refresh(directory, ["observables.csv"])
    first, second = activities(crate(directory))
    assert links(first["result"]) == ["events.csv"]
    assert links(second["result"]) == ["events.csv", "observables.csv"]
    assert "scene.toml" in links(first["object"])
    provenance.refresh(tmp_path)
    assert not (tmp_path / provenance.PROVENANCE).exists()


@pytest.mark.slow
def test_a_validator_accepts_it(run: Path, tmp_path: Path) -> None:
    """With roc-validator in an environment of its own: it needs 50 MB, and another rich."""
    venv.create(tmp_path / "environment", with_pip=True)
    python = tmp_path / "environment" / "bin" / "python"
    packages = ["roc-validator>=0.13", "rocrate>=0.16"]
    subprocess.run([python, "-m", "pip", "install", "--quiet", *packages], check=True)
    judge = [python, Path(__file__).with_name("crate_validator.py")]
    accepted = subprocess.run([*judge, run], capture_output=True, text=True)
    assert accepted.returncode == 0, accepted.stderr
    wrong = tmp_path / "wrong"
    shutil.copytree(run, wrong)
    file = wrong / provenance.PROVENANCE
    file.write_text(file.read_text().replace('"license"', '"licence"'))
    refused = subprocess.run([*judge, wrong], capture_output=True, text=True)
    assert refused.returncode == 1 and "MUST have a `license`" in refused.stderr
