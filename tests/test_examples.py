"""The examples in docs/examples run, and what they print is so."""

from __future__ import annotations

import re
import runpy
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from lammps_skin import Scene, Simulation, open_trajectory
from pages import ROOT, codes, text

EXAMPLES = ROOT / "docs" / "examples"
Say = Callable[..., list[str]]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run in which TA cells divide."""
    directory = tmp_path_factory.mktemp("run")
    scene = Scene.load("two-cells").replace(end_time=120.0)
    with Simulation.begin(scene, directory) as simulation:
        simulation.run()
    return directory


@pytest.fixture
def say(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Say:
    """Lines that an example prints with arguments."""

    def call(name: str, *arguments: object) -> list[str]:
        monkeypatch.setattr(sys, "argv", [name, *map(str, arguments)])
        runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        return capsys.readouterr().out.splitlines()

    return call


def test_the_page_shows_every_example() -> None:
    shown = re.findall(r"literalinclude\} examples/(\w+\.py)", text("python.md"))
    assert sorted(shown) == sorted(path.name for path in EXAMPLES.glob("*.py"))
    assert "docs/examples" in codes(text("python.md"))


def test_neighbors(say: Say, run: Path) -> None:
    """Two stem cells begin side by side, as many diameters apart as `cluster` says: one."""
    lines = say("neighbors.py", run)
    frames = [[float(word) for word in line.split()] for line in lines[1:14]]
    assert [time for time, *_ in frames] == [10.0 * n for n in range(13)]
    assert max(neighbors for _, neighbors, _ in frames) > 1
    assert all(share <= 1 for *_, share in frames)
    assert lines[15].startswith("distance") and len(lines) == 26


def test_lineage(say: Say, run: Path) -> None:
    """Clones together have all cells that are there at the end."""
    lines = say("lineage.py", run)
    clones = lines[lines.index("") + 2 :]
    assert len(clones) == 2
    cells = open_trajectory(run).select_atoms("type stem ta exhausted", updating=True)
    cells.universe.trajectory[-1]
    assert sum(int(line.split()[-1]) for line in clones) == len(cells)


def test_watched_run(say: Say, tmp_path: Path) -> None:
    *before, last = say("watched_run.py", tmp_path / "run", 4)
    counts = [int(re.findall(r"(\d+) cells", line)[0]) for line in (before[-1], last)]
    assert counts[0] >= 4 and counts[1] == counts[0] - 1


def test_own_kind(say: Say, tmp_path: Path) -> None:
    first, *_, last = say("own_kind.py", tmp_path / "run")
    assert first == "t = 0: 1 of the mutant's clone, 1 of the other"
    mutant, normal = (int(word) for word in re.findall(r"(\d+) of", last))
    assert mutant > normal


def test_own_observable(say: Say, run: Path) -> None:
    lines = say("own_observable.py", run)
    assert len(lines) == 7 and lines[0] == "t = 0: nan"
    assert 0 < float(lines[-1].split()[-1]) < 12 / 2**0.5  # half the diagonal of the box at most
