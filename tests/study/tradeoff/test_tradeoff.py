"""skin tradeoff: what it writes, what it does again, what it refuses."""

import csv

import numpy as np
import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.study.ensemble import Member
from lammps_skin.study.tradeoff.measure import Measurements

GRID = ("tiny.toml", "--grid", "levels", "--set", "cells.cycle_delay=20.0", "--interval", 1)
SCENE = (*GRID, "--set", "output.dump_interval=1.0")


def rows(path):
    with path.open() as file:
        return list(csv.DictReader(file))


@pytest.mark.usefixtures("in_this_process")
def test_quick(skin, tmp_path):
    answer = skin("tradeoff", *SCENE, "--quick", "--variant", "half:timestep=0.005")
    assert answer.code == 0, answer.err
    found = {row["variant"]: row for row in rows(tmp_path / "tradeoff" / "tiny.csv")}
    assert list(found) == ["reference", "half", "balanced", "fast"]
    rms = {name: float(row["rms"]) for name, row in found.items()}
    assert 0 < rms["half"] < rms["reference"] and min(rms["balanced"], rms["fast"]) > 0
    assert [float(row["evaluations"]) for row in found.values()] == [100, 200, 8, 6]
    assert float(found["reference"]["cpu"]) == 1
    assert all(float(row["cpu"]) > 0 and not row["problem"] for row in found.values())
    (order,) = {row["order_median"] for row in rows(tmp_path / "tradeoff" / "tiny-orders.csv")}
    assert 0.5 < float(order) < 1.5
    page = (tmp_path / "tradeoff" / "tiny.md").read_text()
    assert "| half |" in page and "## Orders" in page and "ensembles" not in page
    assert (tmp_path / "tradeoff" / "tiny.png").read_bytes()[:4] == b"\x89PNG"

    kept = sorted((tmp_path / "tradeoff" / "measured").iterdir())
    times = [path.stat().st_mtime_ns for path in kept]
    again = skin("tradeoff", *SCENE, "--quick", "--variant", "half:timestep=0.005")
    assert "0 runs and 0 rounds of timing to do" in again.out
    assert [path.stat().st_mtime_ns for path in kept] == times
    assert sorted((tmp_path / "tradeoff" / "measured").iterdir()) == kept
    more = skin("tradeoff", *SCENE, "--quick", "--variant", "twice:timestep=0.02")
    assert "1 run and 1 round of timing to do" in more.out


@pytest.mark.usefixtures("in_this_process")
def test_ensembles(skin, tmp_path):
    """Runs of the reference are there, and those of the other levels are made."""
    short = ["tiny.toml", "--set", "output.dump_interval=1.0", "--set", "end_time=2.0",
             "--grid", "levels", "--interval", 0.5]  # fmt: skip
    scene = Scene.load("tiny.toml").replace(**{"output.dump_interval": 1.0, "end_time": 2.0})
    for seed in (1, 2):
        Member(scene.replace(seed=seed), tmp_path / "many").run()
    wanted = ("--data", "many", "--seeds", "1-2", "--windows", "0-2,1-2")
    answer = skin("tradeoff", *short, *wanted, "--present")
    assert answer.code == 0, answer.err
    assert not (tmp_path / "tradeoff" / "tiny-ensemble.csv").exists()
    answer = skin("tradeoff", *short, *wanted)
    assert answer.code == 0, answer.err
    assert "4 to do" in answer.out
    found = rows(tmp_path / "tradeoff" / "tiny-ensemble.csv")
    assert {row["variant"] for row in found} == {"balanced", "fast"}
    assert {row["window"] for row in found} == {"0-2", "1-2"}
    births = [row for row in found if row["name"] == "births" and row["window"] == "0-2"]
    assert [row["seeds"] for row in births] == ["2", "2"] and float(births[0]["reference"]) > 0
    table = {row["variant"]: row for row in rows(tmp_path / "tradeoff" / "tiny.csv")}
    assert np.isnan(float(table["reference"]["bias"])) and float(table["balanced"]["bias"]) > 0


@pytest.mark.usefixtures("in_this_process")
def test_interrupted(skin, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    short = (*SCENE, "--interval", 0.5, "--quick")
    with monkeypatch.context() as patched:
        patched.setattr(Measurements, "time_group", interrupt)
        answer = skin("tradeoff", *short)
    assert answer.code == 130 and "the same command goes on" in answer.out
    answer = skin("tradeoff", *short)
    assert answer.code == 0 and "0 runs and 1 round" in answer.out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--variant", "slow"), "--variant slow: must be NAME:KEY=VALUE"),
        (("--variant", "slow:timestep"), "--variant slow:timestep: 'timestep' must be KEY=VALUE"),
        (("--variant", "slow:speed=3"), "variant slow: numerics.speed = 3: unknown key"),
        (("--variant", "slow:timestep=-1"), "variant slow: numerics.timestep = -1: must be"),
        (("--variant", "slow:timestep=0.3"), "numerics.timestep = 0.3: must divide the interval"),
        (
            ("--variant", "slow:timestep=0.7", "--set", "output.dump_interval=1.0"),
            "numerics.timestep = 0.7: must divide the interval",
        ),
        (("--variant", "fast:timestep=0.5"), "variant fast: there is one of this name already"),
        (("--variant", "s/l:timestep=0.5"), "variant 's/l': the name must be"),
        (("--interval", "0"), "--interval 0: must be above 0"),
        (("--interval", "nan"), "--interval nan: must be above 0"),
        (("--windows", "5-1"), "--windows 5-1: 5-1 must be two times"),
        (("--seeds", "0"), "--seeds 0"),
        (("--from", "none"), "--from none: neither a restart file nor"),
        (("--set", "output.dump_interval=0.0"), "output.dump_interval = 0: an ensemble needs"),
        (("--set", "cells.seed=4"), "cells.seed = 4: must not be given"),
        (("-o", "tiny.toml"), "tiny.toml"),
    ],
)
def test_refused(skin, tmp_path, options, message):
    answer = skin("tradeoff", *GRID, *options)
    assert answer.code == 2
    assert message in answer.err
    assert answer.err.startswith("error: ") and answer.err.count("\n") == 1
    assert not (tmp_path / "tradeoff").exists() and not (tmp_path / "ensemble").exists()
