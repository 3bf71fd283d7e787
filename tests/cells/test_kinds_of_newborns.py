"""What mothers and newborns become follows from the table of kinds, whatever it says."""

from pathlib import Path

import pytest
from lammps_skin.run.simulation import Simulation

from tests.cells.conftest import of_kind, read_events
from tests.cells.scripts import busy

# name: number, daughter, generations (None: endless), kind after the last
TABLE = {
    "stem": (3, "passing", None, None),
    "passing": (7, "passing", 0, "amp"),  # entered and left at once
    "amp": (8, "amp", 2, "late"),
    "clone": (9, "clone", None, None),
    "late": (10, "clone", 2, "old"),  # divides as another kind after its last division
    "old": (11, None, None, None),
}


def scene(**changes: object):
    kinds = {}
    for name, (_, daughter, generations, last) in TABLE.items():
        row = {"daughter": daughter or "none", "adhesion": "bound", "stiffness": 25.0}
        if daughter:
            row["generations"] = "endless" if generations is None else generations
        kinds[name] = row | ({"after_last": last} if last else {})
    changes = {"cells.kinds": kinds, "end_time": 14.0, "cells.seed": 5, **changes}
    return busy(**changes)


def enter(name: str) -> tuple[str, int]:
    """Kind and divisions left of a cell that becomes one of a kind."""
    while TABLE[name][2] == 0:
        name = TABLE[name][3]
    return name, TABLE[name][2] or 0


def divide(name: str, left: int) -> tuple[tuple[str, int], tuple[str, int]]:
    """The mother after her division, and her newborn."""
    _, daughter, generations, last = TABLE[name]
    mother = (name, left)
    if generations is not None:
        mother = (name, left - 1) if left > 1 else enter(last)
    same = generations is not None and daughter == name
    return mother, mother if same else enter(daughter)


def test_lineages_follow_the_table(tmp_path: Path) -> None:
    """On one rank and on two, with the same log."""
    logs = []
    for ranks in (1, 2):
        with Simulation.begin(scene(), tmp_path / str(ranks), ranks=ranks) as simulation:
            simulation.run()
            cells = simulation.cells()
        logs.append((tmp_path / str(ranks) / "events.csv").read_bytes())
    assert logs[0] == logs[1]
    cell = {673: ("stem", 0), 674: ("stem", 0)}
    names = {number: name for name, (number, *_) in TABLE.items()}
    births = of_kind(read_events(tmp_path / "1"), "birth")
    for birth in births:
        cell[birth.parent], cell[birth.id] = divide(*cell[birth.parent])
        assert (names[birth.type], birth.divisions_left) == cell[birth.id]
    assert {names[birth.type] for birth in births} == {"amp", "late", "clone"}
    now = dict(zip(cells.ids.tolist(), cells.types.tolist(), strict=True))
    assert {id_: names[now[id_]] for id_ in cell} == {id_: name for id_, (name, _) in cell.items()}
    rests = cells.types == TABLE["old"][0]
    assert rests.any()
    assert (cells.next_division[rests] < 0).all()
    divides = ~rests & (cells.types != 6)
    assert (cells.next_division[divides] > 0).all()


def test_ta_cells_without_end(tmp_path: Path) -> None:
    changes = {"cells.generations": "endless", "end_time": 10.0}
    with Simulation.begin(busy(**changes), tmp_path) as simulation:
        simulation.run()
    births = of_kind(read_events(tmp_path), "birth")
    assert len(births) > 10
    assert {(birth.type, birth.divisions_left) for birth in births} == {(4, 0)}


def test_slow_cells_wait_longer(tmp_path: Path) -> None:
    """A cycle of its own: the same random numbers, stretched."""
    times = []
    for factor in (1.0, 3.0):
        row = {"cycle_delay": 2.0 * factor, "cycle_rate": 0.5 / factor, "first_phase": 0.0}
        changes = {"cells.kinds": {"stem": row}}
        with Simulation.begin(busy(**changes)) as simulation:
            cells = simulation.cells()
        times.append(cells.next_division[cells.types == 3])
    assert times[1] == pytest.approx(3 * times[0], rel=1e-12)
