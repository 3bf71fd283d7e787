"""The built-in scenes with kinds of cells of their own do what they are there to show."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.analysis.lineage import Events, clone_sizes, read_events
from lammps_skin.analysis.statistics import mean
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import CONTACT, HEIGHT, QUIET, place

SMALL = {"dermis.present": False, "membrane.lattice": [24, 28], "output": QUIET}
HASTY = {
    **SMALL, "cells.arrangement": "random", "cells.cycle_delay": 2.9, "cells.cycle_rate": 10.0,
    "cells.first_phase": 0.0, "cells.division_rate": 5.0,
}  # fmt: skip


def run(scene: Scene, directory: Path) -> tuple[dict[int, int], list[int], Events]:
    """Numbers of the kinds of the first cells by id, those of the last cells, and the events."""
    with Simulation.begin(scene, directory) as simulation:
        first = simulation.cells()
        simulation.run()
        last = simulation.cells().types.tolist()
    founders = dict(zip(first.ids.tolist(), first.types.tolist(), strict=True))
    return founders, last, read_events(directory / "events.csv")


@pytest.mark.parametrize(("name", "left"), [("loose-stem", 1), ("demo", 2)])
def test_a_loose_stem_cell_leaves_where_others_are_held(name, left, tmp_path) -> None:
    """One beyond the range of adhesion, and one on the membrane."""
    scene = Scene.load(name).replace(**SMALL, end_time=1.0)
    cells = [
        (Kind.STEM, (x, 6.0, HEIGHT + scale * CONTACT), 10) for x, scale in ((3.0, 1.3), (9.0, 1.0))
    ]
    with Simulation.begin(scene, tmp_path, place(scene, cells)) as simulation:
        simulation.run()
        assert len(simulation.cells().ids) == left
    deaths = read_events(tmp_path / "events.csv").of("death")
    assert deaths.type.tolist() == [3] * (2 - left)
    assert deaths.cause.tolist() == ["detached"] * (2 - left)


def test_slow_stem_cells_divide_half_as_often(tmp_path) -> None:
    """With cycles of 3 and 6 that vary little, ten and five times in 32."""
    scene = Scene.load("slow-stem").replace(
        **HASTY, end_time=32.0,
        **{
            "cells.generations": 0, "cells.kinds.slow.cycle_delay": 5.8,
            "cells.kinds.slow.cycle_rate": 5.0, "cells.kinds.slow.first_phase": 0.0,
        },
    )  # fmt: skip
    founders, _, events = run(scene, tmp_path)
    births = Counter(founders[mother] for mother in events.of("birth").parent.tolist())
    assert births[Kind.STEM] == pytest.approx(3 * 10, abs=1)
    assert births[7] == pytest.approx(3 * 5, abs=1)


def test_two_kinds_of_ta_cells(tmp_path) -> None:
    scene = Scene.load("two-ta").replace(**HASTY, end_time=10.0)
    founders, last, events = run(scene, tmp_path)
    assert Counter(founders.values()) == {3: 3, 7: 3}
    assert {Kind.STEM, Kind.TA, 7, 8} <= set(last)
    births = events.of("birth")
    left = {kind: births.divisions_left[births.type == kind].max() for kind in (Kind.TA, 8)}
    assert left == {Kind.TA: 10, 8: 3}
    mothers = {id_: kind for id_, kind in founders.items() if kind == 7}
    assert all(births.type[np.isin(births.parent, list(mothers))] == 8)


# ---- as they are built in


@pytest.mark.slow
def test_the_mutant_clone_is_larger_than_its_neighbours(tmp_path) -> None:
    """By the 95 % interval over seeds of its size less the mean of the five others."""
    excess = []
    for seed in range(1, 9):
        scene = Scene.load("mutant").replace(seed=seed, output=QUIET)
        founders, _, events = run(scene, tmp_path / str(seed))
        sizes = clone_sizes(events, np.array(list(founders)), [scene.end_time])[0]
        is_mutant = np.array(list(founders.values())) == 7
        excess.append(sizes[is_mutant].mean() - sizes[~is_mutant].mean())
    found = mean(np.array(excess))
    assert found.low > 10


@pytest.mark.slow
def test_slow_stem_cells_of_the_scene(tmp_path) -> None:
    births = Counter[int]()
    for seed in range(1, 9):
        scene = Scene.load("slow-stem").replace(seed=seed, output=QUIET)
        founders, _, events = run(scene, tmp_path / str(seed))
        mothers = events.of("birth").parent.tolist()
        births += Counter(founders[mother] for mother in mothers if mother in founders)
    assert births[7] / births[Kind.STEM] == pytest.approx(0.5, abs=0.1)


@pytest.mark.slow
def test_loose_stem_cells_of_the_scene(tmp_path) -> None:
    _, last, events = run(Scene.load("loose-stem").replace(output=QUIET), tmp_path)
    deaths = events.of("death")
    left = deaths.cause[deaths.type == Kind.STEM].tolist()
    assert left and set(left) == {"detached"} and last.count(Kind.STEM) == 6 - len(left)


# ---- what dividing pairs may do otherwise


def pair(scene: Scene, apart: float, above: float) -> Configuration:
    """A stem cell on the membrane, and the TA cell that divides from it, higher by a length."""
    spots = [(4.0, 6.0, HEIGHT + CONTACT), (4.0 + apart, 6.0, HEIGHT + CONTACT + above)]
    start = place(scene, [(Kind.STEM, spots[0], 10), (Kind.TA, spots[1], 10)])
    start.pair[-2:] = [len(start.kinds), len(start.kinds) - 1]
    return start


def test_a_cell_of_a_pair_has_another_stiffness(tmp_path) -> None:
    """Twice the stiffness, while it is in a pair, and only beside the kind that is named."""
    energies = {}
    for other in ("none", "ta", "stem"):
        keys = {"paired_with": other, **({} if other == "none" else {"paired_stiffness": 10.0})}
        scene = Scene.load("demo").replace(**SMALL, **{"cells.kinds.ta": keys})
        start = pair(scene, 2.0, 0.2)
        with Simulation.begin(scene, configuration=start) as simulation:
            energies[other] = simulation.energies()["adhesion"]
    assert energies["none"] > 0 and energies["ta"] == energies["none"]
    assert energies["stem"] == pytest.approx(2 * energies["none"])


def test_the_force_in_a_pair_is_the_gradient(tmp_path) -> None:
    """What the stiffness of the pair adds to the force of its TA cell."""

    def told(stiffness: float, above: float) -> tuple[float, float]:
        keys = {"paired_with": "stem", "paired_stiffness": stiffness}
        scene = Scene.load("demo").replace(**SMALL, **{"cells.kinds.ta": keys})
        with Simulation.begin(scene, configuration=pair(scene, 2.0, above)) as simulation:
            return simulation.energies()["adhesion"], simulation.forces().forces[-1, 2]

    added = told(25.0, 0.2)[1] - told(0.0, 0.2)[1]
    slope = (told(25.0, 0.2 + 1e-4)[0] - told(25.0, 0.2 - 1e-4)[0]) / 2e-4
    assert added == pytest.approx(-slope, rel=1e-6)
    assert added < -0.1


def test_a_cell_of_a_pair_may_stay(tmp_path) -> None:
    """Beyond its range, a TA cell leaves its pair, or stays until the pair has ended."""
    ends = {}
    for leaves in (True, False):
        changes = {"cells.removal_in_pair": leaves, "cells.division_rate": 1.0, "end_time": 5.0}
        scene = Scene.load("demo").replace(**SMALL, **changes)
        start = pair(scene, 1.0, 1.5)
        start.next_division[-2:] = 1e3
        directory = tmp_path / str(leaves)
        with Simulation.begin(scene, directory, start) as simulation:
            simulation.run()
        events = read_events(directory / "events.csv")
        ends[leaves] = events.cause.tolist()[0], float(events.time[0])
    assert ends[True][0] in ("detached", "partner_removed")
    assert ends[True][1] < 1.0 < ends[False][1]
    assert ends[False][0] == "grown"


def test_a_division_ends_beyond_a_distance(tmp_path) -> None:
    """The spring has grown after three time units; held together, the two are still a pair."""
    ends = {}
    for distance in (0.0, 0.9):
        changes = {"cells.division_distance": distance, "cells.division_rate": 1.0, "end_time": 4.0}
        scene = Scene.load("demo").replace(**SMALL, **changes)
        start = pair(scene, 2.0, 0.0)
        start.next_division[-2:] = 1e3
        with Simulation.begin(scene, tmp_path / str(distance), start) as simulation:
            simulation.command("fix hold all setforce 0 0 0")
            simulation.run()
        ends[distance] = read_events(tmp_path / str(distance) / "events.csv").cause.tolist()
    assert ends == {0.0: ["grown"], 0.9: []}
