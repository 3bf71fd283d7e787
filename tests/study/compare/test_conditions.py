"""Conditions are read from runs, ensembles and tables, and written side by side."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.analysis.observables import observables, write_table
from lammps_skin.errors import SkinError
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.study.compare.conditions import read
from lammps_skin.study.ensemble import with_seed

from tests.conftest import Answer

BENDING = "membrane.bending_stiffness"
SCENE = {
    "name": "small", "end_time": 2.0, "dermis": {"present": False},
    "membrane": {"lattice": [12, 14]}, "cells": {"stem": 1, "first_phase": 0.5},
    "numerics": {"accuracy": "reference"}, "output": {"dump_interval": 0.5},
}  # fmt: skip


@pytest.fixture(scope="session")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs soft, stiff and again of one scene, with the seeds 1, 1 and 2."""
    folder = tmp_path_factory.mktemp("runs")
    scene = Scene.from_dict(SCENE)
    stiff = scene.replace(**{"membrane.bending_stiffness": 2.0})
    runs = {"soft": scene, "stiff": stiff, "again": scene.replace(seed=2)}
    for name, one in runs.items():
        with Simulation.begin(one, folder / name) as simulation:
            simulation.run()
    return folder


@pytest.fixture(scope="session")
def ensembles(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folders one and two with gathered tables; two has stiffness 2, and zeta is 1 higher."""
    folder = tmp_path_factory.mktemp("ensembles")
    random = np.random.default_rng(1)
    for number, place in enumerate(("one", "two")):
        tables = []
        for seed in (1, 2, 3, 4):
            table = np.zeros(11, [(name, float) for name in ("time", "zeta", "births", "stem")])
            table["time"] = np.linspace(0, 100, 11)
            table["zeta"] = number + random.normal(scale=0.1, size=11)
            table["births"] = np.arange(11) * (number + 1)
            tables.append(with_seed(table, seed))
        keys = SCENE | {"membrane": {"lattice": [12, 14], "bending_stiffness": 1.0 + number}}
        comments = ["small, seeds 1, 2, 3, 4, key abc", f"scene: {json.dumps(keys)}"]
        write_table(np.concatenate(tables), folder / place / "small.csv.gz", comments)
    return folder


def test_runs_are_read_with_their_seeds(runs: Path) -> None:
    soft, again = read([str(runs / "soft"), f"other={runs / 'again'}"])
    assert (soft.name, again.name) == ("soft", "other")
    assert ([*soft.by_seed], [*again.by_seed]) == ([1], [2])
    found = observables(runs / "soft")
    assert all(
        np.array_equal(soft.table[name], found[name], equal_nan=True) for name in found.dtype.names
    )
    assert soft.value_of("membrane.bending_stiffness") == 0.5
    for key in ("membrane.stiffness", "cells", "membrane.lattice"):
        with pytest.raises(SkinError, match=key):
            soft.value_of(key)


def test_runs_side_by_side(runs: Path, skin: Callable[..., Answer]) -> None:
    found = skin("compare", runs / "soft", runs / "stiff", "--columns", "height_std,stem")
    assert found.code == 0, found.err
    assert "one seed each: differences are shown without a test" in found.out
    assert "stiff: membrane.bending_stiffness = 2.0" in found.out


def test_ensembles_side_by_side(ensembles: Path, skin: Callable[..., Answer]) -> None:
    files = ["-o", "c.md", "-o", "c.csv", "-o", "c.json"]
    one, two = f"low={ensembles / 'one'}", f"high={ensembles / 'two' / 'small.csv.gz'}"
    found = skin("compare", one, two, "--windows", "20-60,60-100", *files)
    assert found.code == 0, found.err
    rows = list(csv.DictReader(Path("c.csv").read_text().splitlines()))
    assert len(rows) == 2 * 2 * 2  # columns with values, windows, conditions
    zeta = [row for row in rows if row["column"] == "zeta" and row["condition"] == "high"]
    assert [row["start"] for row in zeta] == ["20", "60"]
    assert all(float(row["difference"]) == pytest.approx(1.0, abs=0.1) for row in zeta)
    assert all(row["test"] == "paired" and float(row["p"]) < 0.001 for row in zeta)
    births = [row for row in rows if row["column"] == "births"]
    assert [float(row["mean"]) for row in births] == [4.0, 8.0, 4.0, 8.0]  # during 40 time units
    told = json.loads(Path("c.json").read_text())
    assert [one["name"] for one in told["conditions"]] == ["low", "high"]
    assert len(told["rows"]) == len(rows) and told["rows"][0]["difference"] is None
    page = Path("c.md").read_text()
    assert "membrane.bending_stiffness = 2.0" in page and "| zeta | 20-60 | low | 4 |" in page


@pytest.mark.parametrize(
    ("suffix", "begins"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")]
)
def test_plots(ensembles: Path, skin: Callable[..., Answer], suffix: str, begins: bytes) -> None:
    """Over time, against a key, which the tables tell, and by condition."""
    folders = [ensembles / "one", ensembles / "two"]
    columns = "zeta,zeta>0.5"
    for options in ([], *(["--against", key] for key in (BENDING, "condition"))):
        path = f"plot.{suffix}"
        found = skin("compare", *folders, "--columns", columns, "--plot", path, *options)
        assert found.code == 0, found.err
        assert Path(path).read_bytes().startswith(begins)


def test_names(ensembles: Path) -> None:
    """A folder of several tables is as many conditions."""
    for name in ("first", "second"):
        table = (ensembles / "one" / "small.csv.gz").read_bytes()
        (ensembles / "many").mkdir(exist_ok=True)
        (ensembles / "many" / f"{name}.csv.gz").write_bytes(table)
    many, one = str(ensembles / "many"), str(ensembles / "one")
    assert [one.name for one in read([many])] == ["first", "second"]
    assert [one.name for one in read([one, many])] == ["small", "first", "second"]
    assert [one.name for one in read([one, str(ensembles / "two")])] == ["one/small", "two/small"]
    named = [f"a={one}", f"b={many}"]
    assert [one.name for one in read(named)] == ["a", "b/first", "b/second"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["one"], "is one condition; give at least two"),
        (["one", "one"], "condition one/small: there are two of this name"),
        (["one", "nowhere"], "nowhere: is no run directory, no folder of an ensemble or a study"),
        (["a=one", "b=two", "--columns", "zita"], "did you mean zeta?"),
        (["a=one", "b=two", "--columns", "coverage-zeta"], "there is no column coverage"),
        (["a=one", "b=two", "--windows", "50-500"], "--windows 50-500: 50-500 must be"),
        (["a=one", "b=two", "-o", "c.txt"], "must end in one of .md, .csv, .json"),
        (["a=one", "b=two", "--plot", "c.txt"], "output c.txt: its suffix must be one of"),
        (["a=one", "b=two", "--against", "cells.stem"], "give --plot FILE, too"),
        (["a=one", "b=two", "--plot", "c.png", "--against", "cells.stam"], "is no key of a scene"),
    ],
)
def test_bad_input(
    ensembles: Path, skin: Callable[..., Answer], monkeypatch: pytest.MonkeyPatch,
    arguments: list[str], said: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(ensembles)
    found = skin("compare", *(str(word) for word in arguments))
    assert (found.code, found.out) == (2, "") and said in found.err and found.err.count("\n") == 1
