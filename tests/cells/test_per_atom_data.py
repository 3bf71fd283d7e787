"""Per-atom data beside other commands: the array of fix skin/cells, and what newborns inherit."""

from pathlib import Path

import numpy as np
import pytest
from lammps_skin.start.build import build

from tests.cells.conftest import of_kind, read_events
from tests.cells.scripts import busy, run_script, snapshots, told

COLUMNS = "id type i_divisions_left i_parent i_pair " + " ".join(
    f"f_cells[{n}]" for n in range(1, 9)
)
# what each column of the array repeats of the state
REPEATED = {"f_cells[2]": "i_divisions_left", "f_cells[4]": "i_parent", "f_cells[5]": "i_pair"}
CELL_TYPES = (2, 3, 4, 5)  # without a dermis


def write(name: str) -> str:
    return f"write_dump all custom {name} {COLUMNS} modify sort id format float %.17g"


# ---- the array


COMMANDS = {
    "delete-region": ["region r block INF 6 INF INF INF INF", "group left region r",
                      "group gone intersect left cells", "delete_atoms group gone"],
    "delete-random": ["delete_atoms random fraction 0.4 no cells NULL 7"],
    "balance": ["comm_style tiled", "balance 1.0 rcb"],
    "sort": ["atom_modify sort 1 3.0", "run 1 post no"],
    "create": ["create_atoms nd random 4000 11 NULL"],
    "read-dump": ["write_dump all custom copy.dump id type x y z", "displace_atoms all move 5 3 0",
                  "read_dump copy.dump 24 x y z box no timestep no"],
    "add": ["write_dump all custom copy.dump id type x y z", "delete_atoms group cells",
            "read_dump copy.dump 24 x y z box no add keep timestep no"],
    "box": ["change_box all x scale 1.01 remap"],
}  # fmt: skip
QUICK_ON_TWO = ("delete-region", "balance", "add")


@pytest.mark.parametrize(
    ("name", "ranks"),
    [
        *((name, 1) for name in COMMANDS),
        *(pytest.param(name, 2, marks=() if name in QUICK_ON_TWO else pytest.mark.slow)
          for name in COMMANDS),
    ],
)  # fmt: skip
def test_rows_stay_with_their_atoms(name: str, ranks: int, tmp_path: Path) -> None:
    """Right after a command each atom has its row of before, or zeros if it is new."""
    commands = COMMANDS[name]
    # of the next step, if there is one
    again = ["run 0 post no", write("before.dump")] if "run 1 post no" in commands else []
    lines = ["run 24 post no", write("before.dump"), *commands, *again, write("after.dump")]
    process = run_script(tmp_path, *lines, scene=busy(), ranks=ranks)
    assert process.returncode == 0, process.stdout[-1000:]
    (before,), (after,) = (snapshots(tmp_path / file) for file in ("before.dump", "after.dump"))
    kept = np.isin(after["id"], before["id"]) & (
        after["i_divisions_left"] + after["f_cells[6]"] > 0
    )
    cells = np.isin(before["type"], CELL_TYPES)
    assert cells.sum() >= 6
    assert (before["f_cells[7]"][cells] > 1.0).all()
    for n in range(1, 9):
        column = f"f_cells[{n}]"
        old = dict(zip(before["id"], before[column], strict=True))
        expected = [old[cell] for cell in after["id"][kept]]
        assert after[column][kept].tolist() == expected
        assert (after[column][~np.isin(after["id"], before["id"])] == 0.0).all()
    assert kept.any() or "group cells" in " ".join(commands)


def test_array_is_zero_before_it_is_computed(tmp_path: Path) -> None:
    lines = [
        'variable near atom "f_cells[7] < 2.5"', "group near variable near",
        'print "OUT $(count(near)) $(count(all))"', write("first.dump"),
        "create_atoms nd random 3000 123 NULL", write("second.dump"),
    ]  # fmt: skip
    ((near, total),) = told(run_script(tmp_path, *lines, scene=busy()))
    assert near == total == 675
    for name in ("first.dump", "second.dump"):
        (frame,) = snapshots(tmp_path / name)
        assert all((frame[f"f_cells[{n}]"] == 0.0).all() for n in range(1, 9))
    assert len(frame["id"]) == 3675


def test_rows_of_what_is_no_cell_any_more_are_zero(tmp_path: Path) -> None:
    lines = ["run 0 post no", "set atom 675 type membrane", "run 0 post no", write("set.dump")]
    assert run_script(tmp_path, *lines, scene=busy()).returncode == 0
    (frame,) = snapshots(tmp_path / "set.dump")
    assert [frame[f"f_cells[{n}]"][674] for n in range(1, 9)] == [0.0] * 8
    assert frame["f_cells[7]"][673] > 1.0


# ---- newborns

CLONE = [
    "fix clone all property/atom i_clone d_dose d2_vector 3 q rmass",
    "variable id atom id", "variable dose atom id*0.5", "variable mass atom 1.0+id*0.001",
    "set group all i_clone v_id", "set group all d_dose v_dose", "set group all mol 7",
    "set group cells d2_vector[2] v_dose", "set group all charge 0.25",
    "set atom 674 mol 9", "velocity all set 0.5 0.25 0.0",
    "set atom 673 image 1 0 0", "set atom 674 image -2 3 0",
    "fix kept all store/state 0 xu yu zu",
]  # fmt: skip


@pytest.mark.parametrize("ranks", [1, *(pytest.param(n, marks=pytest.mark.slow) for n in (2, 4))])
def test_newborn_is_a_copy_of_its_mother(ranks: int, tmp_path: Path) -> None:
    """In the data of other fixes and of the atom style, on any number of ranks."""
    columns = (
        "id type x y z xu yu i_clone d_dose d2_vector[2] mol q vx vy ix iy i_parent "
        "f_kept[1] f_kept[2]"
    )
    lines = [
        *CLONE, f"dump all cells custom 1 x.dump {columns}", "dump_modify all format float %.17g",
        "run 36 post no",
    ]  # fmt: skip
    process = run_script(tmp_path, *lines, scene=busy(), ranks=ranks)
    assert process.returncode == 0, process.stdout[-1000:]
    seen: dict[int, dict[str, float]] = {}
    for frame in snapshots(tmp_path / "x.dump"):
        for row in zip(*frame.values(), strict=True):
            cell = dict(zip(frame, row, strict=True))
            seen.setdefault(int(cell["id"]), cell)
            parent = seen[int(cell["id"])]["i_parent"]
            if cell["id"] <= 675:
                assert (cell["i_clone"], cell["d_dose"]) == (cell["id"], cell["id"] / 2)
                continue
            mother = seen[int(parent)]
            for name in ("i_clone", "d_dose", "d2_vector[2]", "mol", "q", "vx", "vy"):
                assert cell[name] == mother[name], name
            for name in ("f_kept[1]", "f_kept[2]"):
                assert cell[name] == mother[name], name
    born = {cell: row for cell, row in seen.items() if cell > 675}
    assert len(born) >= 8
    assert {row["i_clone"] for row in born.values()} == {673, 674}
    # in the same image of the box, through whatever edge: they begin at one place
    frames = snapshots(tmp_path / "x.dump")
    checked = 0
    for frame in frames:
        rows = {
            int(row[0]): dict(zip(frame, row, strict=True))
            for row in zip(*frame.values(), strict=True)
        }
        for cell in rows:
            if cell in born and rows[cell] == born[cell] and int(born[cell]["i_parent"]) in rows:
                mother = rows[int(born[cell]["i_parent"])]
                assert abs(rows[cell]["xu"] - mother["xu"]) < 0.5
                assert abs(rows[cell]["yu"] - mother["yu"]) < 0.5
                checked += 1
    assert checked >= 8


@pytest.mark.parametrize("many", [2, pytest.param(4, marks=pytest.mark.slow)])
def test_newborn_does_not_depend_on_ranks(many: int, tmp_path: Path) -> None:
    """Also where the daughter begins beyond the edge of the mother's subdomain."""
    frames = []
    for ranks in (1, many):
        columns = "id type mol ix iy i_clone d_dose i_parent i_pair"
        lines = [
            *CLONE,
            "run 24 post no",
            f"write_dump cells custom x.dump {columns} modify sort id",
        ]
        directory = tmp_path / str(ranks)
        # the stem cells divide at edges of subdomains: in the middle, and at the edge of the box
        moved = [
            "set atom 673 x 6.0 y 6.0", "set atom 674 x 0.0 y 6.0", "set atom 675 x 9.0 y 2.0",
        ]  # fmt: skip
        process = run_script(directory, *moved, *lines, scene=busy(), ranks=ranks)
        assert process.returncode == 0, process.stdout[-1000:]
        frames.append((directory / "x.dump").read_text())
    assert frames[0] == frames[1]
    assert frames[0].count("\n") > 15


def test_bonds_stay_with_the_mother(tmp_path: Path) -> None:
    """A mother that is anchored by a bond divides; her daughter has none."""
    scene = busy()
    lines = [
        "bond_style hybrid skin/stretch harmonic",
        "bond_coeff 1 skin/stretch 0.04 2.0 1.25 0.25 1.0",
        "bond_coeff 2 harmonic 5.0 2.4", "compute near cells property/atom nbonds",
        "create_bonds single/bond 2 673 340 special yes", "run 20 post no",
        "compute bonds all property/local batom1 batom2 btype",
        "dump b all local 1 b.dump c_bonds[1] c_bonds[2] c_bonds[3]", "run 0 post no",
    ]  # fmt: skip

    build(scene, tmp_path)
    state = (tmp_path / "state.in").read_text()
    extra = "extra/bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4"
    state = state.replace("fix state NULL state", f"fix state NULL state {extra}")
    (tmp_path / "state.in").write_text(state)
    process = run_script(tmp_path, *lines)
    assert process.returncode == 0, process.stdout[-1000:]
    rows = (tmp_path / "b.dump").read_text().split("ITEM: ENTRIES")[1].splitlines()[1:]
    bonds = [tuple(map(int, row.split())) for row in rows]
    assert [sorted(bond[:2]) for bond in bonds if bond[2] == 2] == [[340, 673]]
    assert len(of_kind(read_events(tmp_path), "birth")) >= 2
