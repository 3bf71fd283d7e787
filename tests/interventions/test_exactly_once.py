"""Each intervention is done exactly once, whoever runs the scene, on whatever ranks."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.analysis.lineage import clone_sizes, living, read_events, with_added
from lammps_skin.analysis.observables import observables
from lammps_skin.analysis.summary import summary
from lammps_skin.event_log import INTERVENING
from lammps_skin.kinds import is_cell
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import build
from lammps_skin.trajectory.clones import clones
from lammps_skin.trajectory.store import Store

from tests.cells.conftest import lmp
from tests.run.disturbed import Runner
from tests.trajectory.conftest import same


def log(directory: Path) -> str:
    return (directory / "events.csv").read_text()


def test_rows(scene: Scene, whole: Path) -> None:
    """Each is in the event log, with its name, on the first event step at or after its time."""
    rows = [line.split(",") for line in log(whole).splitlines()[1:]]
    done: dict[str, set[tuple[str, float]]] = {}
    for time, kind, *_, cause in rows:
        if kind in INTERVENING:
            done.setdefault(cause, set()).add((kind, float(time)))
    assert done == {
        "thinning": {("removal", time) for time in (3.5, 6.5, 9.5, 12.5)},
        "softer": {("change", 6.5)}, "mutation": {("conversion", 9.0)},
        "wound": {("removal", 12.0)}, "graft": {("addition", 14.0)}, "stiffer": {("change", 16.0)},
    }  # fmt: skip
    wounded = np.array([row[5:7] for row in rows if row[-1] == "wound"], float)
    assert (np.hypot(*(wounded - 6.0).T) < 3.0).all()
    grafted = next(row for row in rows if row[-1] == "graft")
    assert grafted[5:7] == ["6", "6"] and grafted[3] == "0"


def test_cells_that_come_later_alone(tmp_path: Path) -> None:
    """A scene without a first cell is run as it was built, and resumed."""
    graft = {"name": "graft", "at": 1.0, "add": "stem", "places": [[5.0, 5.0]]}
    keys = {"end_time": 2.0, "cells.stem": 0, "interventions": [graft]}
    build(Scene.load("two-cells").replace(**keys), tmp_path)
    with Simulation.begin_built(tmp_path) as simulation:
        simulation.run(until=1.5)
    with Simulation.resume(tmp_path) as simulation:
        simulation.run()
        assert simulation.cells().ids.tolist() == [24 * 28 + 1]
    assert log(tmp_path).count("addition") == 1


def test_whoever_reads_the_log_knows_them(whole: Path) -> None:
    events, store = read_events(whole / "events.csv"), Store(whole / "skin.h5")
    first, last = store[0], store[len(store) - 1]
    founders = with_added(first.ids[is_cell(first.kinds)], events)
    cells = last.ids[is_cell(last.kinds)]
    np.testing.assert_array_equal(living(events, founders[:-1], last.time), cells)
    sizes = clone_sizes(events, founders, [0.0, last.time])
    assert sizes[0].tolist() == [1] * (len(founders) - 1) + [0]
    found = Counter(clones(store)[cells - 1].tolist())
    assert sizes[1].tolist() == [found[founder] for founder in founders.tolist()]

    told = summary(whole)["events"]
    removed = {cause: n for cause, n in told["removals_by_cause"].items() if cause != "detached"}
    assert removed == {name: int(told["interventions"][name].split()[0]) for name in removed}
    assert removed.keys() == {"thinning", "wound"}
    assert told["interventions"]["graft"] == "1 added"
    assert told["interventions"]["stiffer"] == "changed"
    assert told["removals"] == sum(told["removals_by_cause"].values())
    assert told["births"] + len(founders) - told["removals"] == told["cells"] == len(cells)
    assert {clone["founder"] for clone in told["clones"]} == set(founders.tolist())


def test_plain_lammps_also_from_its_restart_files(
    scene: Scene, whole: Path, tmp_path: Path
) -> None:
    build(scene, tmp_path)
    assert lmp(tmp_path).returncode == 0
    assert log(tmp_path) == log(whole)
    for number in (1, 2):
        assert lmp(tmp_path, "-var", "restart", f"skin.{number}.restart").returncode == 0
        assert log(tmp_path) == log(whole)


def test_killed_on_two_ranks_and_resumed_on_one(scene: Scene, whole: Path, tmp_path: Path) -> None:
    build(scene, tmp_path)
    with Runner(tmp_path, ranks=2) as runner:
        runner.wait_for(14.5)
        runner.process.kill()
    assert not log(tmp_path).endswith("stiffer\n")
    with Simulation.resume(tmp_path) as simulation:
        assert simulation.time == 12.0
        simulation.run()
    assert log(tmp_path) == log(whole)


@pytest.mark.parametrize("time", [12.0, 14.0])
def test_a_fork_does_not_do_again_what_was_done(
    scene: Scene, whole: Path, tmp_path: Path, time: float
) -> None:
    """What is due at that very moment has been done; keys are what they were."""
    with Simulation.begin(
        scene.replace(**{"start.from": str(whole), "start.time": time}), tmp_path
    ) as fork:
        fork.run()
    mine, theirs = (log(run).splitlines()[1:] for run in (tmp_path, whole))
    assert len(mine) > 10 and mine == theirs[-len(mine) :]
    names = {row.split(",")[-1] for row in mine}
    assert "stiffer" in names and "wound" not in names and ("graft" in names) == (time < 14)
    later = [frame for frame in Store(whole / "skin.h5") if frame.time >= time]
    assert all(same(*pair) for pair in zip(Store(tmp_path / "skin.h5"), later, strict=True))


def test_a_fork_with_other_event_steps_does_not_do_it_again_either(
    scene: Scene, whole: Path, tmp_path: Path
) -> None:
    """By its own event steps it has come to t = 12.5; the graft was made at t = 14."""
    changes = {"numerics.event_interval": 2.5, "end_time": 18.0}
    start = {"start.from": str(whole), "start.time": 14.0}
    with Simulation.begin(scene.replace(**changes, **start), tmp_path) as fork:
        fork.run()
    causes = [row.split(",")[-1] for row in log(tmp_path).splitlines()]
    assert "stiffer" in causes and not {"wound", "graft"} & {*causes}


def test_a_membrane_without_cells_is_sown(tmp_path: Path) -> None:
    scene = Scene.from_dict({
        "name": "sown", "end_time": 4.0, "dermis": {"present": False},
        "membrane": {"lattice": [16, 18]}, "output": {"dump_interval": 2.0},
        "interventions": [
            {"name": "seeds", "at": 1.0, "add": "stem", "places": [[1.0, 1.0], [4.0, 4.0, 25.0]]}
        ],
    })  # fmt: skip
    with Simulation.begin(scene, tmp_path) as simulation:
        assert len(simulation.cells().ids) == 0
        simulation.run()
        assert len(simulation.cells().ids) == 2
    assert [
        len(frame.state["partner"][is_cell(frame.kinds)]) for frame in Store(tmp_path / "skin.h5")
    ] == [0, 2, 2]


def test_a_wound_closes(scene: Scene, tmp_path: Path) -> None:
    """All but stem and ND cells leave, and as many are there again later."""
    wound = {"name": "wound", "at": 10.0, "remove": ["ta", "exhausted"]}
    scene = scene.replace(**{"interventions": [wound], "cells.generations": 5})
    with Simulation.begin(scene, tmp_path) as simulation:
        simulation.run(until=9.75)
        before = len(simulation.cells().ids)
        simulation.run(until=10.0)
        assert before > 10 and len(simulation.cells().ids) == 3
        simulation.run()
        assert len(simulation.cells().ids) > before


@pytest.mark.slow
def test_the_built_in_wound_closes(tmp_path: Path) -> None:
    with Simulation.begin("wound", tmp_path) as simulation:
        simulation.run()
    table = observables(tmp_path)
    when = {time: n for n, time in enumerate(table["time"].tolist())}
    assert table["coverage"][when[290.0]] > 0.99
    assert table["coverage"][when[300.0]] < 0.8
    assert table["coverage"][when[350.0]] > 0.99
