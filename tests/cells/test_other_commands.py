"""Commands that make, remove and renumber atoms beside fix skin/cells."""

from pathlib import Path

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.start.build import build

from tests.cells.conftest import HEIGHT, of_kind, place, read_events
from tests.cells.scripts import busy, error_of, fix_line, run_script, snapshots, told

REGION = "region slab block 0 11.9 0 12.1 24.7 25.0"
DUMP = "dump every all custom 1 x.dump id type i_parent i_pair"


def slow(*cases: tuple[object, ...]) -> list[object]:
    """Cases of a parametrized test that are one more of a kind."""
    return [pytest.param(*case, marks=pytest.mark.slow) for case in cases]


def assert_ids_once(path: Path) -> None:
    """No two atoms of a frame have one ID, no cell comes back once it has gone."""
    gone: set[float] = set()
    last: set[float] = set()
    for frame in snapshots(path):
        ids = frame["id"].tolist()
        assert len(ids) == len(set(ids))
        assert not gone & set(ids)
        gone |= last - set(ids)
        last = set(ids)


# ---- creators


@pytest.mark.parametrize(
    ("order", "ranks"),
    [("after", 2), ("before", 1), *slow(("after", 1), ("before", 2))],
)
def test_cells_immigrate(order: str, ranks: int, tmp_path: Path) -> None:
    """Stock fix deposit beside the fix, on the same steps, whichever comes first."""
    deposit = "fix dep cells deposit 5 nd 4 4321 region slab near 1.0 vz 0 0"
    lines = [REGION, deposit]
    if order == "before":
        lines = ["unfix cells", *lines, f"fix cells cells {fix_line(busy())} log events.csv"]
    process = run_script(
        tmp_path, *lines, DUMP, "run 32 post no",
        'print "OUT $(f_cells[7]) $(f_cells[9]) $(f_cells[10]) $(f_cells[11])"',
        scene=busy(), ranks=ranks,
    )  # fmt: skip
    ((nd, births, deaths, next_id),) = told(process)
    assert (nd, births > 5) == (6, True)
    assert_ids_once(tmp_path / "x.dump")
    frames = snapshots(tmp_path / "x.dump")
    ever = set().union(*(frame["id"].tolist() for frame in frames))
    # births, immigrants and the first: each had an ID of its own
    assert len(ever) == 675 + births + 5
    assert next_id == max(ever) + 1
    assert len(frames[-1]["id"]) == len(ever) - deaths
    events = read_events(tmp_path)
    born = [event.id for event in of_kind(events, "birth")]
    assert len(born) == len(set(born)) == births
    last = dict(zip(frames[-1]["id"], frames[-1]["i_parent"], strict=True))
    for event in of_kind(events, "birth"):
        assert last.get(event.id, event.parent) == event.parent


@pytest.mark.parametrize(
    ("kind", "height", "set_state"),
    [
        ("nd", 24.8, []),
        ("stem", 24.8, []),
        ("exhausted", 24.8, []),
        ("ta", 24.8, ["set atom 676 i_divisions_left 3"]),
        ("ta", 24.8, ["set atom 676 i_divisions_left 3 d_next_division -1"]),
        ("ta", 24.8, ["set atom 676 i_divisions_left 3 d_next_division -1 d_detached_time -1"]),
    ],
)
def test_created_cells_live(kind: str, height: float, set_state: list[str], tmp_path: Path) -> None:
    """What the zeros of fix property/atom mean: a cell that begins with the run."""
    lines = [
        "run 4 post no", f"create_atoms {kind} single 6 6 {height}", *set_state,
        "group cells id 676", "run 1 post no",
        'print "OUT $(f_cells[10])"', "dump d cells custom 1 x.dump id d_next_division "
        "d_birth_time d_detached_time f_cells[7]", "run 3 post no",
    ]  # fmt: skip
    process = run_script(tmp_path, *lines, scene=busy(**{"cells.cycle_delay": 4.0}))
    assert told(process) == [[0.0]]
    for frame in snapshots(tmp_path / "x.dump"):
        row = {key: values[frame["id"] == 676] for key, values in frame.items()}
        assert row["id"].tolist() == [676]
        divides = kind in ("stem", "ta")
        assert (row["d_next_division"] >= (3.0 if divides else -1.0)).all()
        assert divides or (row["d_next_division"] == -1.0).all()
        assert row["d_detached_time"].tolist() == [-1.0]
    if not set_state:
        assert row["d_birth_time"].tolist() == [1.0]


def test_created_ta_cell_without_divisions_is_refused(tmp_path: Path) -> None:
    lines = [REGION, "fix dep cells deposit 1 ta 4 4321 region slab near 1.0 vz 0 0", "run 6"]
    message = error_of(run_script(tmp_path, *lines, scene=busy()))
    assert "Fix skin/cells: cell 676 is of kind ta and has 0 divisions left" in message


def test_deposited_cell_beyond_the_membrane_names_no_timestep(tmp_path: Path) -> None:
    lines = ["region far block 0 11 0 12 40 41", "group cells id 1",
             "fix dep cells deposit 1 nd 4 4321 region far near 1.0 vz 0 0", "run 6"]  # fmt: skip
    message = error_of(run_script(tmp_path, *lines, scene=busy()))
    assert "nd cell 676 has lost the membrane on step 1" in message
    assert "timestep" not in message


# ---- removers


@pytest.mark.parametrize(
    ("which", "ranks"), [("younger", 1), ("older", 2), *slow(("younger", 2), ("older", 1))]
)
def test_a_wound_ends_pairs(which: str, ranks: int, tmp_path: Path) -> None:
    """Of each pair one cell is removed, the other goes on without it."""
    variable = {"younger": "id > i_pair && i_pair > 0", "older": "i_pair > id"}[which]
    state = "id type i_pair d_next_division f_cells[5] x y z"
    lines = [
        "compute pair all property/atom i_pair", "run 12 post no",
        f"write_dump cells custom before.dump {state}",
        f'variable gone atom "{variable.replace("i_pair", "c_pair")}"', "group gone variable gone",
        "delete_atoms group gone", 'print "OUT $(count(gone))"', "run 0 post no",
        f"write_dump cells custom after.dump {state}", 'print "OUT $(f_cells[8])"',
        "run 30 post no",
        'print "OUT $(f_cells[10])"',
    ]  # fmt: skip
    process = run_script(tmp_path, *lines, scene=busy(), ranks=ranks)
    assert told(process)[1] == [0.0]
    (before,), (after,) = (snapshots(tmp_path / name) for name in ("before.dump", "after.dump"))
    widowed = np.isin(before["id"], after["id"]) & (before["i_pair"] > 0)
    assert widowed.sum() >= 2
    assert (after["i_pair"] == 0).all()
    assert (after["f_cells[5]"] == 0).all()
    # the pairs' ends are told in the log, once, by their IDs; a division that was due waits for it
    ends = [e for e in of_kind(read_events(tmp_path), "division_end") if e.cause != "grown"]
    pairs = [
        (max(pair), min(pair))
        for pair in zip(before["id"][widowed], before["i_pair"][widowed], strict=True)
    ]
    assert [(e.id, e.parent) for e in ends] == sorted(pairs)
    assert {e.time for e in ends} == {3.0}
    places = {tuple(row) for row in np.round(np.transpose([before[c] for c in "xyz"]), 3)}
    assert {tuple(np.round(e.x, 3)) for e in ends} <= places
    assert len(of_kind(read_events(tmp_path), "birth")) > before["id"].size - 3


@pytest.mark.parametrize(
    ("order", "ranks"), [("after", 1), ("before", 2), *slow(("after", 2), ("before", 1))]
)
def test_cells_evaporate(order: str, ranks: int, tmp_path: Path) -> None:
    """Another fix removes cells on event steps, also those of pairs and those that detach."""
    evaporate = "fix evap cells evaporate 2 1 whole 77"
    lines = ["region whole block INF INF INF INF 23 INF", evaporate]
    if order == "before":
        lines = ["unfix cells", *lines, f"fix cells cells {fix_line(busy())} log events.csv"]
    process = run_script(
        tmp_path, "run 16 post no", *lines, DUMP, "run 12 post no",
        'print "OUT $(atoms) $(count(all)) $(f_cells[4]+f_cells[5]+f_cells[6]+f_cells[7])"',
        scene=busy(), ranks=ranks,
    )  # fmt: skip
    ((atoms, counted, cells),) = told(process)
    assert atoms == counted == 672 + cells
    assert_ids_once(tmp_path / "x.dump")
    frame = snapshots(tmp_path / "x.dump")[-1]
    pairs = {(a, b) for a, b in zip(frame["id"], frame["i_pair"], strict=True) if b}
    assert pairs == {(b, a) for a, b in pairs}


def test_the_membrane_removed_names_no_timestep(tmp_path: Path) -> None:
    lines = ["run 2 post no", "delete_atoms group membrane bond yes", "run 2"]
    scene = busy()
    message = error_of(run_script(tmp_path, "group membrane type membrane", *lines, scene=scene))
    assert "has lost the membrane on step 2" in message
    assert "timestep" not in message


def test_cells_moved_by_a_command_name_no_timestep(tmp_path: Path) -> None:
    lines = ["run 2 post no", "displace_atoms cells move 0 0 -2.0", "run 2"]
    message = error_of(run_script(tmp_path, *lines, scene=busy()))
    assert "breaks through the membrane on step 2" in message
    assert "timestep" not in message


@pytest.mark.parametrize("ranks", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_state_of_added_cells_is_read(ranks: int, tmp_path: Path) -> None:
    """By read_data, from its section; without that, they are new cells."""
    z = HEIGHT + 2.4
    cells = [(Kind.STEM, (4.0, 6.0, z), 3), (Kind.TA, (8.0, 6.0, z), 2)]
    start = place(busy(), cells)
    start.next_division[-2:] = 7.5, 8.25
    columns = "id i_divisions_left d_next_division d_detached_time"
    add = "read_data skin.data add append shift 0 0"
    lines = [
        f"{add} 10 fix state NULL state", "group new id > 1346",
        f"write_dump new custom x.dump {columns} modify sort id", "run 0 post no",
        f"write_dump new custom y.dump {columns} modify sort id",
        f"{add.replace('skin', 'bare')} 20", "group newer id > 2020",
        f"write_dump newer custom z.dump {columns} modify sort id",
    ]  # fmt: skip
    build(busy(), tmp_path, start)
    text = (tmp_path / "skin.data").read_text()
    (tmp_path / "bare.data").write_text(text[: text.index("\nstate")])
    process = run_script(tmp_path, *lines, ranks=ranks)
    assert process.returncode == 0, process.stdout[-1000:]
    (read,), (kept,), (new,) = (snapshots(tmp_path / f"{name}.dump") for name in "xyz")
    for frame in (read, kept):
        assert frame["i_divisions_left"].tolist() == [3, 2]
        assert frame["d_next_division"].tolist() == [7.5, 8.25]
        assert frame["d_detached_time"].tolist() == [-1, -1]
    assert all((new[name] == 0).all() for name in columns.split()[1:])


def test_added_cells_without_the_section_that_is_named(tmp_path: Path) -> None:
    """Their state would be what atoms that are gone have left behind. A file without cells may."""
    build(busy(), tmp_path)
    text = (tmp_path / "skin.data").read_text()
    bare = text[: text.index("\nstate")]
    (tmp_path / "bare.data").write_text(bare)
    sheet = place(busy(), [])
    sheet.write_data(tmp_path / "sheet.data", busy().kinds)
    add = "add append shift 0 0 {} fix state NULL state"
    lines = [f"read_data sheet.data {add.format(10)}", f"read_data bare.data {add.format(20)}"]
    process = run_script(tmp_path, "run 2 post no", "delete_atoms group cells", *lines)
    message = error_of(process)
    assert "data file bare.data has no section state, from which read_data was to" in message


# ---- renumbering, repeating, doing it twice


def test_ids_cannot_be_given_anew(tmp_path: Path) -> None:
    lines = ["run 8 post no", "reset_atoms id"]
    message = error_of(run_script(tmp_path, *lines, scene=busy()))
    assert "Cannot use reset_atoms id with a fix skin/cells storing atom IDs" in message


def test_the_timestep_cannot_be_reset(tmp_path: Path) -> None:
    lines = ["run 8 post no", "reset_timestep 0"]
    message = error_of(run_script(tmp_path, *lines, scene=busy()))
    assert "time-dependent fix skin/cells" in message


def test_lists_without_a_skin(tmp_path: Path) -> None:
    """Built anew on each step."""
    process = run_script(
        tmp_path, "neighbor 0.0 multi", "unfix motion", "fix motion all skin/motion euler",
        "timestep 0.01", "run 100 post no", 'print "OUT $(f_cells[4]) $(f_cells[7])"',
        scene=busy(),
    )  # fmt: skip
    assert told(process) == [[2.0, 1.0]]


def test_two_fixes_are_refused(tmp_path: Path) -> None:
    lines = ["group right id 674", f"fix second right {fix_line(busy())}", "run 2"]
    message = error_of(run_script(tmp_path, *lines, scene=busy()))
    assert "Fix skin/cells can be used once" in message


def test_rerun_is_refused(tmp_path: Path) -> None:
    lines = ["dump d all custom 2 x.dump id type x y z", "run 4 post no", "undump d",
             "rerun x.dump dump x y z"]  # fmt: skip
    message = error_of(run_script(tmp_path, *lines, scene=busy()))
    assert "Fix skin/cells does not work with rerun" in message


def test_unfixing_the_state_first_is_told(tmp_path: Path) -> None:
    lines = ["run 4 post no", "unfix state", "run 4"]
    message = error_of(run_script(tmp_path, *lines, scene=busy()))
    assert "Fix skin/cells needs the per-atom property i_divisions_left" in message
    lines = ["run 4 post no", "unfix state", "unfix cells", "unfix motion", "run 0"]
    assert run_script(tmp_path, *lines).returncode == 0


# ---- groups


def test_daughters_are_in_the_groups_that_are_meant(tmp_path: Path) -> None:
    """Stem cells are held; only the group of the clone follows the lineage."""
    scene = busy()
    lines = [
        "group stems type stem", "group clone id 673", "unfix cells",
        f"fix cells cells {fix_line(scene)} inherit clone", "fix hold stems setforce 0 0 0",
        "compute way stems displace/atom", "run 36 post no",
        "compute far stems reduce max c_way[4]", "variable born equal f_cells[9]",
        "dump d clone custom 1 clone.dump id i_parent", "dump s stems custom 1 stems.dump id type",
        "run 0 post no",
        'print "OUT $(count(stems)) $(count(cells)) $(count(clone)) $(f_cells[9]) $(c_far)"',
    ]  # fmt: skip
    ((stems, cells, clone, births, far),) = told(run_script(tmp_path, *lines, scene=scene))
    assert stems == 2
    assert births >= 6
    assert cells == 3 + births
    # divisions place a mother anew by the offset, forces do not move her
    assert 0.0 < far < 0.1
    (frame,) = snapshots(tmp_path / "clone.dump")
    assert 1 < clone < cells - 1
    assert set(frame["i_parent"].tolist()) - {0.0} <= set(frame["id"].tolist())
    (frame,) = snapshots(tmp_path / "stems.dump")
    assert frame["id"].tolist() == [673, 674]


def test_daughters_that_would_not_move_are_told(tmp_path: Path) -> None:
    warning = "daughters will not be in the group mobile of fix motion"
    lines = ["unfix motion", "group mobile type membrane stem nd ta",
             "fix motion mobile skin/motion euler", "timestep 0.01", "run 0 post no"]  # fmt: skip
    assert warning in run_script(tmp_path, *lines, scene=busy()).stdout
    lines[-1:] = ["unfix cells", f"fix cells cells {fix_line(busy())} inherit mobile",
                  "group stems type stem", "fix push stems addforce 0 0 0", "run 0"]  # fmt: skip
    assert "daughters will not" not in run_script(tmp_path, *lines).stdout


def test_inherit_needs_a_group(tmp_path: Path) -> None:
    lines = ["unfix cells", f"fix cells cells {fix_line(busy())} inherit nobody"]
    message = error_of(run_script(tmp_path, *lines, scene=busy()))
    assert "Fix skin/cells inherit = nobody: there is no such group" in message
