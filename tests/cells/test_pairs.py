"""The two cells of a division: their growing spring, and what they do not feel meanwhile."""

from pathlib import Path

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.model import potentials
from lammps_skin.run.simulation import Simulation

from tests.cells.conftest import (
    CONTACT,
    HALF_SEPARATION,
    HEIGHT,
    RADIUS,
    TIME_DIGITS,
    first_division,
    membrane_scene,
    of_kind,
    place,
    read_events,
)


def test_a_cell_of_a_pair_waits_for_its_end(tmp_path: Path) -> None:
    """A pair grows for 19.9 time units here, longer than any cell's cycle."""
    scene = membrane_scene(
        **{
            "parameters": "weak5", "cells.generations": 1, "cells.cycle_delay": 1.0,
            "cells.cycle_rate": 5.0, "cells.first_phase": 0.0, "numerics.timestep": 0.02,
        }
    )  # fmt: skip
    cells = [(Kind.STEM, (6.0, 6.0, HEIGHT + CONTACT), 1)]
    with Simulation.begin(scene, tmp_path, place(scene, cells)) as simulation:
        stem = int(simulation.cells().ids[0])
        simulation.run(until=45.0)
    first = first_division(scene, scene.cell_seed, stem)
    duration = (2 * RADIUS - 2 * HALF_SEPARATION) / 0.14
    ends = [e.time for e in of_kind(read_events(tmp_path), "division_end")]
    births = [e.time for e in of_kind(read_events(tmp_path), "birth") if e.parent == stem]
    assert births == pytest.approx([first, first + duration, first + 2 * duration], rel=TIME_DIGITS)
    assert ends == pytest.approx([first + duration] * 1 + [first + 2 * duration] * 2, rel=1e-9)
    # what happens at one time: a pair ends before its cells divide
    kinds = [e.kind for e in read_events(tmp_path) if e.time == pytest.approx(first + duration)]
    assert kinds == ["division_end", "birth", "birth"]


@pytest.mark.parametrize("spring", ["length", "reduced"])
def test_pair_follows_its_growing_spring(spring: str, tmp_path: Path) -> None:
    """A stem cell divides with nothing but the spring and the cells' own interactions."""
    timestep = 0.01
    scene = membrane_scene(
        **{
            "parameters": "papilla", "cells.division_spring": spring,
            "cells.adhesion_stiffness": 0.0, "cells.binding_stiffness": 0.0,
            "cells.membrane_exclusion_stiffness": 0.0, "cells.generations": 0,
            "numerics.timestep": timestep, "numerics.event_interval": 0.0,
            "numerics.rounding": 0.0,
        }
    )  # fmt: skip
    # the spring of the model's section 6: stiffness, first length, growth per time unit
    k, start, rate = {"length": (5.0, 0.014, 0.14), "reduced": (5 / 2.8**2, 0.0, 0.14 * 2.8)}[
        spring
    ]
    configuration = place(scene, [(Kind.STEM, (0.1, 0.1, HEIGHT + CONTACT), 0)])
    birth = 0.323
    configuration.next_division[-1] = birth
    end = birth + (2 * RADIUS - start) / rate

    times, distances, energies = [], [], []

    def watch(time: float, simulation: Simulation) -> None:
        cells = simulation.cells()
        if len(cells.ids) == 2:
            delta = cells.positions[1] - cells.positions[0]
            delta[:2] -= scene.box_sides[:2] * np.round(delta[:2] / scene.box_sides[:2])
            times.append(time)
            distances.append(float(np.linalg.norm(delta)))
            energies.append(simulation.energies())

    with Simulation.begin(scene, tmp_path, configuration) as simulation:
        simulation.run(until=end + 0.1, progress=watch, every=timestep)
    t, d = np.array(times), np.array(distances)
    paired = t < end

    # the very steps of the pair, and the solution that they approach
    assert t[0] == pytest.approx(0.33)
    steps = [2 * HALF_SEPARATION]
    for time in t[paired][:-1]:
        steps.append(steps[-1] - 2 * timestep * k * (steps[-1] - (start + rate * (time - birth))))
    np.testing.assert_allclose(d[paired], steps, rtol=0, atol=1e-10)
    lag = rate / (2 * k)
    since = t[paired] - t[0]
    length = start + rate * (t[paired] - birth)
    exact = length - lag + (steps[0] - length[0] + lag) * np.exp(-2 * k * since)
    assert np.abs(d[paired] - exact).max() < 2 * k * lag * timestep

    division = np.array([energy["division"] for energy in energies])
    np.testing.assert_allclose(division[paired], k / 2 * (d[paired] - length) ** 2, atol=1e-12)
    exclusion = np.array([energy["cell_cell_exclusion"] for energy in energies])
    adhesion = np.array([energy["cell_cell_adhesion"] for energy in energies])
    assert (exclusion[paired] == 0).all()
    assert (adhesion[paired] == 0).all()

    x = d[~paired] / (2 * RADIUS)
    assert len(x) >= 10
    assert (division[~paired] == 0).all()
    assert exclusion[~paired].min() > 1e-6
    np.testing.assert_allclose(exclusion[~paired], 0.04 * potentials.exclusion(x), rtol=1e-9)
    np.testing.assert_allclose(
        adhesion[~paired], 0.03 * potentials.shifted_adhesion(x, 1.2), rtol=1e-5
    )
    assert [event.time for event in read_events(tmp_path)] == pytest.approx([birth, end], rel=1e-9)
