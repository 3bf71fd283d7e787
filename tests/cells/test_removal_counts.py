"""All counts of a run with many births and removals agree."""

from collections import Counter
from pathlib import Path

import pytest
from lammps_skin.engine.engine import Cells
from lammps_skin.run.simulation import Simulation
from lammps_skin.trajectory.dump import write_dump
from lammps_skin.trajectory.store import Store

from tests.cells.conftest import (
    Event,
    busy_scene,
    crowd,
    frames,
    of_kind,
    read_events,
    thermo,
)

MEMBRANE, FOUNDERS = 24 * 28, 25
FIRST_BORN = MEMBRANE + FOUNDERS + 1


@pytest.fixture(
    scope="module", params=[1, pytest.param(2, marks=pytest.mark.slow)],
    ids=["one-rank", "two-ranks"],
)  # fmt: skip
def crowded_run(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Cells]:
    """Directory and last cells of a run with many births and deaths."""
    directory = tmp_path_factory.mktemp("crowded")
    scene = busy_scene(**{"output.dump_interval": 1.0, "output.thermo_interval": 0.2})
    configuration = crowd(scene, across=5, amplitude=0.5, above=2.2)
    with Simulation.begin(scene, directory, configuration, request.param) as simulation:
        simulation.run(until=30.0)
        write_dump(directory / "skin.dump", Store(directory / "skin.h5"), scene.kinds)
        return directory, simulation.cells()


def test_all_counts_agree_at_all_times(crowded_run: tuple[Path, Cells]) -> None:
    directory, _ = crowded_run
    events = read_events(directory)
    rows = {row["Time"]: row for row in thermo(directory)}
    total = {kind: len(of_kind(events, kind)) for kind in ("birth", "death")}
    assert total["birth"] > 60
    assert total["death"] > 40
    assert len(rows) == 151

    for time, row in rows.items():
        births, deaths = row["f_cells[9]"], row["f_cells[10]"]
        alive = sum(row[f"f_cells[{n}]"] for n in (4, 5, 6, 7))
        assert FOUNDERS + births - deaths == alive == row["Atoms"] - MEMBRANE
        assert births == sum(e.time <= time for e in of_kind(events, "birth"))
        assert deaths == len(gone(events, time)) or deaths == len(gone(events, time, leaving=True))
    assert len({(row["f_cells[4]"], row["f_cells[7]"]) for row in rows.values()}) == 1


def test_dump_holds_the_living(crowded_run: tuple[Path, Cells]) -> None:
    directory, last = crowded_run
    events = read_events(directory)
    rows = {row["Time"]: row for row in thermo(directory)}
    dumped = frames(directory)
    assert len(dumped) == 31
    for time, ids, types, _ in dumped:
        ever = set(range(1, FIRST_BORN)) | {
            e.id for e in of_kind(events, "birth") if e.time <= time
        }
        assert ever - gone(events, time, leaving=True) <= set(ids) <= ever - gone(events, time)
        assert ids == sorted(ids)
        assert len(ids) == rows[time]["Atoms"]
        numbers = Counter(types)
        for type_, column in enumerate((4, 5, 6, 7), 2):
            assert numbers[type_] == rows[time][f"f_cells[{column}]"]
    assert dumped[-1][1][MEMBRANE:] == last.ids.tolist()


def gone(events: list[Event], time: float, leaving: bool = False) -> set[int]:
    """Cells removed before a time, or also those found detached at this very moment."""
    deaths = of_kind(events, "death")
    return {e.id for e in deaths if e.time < time or (leaving and e.time == time)}


def test_log_is_in_the_order_of_times(crowded_run: tuple[Path, Cells]) -> None:
    times = [event.time for event in read_events(crowded_run[0])]
    assert times == sorted(times)


def test_ids_are_never_used_twice(crowded_run: tuple[Path, Cells]) -> None:
    directory, last = crowded_run
    events = read_events(directory)
    born = [e.id for e in of_kind(events, "birth")]
    dead = [e.id for e in of_kind(events, "death")]
    assert sorted(born) == list(range(FIRST_BORN, FIRST_BORN + len(born)))
    assert len(set(dead)) == len(dead)
    ever = set(range(MEMBRANE + 1, FIRST_BORN)) | set(born)
    assert set(last.ids) == ever - set(dead)


def test_pairs_begin_and_end_once(crowded_run: tuple[Path, Cells]) -> None:
    directory, last = crowded_run
    events = read_events(directory)
    ended = [e.id for e in of_kind(events, "division_end")]
    assert len(set(ended)) == len(ended)
    growing = {e.id for e in of_kind(events, "birth")} - set(ended)
    in_pairs = dict(zip(last.ids.tolist(), last.pair.tolist(), strict=True))
    assert growing == {max(cell, other) for cell, other in in_pairs.items() if other}
    assert all(in_pairs[other] == cell for cell, other in in_pairs.items() if other)
    assert {e.cause for e in of_kind(events, "division_end")} == {"grown", "partner_removed"}
