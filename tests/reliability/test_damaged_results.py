"""The files that a run has left, damaged at random: read, or refused in one line."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from lammps_skin.cli import main
from lammps_skin.run.simulation import Simulation

from tests.trajectory.conftest import small_scene

COMMANDS = (["stats", "run"], ["export", "run", "--to", "vtk", "-o", "out"])
CASES = 4  # in the quick tests
MANY = 15


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short run with a few births, and three frames."""
    directory = tmp_path_factory.mktemp("finished")
    scene = small_scene().replace(**{"end_time": 4.0, "output.dump_interval": 2.0})
    with Simulation.begin(scene, directory) as simulation:
        simulation.run()
    return directory


def damage(path: Path, draw: np.random.Generator) -> None:
    """A bit, a byte, the end or a piece of a file."""
    content = bytearray(path.read_bytes())
    place = int(draw.integers(len(content)))
    match draw.integers(4):
        case 0:
            content[place] ^= 1 << int(draw.integers(8))
        case 1:
            content[place] = int(draw.choice(list(b"0159-.x,\n")))
        case 2:
            del content[place:]
        case 3:
            del content[place : place + int(draw.integers(1, 40))]
    path.write_bytes(content)


@pytest.mark.parametrize("number", [CASES, pytest.param(MANY, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ["skin.h5", "events.csv", "log.lammps", "skin.data", "scene.toml"])
def test_damaged_results(
    name: str, number: int, finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    draw = np.random.default_rng(len(name))
    for _ in range(number):
        shutil.copytree(finished, "run", dirs_exist_ok=True)
        damage(Path("run", name), draw)
        for command in COMMANDS:
            with pytest.raises(SystemExit) as ended:
                main(command)
            err = capsys.readouterr().err
            assert (ended.value.code, err.count("\n")) in ((0, 0), (2, 1)), err


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(new.join(text.rsplit(old, 1)))


def renumber_a_triangle(run: Path) -> None:
    with h5py.File(run / "skin.h5", "r+") as file:
        file["connectivity/triangles"][0, 0] = 10**6


def make_a_mother_unknown(run: Path) -> None:
    lines = (run / "events.csv").read_text().splitlines()
    birth = next(n for n, line in enumerate(lines) if ",birth," in line)
    words = lines[birth].split(",")
    lines[birth] = ",".join([*words[:3], "1", *words[4:]])
    (run / "events.csv").write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize(
    ("damaged", "told"),
    [
        (renumber_a_triangle, "its triangles are not those of its membrane"),
        (make_a_mother_unknown, "does not go with the trajectory: "),
        (lambda run: (run / "events.csv").write_text("x"), "is not the events.csv of a run"),
        (lambda run: change(run / "log.lammps", "c_bend", "c_bent"), "other columns later on"),
    ],
    ids=["triangle", "mother", "log", "heading"],
)
def test_what_is_wrong_is_told(
    damaged: Callable[[Path], object], told: str, finished: Path, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    shutil.copytree(finished, "run")
    damaged(Path("run"))
    with pytest.raises(SystemExit) as ended:
        main(["stats", "run"])
    assert ended.value.code == 2
    assert told in capsys.readouterr().err
