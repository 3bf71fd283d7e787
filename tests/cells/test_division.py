"""Division: schedules, generations, directions, and the growing pair."""

import math
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.engine.engine import Cells
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from scipy import stats

from tests.cells.conftest import (
    CONTACT,
    FREEZE,
    HALF_SEPARATION,
    HEIGHT,
    ORIENTATION,
    TIME_DIGITS,
    Event,
    check_told,
    first_division,
    grid,
    membrane_scene,
    of_kind,
    place,
    read_events,
    told_events,
    uniform,
    wave,
)

SEED = 7
GENERATIONS = 3
STEM = 25
UNLIKELY = 1e-3  # p of a statistical test below which its hypothesis is given up


# ---- a colony in which nothing moves, so that every division can be looked at


@dataclass
class Colony:
    """A finished run: its events, and the pairs as they were right after their birth."""

    scene: Scene
    events: list[Event] = field(default_factory=list)
    first: dict[int, float] = field(default_factory=dict)
    last: Cells | None = None
    directions: dict[int, np.ndarray] = field(default_factory=dict)
    normals: dict[int, np.ndarray] = field(default_factory=dict)
    separations: dict[int, float] = field(default_factory=dict)
    shifts: dict[int, float] = field(default_factory=dict)

    def watch(self, simulation: Simulation, before: Cells) -> Cells:
        """Note the pairs born since `before`."""
        cells = simulation.cells()
        born = np.flatnonzero(~np.isin(cells.ids, before.ids))
        if len(born):
            membrane = simulation.forces().positions
        for n in born:
            mother = np.searchsorted(cells.ids, cells.parent[n])
            half = self._across(cells.positions[n] - cells.positions[mother]) / 2
            middle = cells.positions[mother] + half
            old = before.positions[np.searchsorted(before.ids, cells.parent[n])]
            partner = before.partner[np.searchsorted(before.ids, cells.parent[n])]
            normal = self._across(old - membrane[partner - 1])
            id_ = int(cells.ids[n])
            self.separations[id_] = float(np.linalg.norm(half))
            self.directions[id_] = half / np.linalg.norm(half)
            self.normals[id_] = normal / np.linalg.norm(normal)
            self.shifts[id_] = float(np.linalg.norm(self._across(middle - old)))
        return cells

    def _across(self, delta: np.ndarray) -> np.ndarray:
        """The least periodic image of a difference of places."""
        sides = np.array([*self.scene.box_sides[:2], np.inf])
        return delta - np.where(np.isfinite(sides), sides, 0) * np.round(delta / sides)


@pytest.fixture(scope="module")
def colony(tmp_path_factory: pytest.TempPathFactory) -> Colony:
    """Stem cells on a waving membrane, held where they are, for many cell cycles."""
    scene = membrane_scene(
        (40, 46),
        **{
            "cells.generations": GENERATIONS, "cells.seed": SEED, "cells.adhesion_range": 1.5,
            "numerics.timestep": 2.0, "numerics.event_interval": 2.0,
        }
    )  # fmt: skip
    flat = grid(scene, 5, jitter=0.3)
    heights = HEIGHT + 0.8 * CONTACT + wave(scene, flat, 3.5)
    cells = [(Kind.STEM, (*xy, z), GENERATIONS) for xy, z in zip(flat, heights, strict=True)]
    directory = tmp_path_factory.mktemp("colony")
    record = Colony(scene)
    configuration = place(scene, cells, amplitude=3.5)
    with Simulation.begin(scene, directory, configuration) as simulation:
        before = simulation.cells()
        record.first = dict(zip(before.ids.tolist(), before.next_division.tolist(), strict=True))
        simulation.command(FREEZE)
        simulation.command("neigh_modify exclude group cells cells")

        def watch(_time: float, simulation: Simulation) -> None:
            nonlocal before
            before = record.watch(simulation, before)

        simulation.run(until=600.0, progress=watch, every=2.0)
        record.last = before
    record.events = read_events(directory)
    return record


def test_events_are_those_told_by_the_seed(colony: Colony) -> None:
    founders = {cell: first_division(colony.scene, SEED, cell) for cell in colony.first}
    assert len(founders) == STEM
    for cell, time in founders.items():
        assert colony.first[cell] == pytest.approx(time, rel=1e-14)
    check_told(colony.events, told_events(colony.scene, SEED, founders, 600.0))


def test_intervals_are_a_delay_and_an_exponential_time(colony: Colony) -> None:
    births = of_kind(colony.events, "birth")
    assert len(births) > 2000
    starts: dict[int, list[float]] = defaultdict(list)
    for birth in births:
        starts[birth.id].append(birth.time)
        starts[birth.parent].append(birth.time)
    assert colony.last is not None
    for cell, due in zip(colony.last.ids, colony.last.next_division, strict=True):
        if due >= 0:
            starts[int(cell)].append(due)  # the interval that the end of the run cuts
    intervals = np.concatenate([np.diff(times) for times in starts.values()])

    delay, rate = 36.0, 0.083
    assert len(intervals) > 2000
    assert intervals.min() >= delay - 600 * TIME_DIGITS
    assert abs(intervals.mean() - (delay + 1 / rate)) < 4 / rate / math.sqrt(len(intervals))
    assert stats.kstest(intervals - delay, stats.expon(scale=1 / rate).cdf).pvalue > UNLIKELY
    assert stats.kstest(intervals - delay, stats.expon(scale=1.2 / rate).cdf).pvalue < UNLIKELY


def test_generations_count_down_to_exhaustion(colony: Colony) -> None:
    left = {cell: None for cell in colony.first}
    divisions = Counter()
    for birth in of_kind(colony.events, "birth"):
        mother = left[birth.parent]
        expected = GENERATIONS if mother is None else mother - 1
        assert 0 <= birth.divisions_left == expected
        assert birth.type == (Kind.TA if expected else Kind.EXHAUSTED)
        left[birth.id] = expected
        if mother is not None:
            left[birth.parent] = expected
            divisions[birth.parent] += 1
    assert max(divisions.values()) == GENERATIONS

    cells = colony.last
    assert cells is not None
    exhausted = cells.types == Kind.EXHAUSTED
    assert exhausted.sum() > 500
    assert (cells.next_division[exhausted] < 0).all()
    assert (cells.next_division[~exhausted] > 600).all()
    for cell, kind, m in zip(cells.ids, cells.types, cells.divisions_left, strict=True):
        expected_left = left[int(cell)]
        assert m == (GENERATIONS if expected_left is None else expected_left)
        assert kind == (Kind.STEM if expected_left is None else Kind.TA if m else Kind.EXHAUSTED)


def test_the_two_of_a_pair_start_around_the_place_of_the_mother(colony: Colony) -> None:
    separations = np.array(list(colony.separations.values()))
    np.testing.assert_allclose(separations, HALF_SEPARATION, rtol=1e-9)
    assert max(colony.shifts.values()) < 1e-12
    assert len(separations) == len(of_kind(colony.events, "birth"))


# ---- directions


def frame(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors (n, 3) normal to each other and to unit normals (n, 3)."""
    axis = np.where(np.abs(normal[:, :1]) > 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    u = axis - (axis * normal).sum(1, keepdims=True) * normal
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    return u, np.cross(normal, u)


def angles(directions: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Angles in the planes, as fractions of a turn in [0, 1)."""
    u, v = frame(normals)
    turn = np.arctan2((directions * v).sum(1), (directions * u).sum(1)) / (2 * np.pi)
    return turn % 1.0


def clustering_directions(normals: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A flawed sampler: polar angle uniform in [0, pi] about an axis of the plane."""
    u, v = frame(normals)
    polar, azimuth = np.pi * random.random(len(normals)), 2 * np.pi * random.random(len(normals))
    components = np.cos(polar), np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth)
    return sum(c[:, None] * axis for c, axis in zip(components, (u, v, normals), strict=True))


def uniformity(directions: np.ndarray, normals: np.ndarray) -> float:
    return float(stats.kstest(angles(directions, normals), "uniform").pvalue)


def test_directions_are_uniform_in_the_tangent_plane(colony: Colony) -> None:
    directions = np.array(list(colony.directions.values()))
    normals = np.array(list(colony.normals.values()))
    tilted = normals[:, 2] < 0.8
    assert tilted.sum() > 500
    assert np.abs((directions * normals).sum(1)).max() < 1e-9
    assert uniformity(directions, normals) > UNLIKELY
    assert uniformity(directions[tilted], normals[tilted]) > UNLIKELY

    flawed = clustering_directions(normals, np.random.default_rng(1))
    assert uniformity(flawed, normals) < UNLIKELY
    assert np.abs((flawed * normals).sum(1)).mean() > 0.3


def test_directions_are_those_told_by_the_seed(colony: Colony) -> None:
    births = of_kind(colony.events, "birth")
    got = angles(
        np.array([colony.directions[birth.id] for birth in births]),
        np.array([colony.normals[birth.id] for birth in births]),
    )
    number: Counter[int] = Counter()
    for birth, angle in zip(births, got, strict=True):
        number[birth.parent] += 1
        told = uniform(SEED, birth.parent, number[birth.parent], ORIENTATION)
        assert abs((angle - told + 0.5) % 1.0 - 0.5) < 1e-9


# ---- first phases


def first_wait_cdf(time: np.ndarray) -> np.ndarray:
    """Of the wait to the first division when the time since the last is uniform in [0, 48)."""
    delay, rate, phase = 36.0, 0.083, 48.0
    inside = np.minimum(time, delay)
    younger = (inside - (np.exp(-rate * (time - inside)) - np.exp(-rate * time)) / rate) / phase
    return younger + (1 - delay / phase) * (1 - np.exp(-rate * time))


def test_first_phases_are_uniform() -> None:
    """Many stem and TA cells; those that do not divide get no schedule."""
    scene = membrane_scene(**{"cells.seed": SEED})
    flat = grid(scene, 48)
    kinds = [Kind.STEM, Kind.TA] * 1100 + [Kind.ND, Kind.EXHAUSTED] * 52
    left = {Kind.STEM: 10, Kind.TA: 2}
    cells = [
        (kind, (*xy, HEIGHT + CONTACT), left.get(kind, 0))
        for kind, xy in zip(kinds, flat, strict=True)
    ]
    with Simulation.begin(scene, configuration=place(scene, cells)) as simulation:
        found = simulation.cells()

    dividing = np.isin(found.types, [Kind.STEM, Kind.TA])
    waits = found.next_division[dividing]
    told = [first_division(scene, SEED, int(cell)) for cell in found.ids[dividing]]
    np.testing.assert_allclose(waits, told, rtol=1e-14, atol=1e-13)
    assert len(waits) == 2200
    assert stats.kstest(waits, first_wait_cdf).pvalue > UNLIKELY
    assert stats.kstest(waits + 1.5, first_wait_cdf).pvalue < UNLIKELY
    assert (found.next_division[~dividing] < 0).all()


# ---- the same schedule however it is computed

FAST = {
    "parameters": "weak5", "cells.generations": 2, "cells.seed": 3, "cells.cycle_delay": 6.5,
    "cells.cycle_rate": 0.4, "cells.first_phase": 8.0, "cells.division_rate": 0.56,
    "numerics.timestep": 0.02,
}  # fmt: skip


def family(directory: Path, ranks: int = 1, threads: int = 1, **changes: object) -> list[Event]:
    """Events of nine stem cells and their line up to t = 20."""
    scene = membrane_scene((32, 36), **FAST).replace(**changes)
    cells = [(Kind.STEM, (*xy, HEIGHT + CONTACT), 2) for xy in grid(scene, 3, jitter=0.4)]
    with Simulation.begin(scene, directory, place(scene, cells), ranks, threads) as simulation:
        simulation.run(until=20.0)
    return read_events(directory)


@pytest.mark.parametrize(
    "change",
    [
        {},
        pytest.param({"ranks": 2}, marks=pytest.mark.slow),
        pytest.param({"threads": 2}, marks=pytest.mark.slow),
        pytest.param({"numerics.timestep": 0.01}, marks=pytest.mark.slow),
        {"numerics.timestep": 0.025},
        {"numerics.event_interval": 0.0},
        {"numerics.event_interval": 1.3},
    ],
    ids=str,
)
def test_schedule_depends_on_nothing_but_the_seed(change: dict, tmp_path: Path) -> None:
    scene = membrane_scene((32, 36), **FAST)
    sheet = math.prod(scene.membrane.lattice)
    founders = {cell: first_division(scene, 3, cell) for cell in range(sheet + 1, sheet + 10)}
    horizon = 18.5  # what is due by then has happened in every run
    events = family(tmp_path, **change)
    told = told_events(scene, 3, founders, horizon)
    assert len(told) >= 40
    assert sum(kind == "birth" for _, kind, *_ in told) >= 20
    check_told([event for event in events if event.time <= horizon], told)


@pytest.mark.parametrize("event_interval", [0.2, 1.0])
def test_events_are_logged_in_the_order_of_their_times(
    event_interval: float, tmp_path: Path
) -> None:
    events = family(tmp_path, **{"numerics.event_interval": event_interval})
    times = [event.time for event in events]
    assert len(times) >= 40
    assert times == sorted(times)
