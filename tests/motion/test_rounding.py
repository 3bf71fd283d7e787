"""Rounded positions: on a grid that divides the box, and the same whoever computed them."""

from typing import Any

import numpy as np
import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration

SIZE = 1e-4


def sheet(**changes: Any) -> tuple[Scene, Configuration]:
    """A small rough membrane with some of its particles beyond the periodic edges."""
    keys = {
        "membrane.lattice": [24, 28], "membrane.noise": 0.02, "output.dump_interval": 0.0,
        "numerics.rounding": SIZE, "numerics.rounding_interval": 1.0,
    }  # fmt: skip
    scene = Scene.load("bare-membrane").replace(**{**keys, **changes})
    return scene, Configuration.from_scene(scene)


def positions_at(time: float, changes: dict[str, Any], **how: Any) -> np.ndarray:
    """Places in the box, (n, 3), by id."""
    scene, configuration = sheet(**changes)
    with Simulation.begin(scene, configuration=configuration, **how) as simulation:
        simulation.run(until=time)
        x = simulation.forces().positions
    x[:, :2] %= scene.box_sides[:2]
    return x


def test_positions_are_on_the_grid() -> None:
    scene, configuration = sheet()
    sides = np.array(scene.box_sides)
    grid = sides / np.ceil(sides / SIZE)
    assert ((grid <= SIZE) & (grid > 0.999 * SIZE)).all()
    rounded, exact = (positions_at(1.0, {"numerics.rounding": size}) for size in (SIZE, 0.0))
    assert np.abs(rounded / grid - np.round(rounded / grid)).max() < 1e-6
    delta = rounded - exact
    delta[:, :2] -= sides[:2] * np.round(delta[:, :2] / sides[:2])
    assert 0.4 * SIZE < np.abs(delta).max() < 0.51 * SIZE
    with Simulation.begin(scene, configuration=configuration) as simulation:
        simulation.command("fix sideways all setforce 0 NULL 0")
        simulation.run(until=1.0)
        sideways = simulation.forces().positions
    assert np.abs(sideways / grid - np.round(sideways / grid)).max() < 1e-6
    between = positions_at(1.5, {"numerics.timestep": 0.5})
    assert np.abs(between / grid - np.round(between / grid)).max() > 0.1


@pytest.mark.parametrize(
    "level", ["balanced", *(pytest.param(x, marks=pytest.mark.slow) for x in ("reference", "fast"))]
)
@pytest.mark.parametrize("how", [{"ranks": 2}, {"threads": 2}], ids=["ranks", "threads"])
def test_rounded_positions_are_the_same_to_the_last_bit(level: str, how: dict[str, int]) -> None:
    same, others = (
        [positions_at(4.0, {"numerics.accuracy": level, "numerics.rounding": size}, **more)
         for more in ({}, how)]
        for size in (SIZE, 0.0)
    )  # fmt: skip
    np.testing.assert_array_equal(*same)
    np.testing.assert_allclose(*others, rtol=0, atol=1e-10)


def test_without_rounding_ranks_differ_in_the_last_bits() -> None:
    one, two = (positions_at(4.0, {"numerics.rounding": 0.0}, ranks=n) for n in (1, 2))
    assert not np.array_equal(one, two)
