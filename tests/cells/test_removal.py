"""Removal of detached TA cells, what it does to pairs, and the balance of all counts."""

import math
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.model.terms import Terms
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import (
    CONTACT,
    FREEZE,
    HEIGHT,
    TIME_DIGITS,
    membrane_scene,
    of_kind,
    place,
    read_events,
)
from tests.cells.scripts import busy, run_script, told

# ---- who leaves


@pytest.mark.parametrize(
    ("lam", "ranks"), [(1.2, 1), pytest.param(1.4, 1, marks=pytest.mark.slow), (1.4, 2)]
)
def test_ta_cells_beyond_the_threshold_leave(lam: float, ranks: int, tmp_path: Path) -> None:
    """Cells of all kinds a little nearer and a little further than the threshold."""
    scene = membrane_scene(
        **{"cells.adhesion_range": lam, "numerics.event_interval": 0.0, "numerics.timestep": 0.01}
    )
    threshold, little = lam * CONTACT, 1e-7
    distances = [threshold - little, threshold + little, 0.9 * CONTACT, 1.5 * CONTACT]
    left = {Kind.STEM: 10, Kind.TA: 2, Kind.EXHAUSTED: 0, Kind.ND: 0}
    spots = iter(spots_above_particles(scene, 4))
    cells = [
        (kind, (x, y, HEIGHT + distance), left[kind]) for kind in left for distance in distances
        for x, y in [next(spots)]
    ]  # fmt: skip
    configuration = place(scene, cells)
    configuration.next_division[configuration.is_cell] = 1e9
    staying = [
        672 + n
        for n, (kind, place_, _) in enumerate(cells, 1)
        if kind in (Kind.STEM, Kind.ND) or place_[2] - HEIGHT < threshold
    ]
    with Simulation.begin(scene, tmp_path, configuration, ranks) as simulation:
        simulation.command(FREEZE)
        assert len(simulation.cells().ids) == 16
        simulation.run(until=0.05)
        assert simulation.cells().ids.tolist() == staying
    deaths = read_events(tmp_path)
    assert sorted(e.id for e in deaths) == sorted(set(range(673, 689)) - set(staying))
    assert {(e.kind, e.cause, e.time) for e in deaths} == {("death", "detached", 0.0)}
    for event in deaths:
        kind, position, m = cells[event.id - 673]
        assert (event.type, event.divisions_left) == (kind, m)
        assert event.x == pytest.approx(position, abs=1e-8)


def spots_above_particles(scene: Scene, across: int) -> np.ndarray:
    """Places (across^2, 2) of membrane particles, some of them on the periodic edges."""
    nx, ny = scene.membrane.lattice
    columns, rows = np.indices((across, across)).reshape(2, -1)
    height = scene.spacing * np.sqrt(3) / 2
    # rows of even number: these are not shifted
    return np.column_stack(
        [columns * (nx // across) * scene.spacing, rows * (ny // across // 2 * 2) * height]
    )


def test_the_distance_is_taken_through_the_edge(tmp_path: Path) -> None:
    """Only a membrane particle beyond the periodic edges holds the cell in a corner."""
    scene = membrane_scene(**{"numerics.event_interval": 0.0})
    corner = (scene.box_sides[0] - 0.02, scene.box_sides[1] - 0.02, HEIGHT + 1.19 * CONTACT)
    configuration = place(scene, [(Kind.EXHAUSTED, corner, 0)])
    inside_the_box = np.linalg.norm(configuration.positions[:-1] - corner, axis=1).min()
    assert inside_the_box > 1.2 * CONTACT
    with Simulation.begin(scene, tmp_path, configuration) as simulation:
        simulation.command(FREEZE)
        simulation.run(until=0.1)
        assert len(simulation.cells().ids) == 1


# ---- pairs


def pair_of(scene: Scene, kinds: tuple[Kind, Kind], heights: tuple[float, float]) -> Configuration:
    """A pair half grown across the borders of ranks, and a third cell beside it."""
    x, y = 5.5, 5.6
    left = {Kind.STEM: 10, Kind.TA: 2, Kind.EXHAUSTED: 0}
    cells = [
        (kinds[0], (x, y, HEIGHT + heights[0]), left[kinds[0]]),
        (kinds[1], (x + 1.0, y + 1.0, HEIGHT + heights[1]), left[kinds[1]]),
        (Kind.ND, (x - 2.5, y, HEIGHT + CONTACT), 0),
    ]
    configuration = place(scene, cells)
    first, second = 673, 674
    configuration.pair[[-3, -2]] = second, first
    configuration.parent[-2] = first
    configuration.pair_start[[-3, -2]] = -9.9
    configuration.birth_time[-2] = -9.9
    configuration.next_division[[-3, -2]] = 3.0 * (np.array(kinds) != Kind.EXHAUSTED) - 1
    return configuration


FAR, NEAR = 1.3 * CONTACT, 1.05 * CONTACT


@pytest.mark.parametrize(
    ("kinds", "heights", "ranks"),
    [
        ((Kind.TA, Kind.TA), (FAR, NEAR), 1),
        pytest.param((Kind.TA, Kind.TA), (FAR, NEAR), 2, marks=pytest.mark.slow),
        ((Kind.TA, Kind.TA), (NEAR, FAR), 1),
        ((Kind.TA, Kind.TA), (FAR, FAR), 1),
        ((Kind.TA, Kind.TA), (FAR, FAR), 2),
        ((Kind.STEM, Kind.TA), (NEAR, FAR), 1),
        pytest.param((Kind.STEM, Kind.TA), (NEAR, FAR), 2, marks=pytest.mark.slow),
        ((Kind.EXHAUSTED, Kind.EXHAUSTED), (NEAR, FAR), 1),
    ],
    ids=[
        "mother", "mother-2", "daughter", "both", "both-2", "daughter-of-stem",
        "daughter-of-stem-2", "exhausted",
    ],
)  # fmt: skip
def test_death_of_one_ends_the_pair(
    kinds: tuple[Kind, Kind], heights: tuple[float, float], ranks: int, tmp_path: Path
) -> None:
    scene = membrane_scene(
        **{"numerics.timestep": 0.05, "numerics.event_interval": 0.1, "cells.cycle_delay": 1e6}
    )
    dead = [673 + n for n, height in enumerate(heights) if height == FAR]
    survivors = sorted({673, 674} - set(dead))
    with Simulation.begin(scene, tmp_path, pair_of(scene, kinds, heights), ranks) as simulation:
        simulation.command(FREEZE)
        assert simulation.cells().pair.tolist() == [674, 673, 0]
        assert simulation.energies()["division"] > 0
        simulation.run(until=0.1)
        cells, energies = simulation.cells(), simulation.energies()
        assert cells.ids.tolist() == [*survivors, 675]
        assert not cells.pair.any()
        assert energies["division"] == 0
        simulation.run(until=2.5)

    events = read_events(tmp_path)
    log = [(e.kind, e.id, e.parent, e.cause) for e in events]
    parent = {673: 0, 674: 673}
    deaths = [("death", cell, parent[cell], "detached") for cell in dead]
    end = ("division_end", 674, 673, "partner_removed")
    assert sorted(log[: len(dead) + 1]) == [*deaths, end]
    assert {event.time for event in events[: len(dead) + 1]} == {0.0}
    # the survivor divides when its time has come, at t = 2
    dividing = [cell for cell in survivors if kinds[cell - 673] != Kind.EXHAUSTED]
    born = [(e.time, e.kind, e.parent) for e in events[len(dead) + 1 :]]
    assert born == [(pytest.approx(2.0, rel=TIME_DIGITS), "birth", cell) for cell in dividing]


# ---- when


def rise(simulation: Simulation, cell: int) -> None:
    """Let one cell go up at unit speed and hold all others."""
    simulation.command(FREEZE)
    simulation.command(f"group rising id {cell}")
    simulation.command("fix rise rising setforce 0 0 1")


@pytest.mark.parametrize(("crossing", "found", "leaving"), [(0.11, 0.12, 0.2), (0.19, 0.2, 0.4)])
@pytest.mark.parametrize("other_division", [0.15, 1e6])
def test_removal_does_not_wait_for_others(
    other_division: float, crossing: float, found: float, leaving: float, tmp_path: Path
) -> None:
    """A cell leaves when it would leave if no other cell had an event at that time."""
    scene = membrane_scene(**{"numerics.timestep": 0.02, "numerics.event_interval": 0.2})
    x, y, _ = place(scene, []).positions[0]
    above = 1.2 * CONTACT - crossing
    cells = [(Kind.EXHAUSTED, (x, y, HEIGHT + above), 0), (Kind.STEM, (6, 6, HEIGHT + CONTACT), 10)]
    configuration = place(scene, cells)
    configuration.next_division[-1] = other_division
    left: list[float] = []

    def watch(time: float, simulation: Simulation) -> None:
        if 673 not in simulation.cells().ids:
            left.append(time)

    with Simulation.begin(scene, tmp_path, configuration) as simulation:
        rise(simulation, 673)
        simulation.run(until=0.6, progress=watch, every=0.02)
    assert left[0] == pytest.approx(leaving)
    assert [e.time for e in of_kind(read_events(tmp_path), "death")] == [pytest.approx(found)]


@pytest.mark.parametrize("dying", [673, 674])
@pytest.mark.parametrize("grown", [0.05, 0.15, 9.0])
def test_what_comes_first_ends_the_pair(grown: float, dying: int, tmp_path: Path) -> None:
    """The pair grows up and one of it detaches between two steps that handle events.

    Where it does not grow up, the other one divides when the pair ends: it should have done before.
    """
    scene = membrane_scene(**{"numerics.timestep": 0.02, "numerics.event_interval": 0.2})
    _, start, rate, end = Terms.of(scene).division
    crossing, found = 0.09, 0.1
    heights = [1.2 * CONTACT - crossing if cell == dying else NEAR for cell in (673, 674)]
    row = place(scene, []).positions[:6:5]
    cells = [(Kind.TA, (x, y, HEIGHT + z), 1) for (x, y, _), z in zip(row, heights, strict=True)]
    configuration = place(scene, cells)
    configuration.pair[-2:] = 674, 673
    configuration.pair_start[-2:] = grown - (end - start) / rate
    configuration.next_division[-2:] = 0.01 if grown > 1 else 1e6
    with Simulation.begin(scene, tmp_path, configuration) as simulation:
        rise(simulation, dying)
        simulation.run(until=0.5)
    death, ended = (found, "death", dying), min((grown, "grown"), (found, "partner_removed"))
    log = [(e.time, e.kind, e.id) for e in read_events(tmp_path)]
    causes = [e.cause for e in of_kind(read_events(tmp_path), "division_end")]
    assert causes == [ended[1]]
    expected = sorted([death, (ended[0], "division_end", 674)])
    expected += [(ended[0], "birth", 675)] * (grown > 1)
    assert log == [(pytest.approx(time), kind, id_) for time, kind, id_ in expected]


# ---- what has left


def test_the_id_of_the_dead_is_not_given_again(tmp_path: Path) -> None:
    """The highest id dies first, then a stem cell divides, in a run of its own."""
    scene = membrane_scene(**{"numerics.event_interval": 0.0})
    x, y = 6.0, 7 * np.sqrt(3) / 2
    cells = [
        (Kind.STEM, (x, y, HEIGHT + CONTACT), 10),
        (Kind.EXHAUSTED, (x - 5, y, HEIGHT + FAR), 0),
    ]
    configuration = place(scene, cells)
    configuration.next_division[-2] = 1.0
    with Simulation.begin(scene, tmp_path, configuration) as simulation:
        simulation.run(until=0.5)
        assert simulation.cells().ids.tolist() == [673]
        simulation.command("run 0")
        simulation.run(until=1.5)
        assert simulation.cells().ids.tolist() == [673, 675]
    assert [(e.kind, e.id) for e in read_events(tmp_path)] == [("death", 674), ("birth", 675)]


def test_what_a_rejected_step_has_seen_did_not_happen(tmp_path: Path) -> None:
    """A cell on a stiff tether overshoots its reach in a step that is then divided.

    For the tether's stiffness times the timestep the first of five stages takes the cell from 0.05
    below to 0.135 above its rest, beyond the reach; the later ones move it too far. Half steps are
    stable, and stay within 0.05.
    """
    scene = busy(**{"cells.stem": 1, "cells.nd": 0})
    spot = (6.0, 7 * math.sqrt(3) / 2)
    start = place(scene, [(Kind.EXHAUSTED, (*spot, HEIGHT + 2.8), 0)])
    lines = [
        "group membrane type membrane", "fix hold membrane setforce 0 0 0",
        "fix tether cells spring/self 222", "displace_atoms cells move 0 0 -0.05", "unfix motion",
        "fix motion all skin/motion rkl1 stages 5 move 0.2",
        "run 8 post no", 'print "OUT $(f_motion[1]) $(f_cells[10]) $(f_cells[6])"',
    ]  # fmt: skip
    ((divided, deaths, exhausted),) = told(run_script(tmp_path, *lines, scene=scene, start=start))
    assert divided > 0
    assert (deaths, exhausted) == (0, 1)


@pytest.mark.parametrize(
    ("form", "ranks"),
    [("analytic", 1), ("skin", 1), ("skin", 2),
     pytest.param("analytic", 2, marks=pytest.mark.slow)],
)  # fmt: skip
def test_what_has_left_acts_on_no_other(form: str, ranks: int, tmp_path: Path) -> None:
    """Until the event step that removes it: neither on a cell that it overlaps nor on its pair."""
    scene = membrane_scene(
        **{"numerics.timestep": 0.02, "numerics.event_interval": 1.0, "numerics.pair_form": form}
    )
    x, y = 6.0, 7 * math.sqrt(3) / 2
    leaving = [
        (Kind.EXHAUSTED, (x, y, HEIGHT + 1.5 * CONTACT), 0),
        (Kind.EXHAUSTED, (x + 1, y, HEIGHT + 1.7 * CONTACT), 0),
        (Kind.TA, (0.05, y, HEIGHT + FAR), 1),
    ]
    staying = [(Kind.TA, (x, y, HEIGHT + NEAR), 1), (Kind.TA, (0.5, y + 1, HEIGHT + NEAR), 1)]
    found = []
    for number, cells in enumerate((staying, [*staying, *leaving])):
        configuration = place(scene, cells)
        configuration.next_division[configuration.is_cell] = 1e9
        if number:
            configuration.pair[[-4, -1]] = [677, 674]
            configuration.pair_start[[-4, -1]] = 0.0
        directory = tmp_path / str(number)
        with Simulation.begin(
            scene, directory, configuration, ranks if number else 1
        ) as simulation:
            simulation.command("group membrane type membrane")
            simulation.command("fix hold membrane setforce 0 0 0")
            at_first = simulation.forces().forces[-len(cells):]
            simulation.run(until=0.5)
            found.append(simulation.forces())
            assert len(simulation.cells().ids) == len(cells)
        if number:
            assert np.linalg.norm(at_first, axis=1).min() > 0.01
    alone, crowd_ = found
    np.testing.assert_allclose(crowd_.forces[-3:], 0.0, atol=1e-15)
    np.testing.assert_allclose(crowd_.positions[:-3], alone.positions, atol=0.02)
