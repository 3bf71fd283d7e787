"""The expected cost of runs, against what they took, and the calibration for a machine."""

import csv
import json
from itertools import groupby
from pathlib import Path

import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.study import cost, rates
from lammps_skin.study.cost import estimate
from lammps_skin.study.rates import SHIPPED, rates_here, stored

MEASURED = Path(__file__).resolve().parents[2] / "docs" / "data" / "run-costs.csv"


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """A cache directory that is empty."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "lammps-skin" / "calibration.json"


def measured():
    """Seconds of whole runs, those of samples from their mean, by scene, parameters and level."""
    with MEASURED.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for case, pieces in groupby(rows, lambda row: (row["scene"], row["parameters"], row["level"])):
        taken = [(float(row["end"]) - float(row["begin"]), float(row["seconds"])) for row in pieces]
        length, seconds = map(sum, zip(*taken, strict=True))
        yield case, seconds / length


@pytest.mark.parametrize(("case", "rate"), [*measured()], ids=str)
def test_expected_times_are_right_by_a_third(case, rate):
    """With the start, as `skin check` tells them: a user waits for all of it."""
    name, parameters, level = case
    scene = Scene.load(name).replace(parameters=parameters, **{"numerics.accuracy": level})
    expected = estimate(scene, SHIPPED)
    taken = expected.start + rate * (scene.end_time - scene.begins)
    assert taken / expected.seconds == pytest.approx(1.0, abs=0.3)


def test_memory_and_disk_are_those_of_a_run():
    """Of quarter-ring with earlier-stiff: what it left, and its largest resident set."""
    scene = Scene.load("quarter-ring").replace(parameters="earlier-stiff")
    expected = estimate(scene, SHIPPED)
    assert expected.disk == pytest.approx(52.9e6, rel=0.1)
    assert expected.memory == pytest.approx(172e6, rel=0.1)


def test_a_calibration_begins_with_the_shipped_rates():
    """What it times takes as long as they say, on the machine where they were measured."""
    scene = Scene.load(cost.TIMED).replace(**cost.TIMED_KEYS)
    assert pytest.approx(estimate(scene, SHIPPED).first_step, rel=0.3) == cost.TIMED_STEP


def test_a_calibration_scales_all_estimates(cache, monkeypatch):
    scene = Scene.load("two-cells")
    shipped = estimate(scene)
    assert stored() is None and rates_here() == SHIPPED
    monkeypatch.setattr(cost, "TIMED", "one-stem")
    monkeypatch.setattr(cost, "measure", lambda *_, **__: 2 * cost.TIMED_STEP)
    running, starting = cost.calibrate()
    assert running == pytest.approx(2.0) and starting > 0
    found = estimate(scene)
    assert found.start == pytest.approx(starting * shipped.start)
    assert found.seconds - found.start == pytest.approx(2 * (shipped.seconds - shipped.start))
    assert found.first_step == pytest.approx(2 * shipped.first_step)


def test_other_calibrations_do_not_count(cache):
    rates.store(2.0, 1.0)
    assert stored() == (2.0, 1.0)
    good = json.loads(cache.read_text())
    for change in ({"rates": [1.0]}, {"running": 0}, {"running": "x"}, {"starting": float("nan")}):
        cache.write_text(json.dumps({**good, **change}))
        assert stored() is None
    for text in ("", "[]", "{", '{"running": 1}'):
        cache.write_text(text)
        assert stored() is None


def test_check_calibrates(skin, cache, monkeypatch):
    assert skin("check").err.startswith("error: SCENE: is missing")
    assert "--calibrate measures yours" in skin("check", "two-cells").out
    monkeypatch.setattr(cost, "TIMED", "one-stem")
    answer = skin("check", "two-cells", "--calibrate")
    assert answer.code == 0 and answer.out.startswith("calibrated: runs take ")
    assert cache.exists() and "measures yours" not in answer.out
