"""Interventions of fix skin/cells: which cells, when, once, and the state that they leave."""

import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import (
    CONTACT,
    FREEZE,
    HEIGHT,
    WORD,
    Event,
    busy_scene,
    crowd,
    first_division,
    lmp,
    membrane_scene,
    of_kind,
    place,
    read_events,
    thermo,
    uniform,
)
from tests.cells.scripts import error_of, fix_line, run_script, snapshots, told

CHOICE, CONVERTED_WAIT = 4, 5  # purposes of random numbers
MEMBRANE = 24 * 28
TYPES = {"stem": 2, "ta": 3, "exhausted": 4, "nd": 5}  # without a dermis
STATE = (
    "id type mol fx fy fz i_divisions_left i_divisions_done i_parent i_pair d_next_division "
    "d_birth_time d_detached_time f_cells[7]"
)
WRITE = f"write_dump all custom state.dump {STATE} modify sort id format float %.17g"


def key(name: str, occurrence: int) -> int:
    """Event number of the random numbers of an intervention, as the page of the fix tells it."""
    word = 0xCBF29CE484222325
    for byte in name.encode():
        word = (word ^ byte) * 0x100000001B3 & WORD
    return word + occurrence & WORD


def prepare(directory: Path, scene: Scene, start: Configuration, *interventions: str) -> None:
    """A built directory whose fix has these interventions."""
    build(scene, directory, start)
    path = directory / "cells.in"
    words = " ".join(f"intervene {one}" for one in interventions)
    path.write_text(path.read_text().replace(" log ${dir}", f" {words} log ${{dir}}"))
    assert words in path.read_text()


def quiet_scene(**changes: object) -> Scene:
    """No cell divides, event steps every 0.2."""
    return membrane_scene(
        **{"cells.cycle_delay": 1e6, "numerics.timestep": 0.02, "numerics.event_interval": 0.2},
        **changes,
    )


def still(scene: Scene) -> Configuration:
    return crowd(scene, across=5, amplitude=0.5, above=2.2)


def rows(directory: Path, cause: str) -> list[Event]:
    return [event for event in read_events(directory) if event.cause == cause]


# ---- which cells


def test_cells_that_are_chosen(tmp_path: Path) -> None:
    """On two ranks, cells that do not move, of kinds, in regions, and as random numbers tell."""
    scene = quiet_scene()
    start = still(scene)
    prepare(
        tmp_path, scene, start,
        "disc at 0.2 convert all nd cylinder 1 12 4", "side at 0.4 convert ta,nd exhausted "
        "half_space 1 2 0 20", "some at 0.6 remove all fraction 0.4",
    )  # fmt: skip
    assert run_script(tmp_path, FREEZE, "run 40 post no", ranks=2).returncode == 0

    x, y = start.positions[MEMBRANE:, :2].T
    ids = np.arange(len(x)) + MEMBRANE + 1
    kinds = start.kinds[MEMBRANE:].copy()
    width, depth = scene.box_sides[:2]
    away = [(place - middle + side / 2) % side - side / 2
            for place, middle, side in ((x, 1, width), (y, 12, depth))]  # fmt: skip
    disc = (np.hypot(*away) < 4) & (kinds != Kind.ND)
    assert [event.id for event in rows(tmp_path, "disc")] == ids[disc].tolist()
    assert np.ptp(x[disc]) > 8
    kinds[disc] = Kind.ND
    side = (x % width + 2 * (y % depth) > 20) & np.isin(kinds, [Kind.TA, Kind.ND])
    assert [event.id for event in rows(tmp_path, "side")] == ids[side].tolist()
    kinds[side] = Kind.EXHAUSTED
    some = [uniform(scene.cell_seed, cell, key("some", 0), CHOICE) < 0.4 for cell in ids.tolist()]
    removed = rows(tmp_path, "some")
    assert [event.id for event in removed] == ids[some].tolist()
    assert [event.type for event in removed] == kinds[some].tolist()
    assert 2 < sum(some) < len(some) - 2
    assert {event.kind for event in removed} == {"removal"}


def test_fractions_are_drawn_anew_each_time(tmp_path: Path) -> None:
    """Each of 25 cells has the probability 0.3 at each of 20 times."""
    scene = quiet_scene()
    prepare(
        tmp_path, scene, still(scene), "there at 1 convert all nd",
        "draw at 1.1 every 0.2 until 4.9 convert nd exhausted fraction 0.3",
        "back at 1.2 every 0.2 convert exhausted nd",
    )  # fmt: skip
    assert run_script(tmp_path, FREEZE, "run 260 post no").returncode == 0
    drawn = rows(tmp_path, "draw")
    times = sorted({round(event.time, 9) for event in drawn})
    assert times == pytest.approx(np.arange(1.2, 5.1, 0.2))
    assert len(drawn) == len(rows(tmp_path, "back"))
    assert abs(len(drawn) - 150) < 4 * math.sqrt(500 * 0.3 * 0.7)
    by_cell = np.unique([event.id for event in drawn], return_counts=True)[1]
    assert len(by_cell) == 25
    assert by_cell.max() < 15


# ---- what becomes of them


def test_converted_cells_enter_the_kind_and_begin_a_cycle(tmp_path: Path) -> None:
    """There and back, and in a dividing pair, which stays."""
    scene = quiet_scene(**{"cells.generations": 4, "cells.division_rate": 0.1})
    spots = [(3.0, 3.0, HEIGHT + CONTACT), (9.0, 3.0, HEIGHT + CONTACT)]
    start = place(scene, [(Kind.STEM, spots[0], 4), (Kind.TA, spots[1], 2)])
    start.next_division[-2] = 0.1
    prepare(
        tmp_path, scene, start,
        "there at 0.5 convert stem,ta nd", "back at 1 convert all ta", "last at 2 convert nd stem",
    )  # fmt: skip
    lines = [FREEZE, "run 60 post no", WRITE]
    assert run_script(tmp_path, *lines).returncode == 0
    (state,) = snapshots(tmp_path / "state.dump")
    cells = {name: column[MEMBRANE:] for name, column in state.items()}
    assert cells["id"].tolist() == [673, 674, 675]
    assert cells["type"].tolist() == [TYPES["ta"]] * 3
    assert cells["i_divisions_left"].tolist() == [4, 4, 4]
    assert cells["i_divisions_done"].tolist() == [1, 0, 0]
    assert cells["i_parent"].tolist() == [0, 0, 673]
    assert cells["i_pair"].tolist() == [675, 0, 673]
    waits = [
        -math.log(uniform(scene.cell_seed, cell, key("back", 0), CONVERTED_WAIT))
        / scene.cells.cycle_rate
        for cell in (673, 674, 675)
    ]
    assert cells["d_next_division"] == pytest.approx(1.0 + 1e6 + np.array(waits), rel=1e-14)
    there = rows(tmp_path, "there")
    assert [(e.kind, e.id, e.parent, e.type, e.divisions_left) for e in there] == [
        ("conversion", 673, 0, 6, 0), ("conversion", 674, 0, 6, 0), ("conversion", 675, 673, 6, 0),
    ]  # fmt: skip
    assert [e.time for e in there] == pytest.approx([0.6] * 3)
    assert rows(tmp_path, "last") == []


def test_added_cells_stand_on_the_membrane(tmp_path: Path) -> None:
    """On two ranks, on a steep slope, at an edge of the box, and where the input says."""
    scene = membrane_scene(**{"numerics.timestep": 0.02, "numerics.event_interval": 0.2})
    start = place(scene, [(Kind.ND, (9.0, 9.0, HEIGHT + 4.0), 0)], amplitude=3.0)
    prepare(
        tmp_path, scene, start,
        "graft at 0.4 add stem 3.1 2.9 nearest 12 6 nearest", "high at 0.4 add ta 0 0 27.9",
    )  # fmt: skip
    lines = [FREEZE, "run 20 post no", WRITE,
             'print "OUT $(count(cells)) $(atoms) $(f_cells[11])"']  # fmt: skip
    ((count, atoms, next_id),) = told(run_script(tmp_path, *lines, ranks=2))
    assert (count, atoms, next_id) == (4, MEMBRANE + 4, 677)
    (state,) = snapshots(tmp_path / "state.dump")
    cells = {name: column[MEMBRANE + 1 :] for name, column in state.items()}
    assert cells["type"].tolist() == [TYPES["stem"]] * 2 + [TYPES["ta"]]
    assert cells["f_cells[7]"][:2] == pytest.approx([CONTACT] * 2, rel=1e-12)
    assert cells["f_cells[7]"][2] == pytest.approx(2.5)
    for name in ("i_parent", "i_pair", "i_divisions_done"):
        assert (cells[name] == 0).all()
    assert cells["i_divisions_left"].tolist() == [0, 0, scene.cells.generations]
    assert (cells["d_detached_time"] == -1).all()
    assert cells["d_birth_time"] == pytest.approx([0.4] * 3)
    told_times = [first_division(scene, scene.cell_seed, cell, 0.4) for cell in (674, 675, 676)]
    assert cells["d_next_division"] == pytest.approx(told_times, rel=1e-14)
    assert [(e.kind, e.id, e.parent, e.type) for e in read_events(tmp_path)] == [
        ("addition", 674, 0, 3), ("addition", 675, 0, 3), ("addition", 676, 0, 4),
    ]  # fmt: skip


def test_removal_ends_the_pair(tmp_path: Path) -> None:
    scene = quiet_scene(**{"cells.division_rate": 0.1})
    start = place(scene, [(Kind.STEM, (6.0, 6.0, HEIGHT + CONTACT), 10)])
    start.next_division[-1] = 0.1
    prepare(tmp_path, scene, start, "cut at 0.4 remove ta")
    lines = ["run 20 post no", WRITE, 'print "OUT $(f_cells[8]) $(f_cells[10]) $(atoms)"']
    assert told(run_script(tmp_path, *lines)) == [[0, 0, MEMBRANE + 1]]
    assert [(e.kind, e.id, e.parent, e.cause) for e in read_events(tmp_path)] == [
        ("birth", 674, 673, "division"), ("removal", 674, 673, "cut"),
        ("division_end", 674, 673, "partner_removed"),
    ]  # fmt: skip


# ---- the state right after, once, on ranks and after restarts

BUSY = [
    "wound at 2 remove all cylinder 12 12 3.5", "graft at 2 add stem 12 12 nearest",
    "mutation at 3 every 0.5 until 4 convert all nd fraction 0.3 half_space 1 0 0 6",
    "back at 4.5 convert nd stem", "note at 5 change",
]  # fmt: skip


@pytest.fixture(scope="module")
def busy() -> Scene:
    return busy_scene(
        **{"end_time": 7.0, "numerics.event_interval": 0.2, "output.checkpoint_interval": 1.0}
    )


@pytest.fixture(scope="module")
def whole(busy: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with births, deaths and all interventions, and restart files from between them."""
    directory = tmp_path_factory.mktemp("whole")
    prepare(directory, busy, still(busy), *BUSY)
    path = directory / "output.in"
    path.write_text(path.read_text() + "\nrestart 20 kept.*.restart\natom_modify sort 20 0.0\n")
    assert lmp(directory).returncode == 0
    events = read_events(directory)
    assert {event.kind for event in events} == {
        "birth", "death", "division_end", "removal", "addition", "conversion", "change"
    }  # fmt: skip
    assert len(of_kind(events, "change")) == 1
    ended = [event.id for event in of_kind(events, "division_end")]
    assert len(ended) == len(set(ended))
    times = [event.time for event in events]
    assert times == sorted(times)
    return directory


TILED = "change_box all triclinic\ncomm_style tiled\nbalance 1.0 rcb\n"


@pytest.mark.parametrize("box", ["", pytest.param(TILED, id="tiled", marks=pytest.mark.slow)])
def test_two_ranks_do_the_same(box: str, whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    (tmp_path / "events.csv").unlink()
    path = tmp_path / "output.in"
    path.write_text(path.read_text() + box)
    assert lmp(tmp_path, ranks=2).returncode == 0
    assert (tmp_path / "events.csv").read_bytes() == (whole / "events.csv").read_bytes()


@pytest.mark.parametrize("step", [100, 160])
def test_restarts_do_nothing_twice(step: int, whole: Path, tmp_path: Path) -> None:
    """On the step of one, and between two occurrences of another."""
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    assert lmp(tmp_path, "-var", "restart", f"kept.{step}.restart").returncode == 0
    assert (tmp_path / "events.csv").read_bytes() == (whole / "events.csv").read_bytes()


def test_numbers_of_cells_follow_the_log(whole: Path) -> None:
    events, row = read_events(whole), thermo(whole)[-1]
    count = {kind: len(of_kind(events, kind)) for kind in ("birth", "death", "addition", "removal")}
    alive = 25 + count["birth"] + count["addition"] - count["death"] - count["removal"]
    assert row["Atoms"] == MEMBRANE + alive
    assert (row["f_cells[9]"], row["f_cells[10]"]) == (count["birth"], count["death"])


@pytest.mark.parametrize(("time", "ranks"), [(2.0, 2), (3.0, 1)], ids=["remove-and-add", "convert"])
def test_forces_are_those_of_the_state(
    time: float, ranks: int, busy: Scene, tmp_path: Path
) -> None:
    """Of the step of an intervention, and of a run of no steps from a data file of its state."""
    columns = "pe c_cell_cell_exclusion f_cells[1] f_cells[2] f_cells[3] f_cells[8]"
    energies = ["fix_modify cells energy yes", f"thermo_style custom step {columns}"]
    out = "print 'OUT " + " ".join(f"$({column})" for column in columns.split()) + "'"
    prepare(tmp_path, busy, still(busy), *BUSY)
    lines = [*energies, f"run {round(time / 0.02)} post no", out, WRITE,
             "write_data half.data nocoeff"]  # fmt: skip
    (then,) = told(run_script(tmp_path, *lines, ranks=ranks))
    (tmp_path / "state.dump").rename(tmp_path / "then.dump")
    (tmp_path / "half.data").rename(tmp_path / "skin.data")
    arguments = ("-var", "start_time", f"{time}", "-var", "start_step", f"{round(time / 0.02)}")
    process = run_script(tmp_path, *energies, "run 0 post no", out, WRITE, arguments=arguments)
    (again,) = told(process)
    assert again == pytest.approx(then, rel=1e-9)
    (old,), (new,) = snapshots(tmp_path / "then.dump"), snapshots(tmp_path / "state.dump")
    for name in STATE.split():
        np.testing.assert_allclose(new[name], old[name], rtol=1e-9, atol=1e-8, err_msg=name)


def test_fix_given_anew_does_nothing_twice(busy: Scene, tmp_path: Path) -> None:
    """Also not what it had not been told, whose time is past."""
    prepare(tmp_path, busy, still(busy), "wound at 0.3 remove nd")
    again = (
        f"fix cells cells {fix_line(busy)} log events.csv intervene wound at 0.3 change "
        "intervene late at 0.4 change intervene new at 0.5 change"
    )
    lines = ["run 20 post no", "unfix cells", again, "run 20 post no"]
    process = run_script(tmp_path, *lines)
    assert process.returncode == 0, process.stdout[-1000:]
    found = [(e.kind, e.cause) for e in read_events(tmp_path) if e.kind in ("removal", "change")]
    assert set(found[:-1]) == {("removal", "wound")}
    assert found[-1] == ("change", "new")


def test_times_before_the_first_run_are_past(tmp_path: Path) -> None:
    scene = quiet_scene()
    prepare(
        tmp_path, scene, still(scene), "old at 9 change", "older at 4 every 2 until 8 change",
        "now at 10 change", "rest at 8.5 every 1 change",
    )  # fmt: skip
    arguments = ("-var", "start_time", "10", "-var", "start_step", "500")
    process = run_script(tmp_path, FREEZE, "run 100 post no", arguments=arguments)
    warnings = [line for line in process.stdout.splitlines() if "does not happen" in line]
    assert [line.split(":")[1].split()[-1] for line in warnings] == ["old", "older"]
    found = [(e.cause, e.time) for e in read_events(tmp_path)]
    assert found == [("now", 10.2), ("rest", 10.6), ("rest", 11.6)]


# ---- what ends the run


def test_no_more_than_one_a_step(tmp_path: Path) -> None:
    """An occurrence on each step is done; more of them are an error before the first step."""
    scene = quiet_scene()
    prepare(tmp_path, scene, still(scene), "often at 0.1 every 0.02 change")
    assert run_script(tmp_path, "run 20 post no").returncode == 0
    assert len(rows(tmp_path, "often")) == 16
    error = error_of(run_script(tmp_path, "timestep 0.021", "run 1"))
    assert "Fix skin/cells intervene often every = 0.02: must be >= 0.021, the timestep" in error


@pytest.mark.parametrize(
    ("add", "message"),
    [
        ("stem 9 9 nearest", "from another cell, must be at least 2.8"),
        ("stem 6 6 24", "from a membrane particle, must be at least 2.4"),
        ("stem 3 3 99 3 4 99", "3 4 99 would be 1 from another cell, must be at least 2.8"),
        ("stem 3 3 100", "a cell at 3 3 100 would be above the box, which ends at 100"),
    ],
)  # fmt: skip
def test_cells_are_not_added_where_there_is_no_room(add: str, message: str, tmp_path: Path) -> None:
    scene = quiet_scene()
    start = place(scene, [(Kind.ND, (9.0, 9.0, HEIGHT + CONTACT), 0)])
    prepare(tmp_path, scene, start, f"graft at 0.1 add {add}")
    error = error_of(run_script(tmp_path, FREEZE, "run 20 post no"))
    assert error.startswith("ERROR: Fix skin/cells intervene graft: ")
    assert message in error
