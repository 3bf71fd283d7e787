"""``skin stats``: what it prints, its JSON, and what it refuses."""

import json

import numpy as np
import pytest
from lammps_skin.analysis.lineage import read_events
from lammps_skin.analysis.observables import least, observables
from lammps_skin.analysis.statistics import mean_in_time
from lammps_skin.model.parameters import DEFAULT
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation


@pytest.fixture
def run(scene, tmp_path):
    with Simulation.begin(scene, tmp_path / "run") as simulation:
        simulation.run()
    return tmp_path / "run"


def test_json_is_all_of_it(skin, run):
    answer = skin("stats", run, "--json", "--window", "1-2.5")
    assert answer.code == 0 and not answer.err
    found = json.loads(answer.out, parse_constant=lambda word: pytest.fail(word))
    table, events = observables(run), read_events(run / "events.csv")
    assert found["run"]["frames"] == 7 and found["run"]["scene"] == "tiny"
    for name, values in found["observables"].items():
        np.testing.assert_allclose(np.array(values, float), table[name], err_msg=name)
    assert None in found["observables"]["chi_H_nd"]
    expected = mean_in_time(table["height"][2:6])
    assert found["window"]["means"]["height"]["value"] == pytest.approx(expected.value)
    assert found["window"]["frames"] == 4
    for name in table.dtype.names:
        assert not (table[name] < least(name)).any(), name
    assert found["events"]["births"] == len(events.of("birth").id) > 0
    (clone,) = found["events"]["clones"]
    assert clone["size"] == 1 + clone["births"] - clone["removals"] == found["events"]["cells"]
    assert found["energies"]["total"]["last"] == pytest.approx(
        sum(values["last"] for name, values in found["energies"].items() if name != "total")
    )


def test_what_is_printed(skin, run):
    answer = skin("stats", run)
    assert answer.code == 0 and "Traceback" not in answer.err
    first, *lines = answer.out.splitlines()
    assert first == f"tiny, {DEFAULT}, seed 1: 7 frames, t = 0 to 3"
    words = {line.split()[0] for line in lines if line.strip()}
    assert {"ta", "coverage", "births", "clone", "zeta", "stretch", "total"} <= words
    assert "nan" not in answer.out


def test_a_window_is_shown_over_time_too(skin, run):
    lines = skin("stats", run, "--window", "1-2").out.splitlines()
    heads = next(line.split() for line in lines[1:] if line.strip())
    assert heads == ["1", "1.5", "2"]
    (rates,) = (line for line in lines if line.startswith("births, removals per time unit"))
    assert "per time unit, t = 1 to 2 " in rates


def test_what_rises_in_a_window_is_told(skin, run):
    """The membrane, flat at the start, does."""
    found = json.loads(skin("stats", run, "--json", "--window", "0-3").out)["window"]["means"]
    answer = skin("stats", run, "--window", "0-3").out
    rising = [name for name, mean in found.items() if mean["trend"] == "rises"]
    assert "height_std" in rising and found["ta"]["low"] >= 0
    assert "not stationary in t = 0 to 3: " in answer
    averages = answer.partition("95 % interval")[2].splitlines()
    assert next(line.split() for line in averages if line.startswith("height_std "))[-1] == "rises"


def test_the_seed_is_that_of_the_run(skin, scene, tmp_path):
    """Which may be another one than its scene's."""
    with Simulation.begin(scene, tmp_path / "run", variables={"seed": 7}) as simulation:
        simulation.run(until=1.0)
    first = skin("stats", "run").out.splitlines()[0]
    assert first == f"tiny, {DEFAULT}, seeds 7 of cells, 1 of dermis: 3 frames, t = 0 to 1 of 3"
    told = json.loads(skin("stats", "run", "--json").out)["run"]
    assert (told["seed"], told["cell_seed"], told["dermis_seed"]) == (1, 7, 1)


def test_the_file_alone(skin, run, tmp_path):
    (run / "skin.h5").rename(tmp_path / "moved.h5")
    answer = skin("stats", tmp_path / "moved.h5", "--json")
    found = json.loads(answer.out)
    assert found["run"]["frames"] == 7
    assert found["events"] is None and found["energies"] is None
    assert found["observables"]["births"] == [None] * 7


def test_a_membrane_without_cells(skin, tmp_path):
    scene = Scene.load("bare-membrane").replace(
        **{"membrane.lattice": [12, 14], "end_time": 0.2, "output.dump_interval": 0.1}
    )
    with Simulation.begin(scene, tmp_path / "bare") as simulation:
        simulation.run()
    found = json.loads(skin("stats", tmp_path / "bare", "--json").out)
    assert found["observables"]["stem"] == [0, 0, 0]
    assert found["observables"]["coverage"] == [0, 0, 0]
    assert found["observables"]["zeta"] == [None, None, None]
    assert skin("stats", tmp_path / "bare").code == 0


def test_what_is_refused(skin, run, tmp_path):
    (tmp_path / "empty").mkdir()
    whole = (run / "skin.h5").read_bytes()
    (tmp_path / "cut.h5").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "words.h5").write_text("words")
    for arguments, words in [
        (["empty"], "directory empty: holds no trajectory"),
        (["nowhere"], "nowhere"),
        (["cut.h5"], "trajectory cut.h5"),
        (["words.h5"], "trajectory words.h5"),
        ([run, "--window", "7-9"], "window = 7-9: holds no frame"),
        ([run, "--window", "soon"], "--window soon: must be two ascending times"),
        ([run, "--window", "2-1"], "--window 2-1: must be two ascending times"),
    ]:
        for more in ([], ["--json"]):
            answer = skin("stats", *arguments, *more)
            assert answer.code == 2, arguments
            assert answer.err.startswith("error: ") and words in answer.err
            assert answer.err.count("\n") == 1 and not answer.out
