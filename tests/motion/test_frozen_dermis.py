"""Deep spheres of the dermis that are held."""

from pathlib import Path

import numpy as np
import pytest
from lammps_skin.engine.engine import Forces
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation

DEEP = 11.0


def scene(level: str, frozen_below: float) -> Scene:
    return Scene.load("one-stem").replace(
        **{
            "end_time": 2.0, "dermis.frozen_below": frozen_below, "numerics.accuracy": level,
            "output.dump_interval": 0.0, "output.checkpoint_interval": 1.0,
        }
    )  # fmt: skip


def moved(start: Forces, end: Forces) -> tuple[np.ndarray, np.ndarray]:
    """How far spheres went: those that started deep, and the others."""
    spheres = start.types == Kind.DERMAL
    distance = np.linalg.norm((end.positions - start.positions)[spheres], axis=1)
    deep = start.positions[spheres, 2] < DEEP
    return distance[deep], distance[~deep]


@pytest.mark.parametrize("level", ["reference", "balanced", "fast"])
def test_deep_spheres_stay(level: str) -> None:
    with Simulation.begin(scene(level, DEEP)) as held, Simulation.begin(scene(level, 0.0)) as free:
        start = held.forces()
        held.run()
        free.run()
        (deep, others), (deep_if_free, _) = (
            moved(start, simulation.forces()) for simulation in (held, free)
        )
        energies = held.energies()["dermis_dermis"], free.energies()["dermis_dermis"]
    assert deep.max() < 1e-12
    assert others.min() > 0
    assert deep_if_free.max() > 1e-3
    assert 0 > energies[0] > energies[1]  # without what they have among each other


def test_the_same_after_a_restart(tmp_path: Path) -> None:
    with Simulation.begin(scene("balanced", DEEP), tmp_path) as whole:
        start = whole.forces()
        whole.run(until=1.0)
        restart = tmp_path / "half.restart"
        whole.command(f"write_restart {restart}")
        whole.run()
        end = whole.forces()
    with Simulation.begin_built(tmp_path, variables={"restart": restart.name}) as resumed:
        resumed.run()
        again = resumed.forces()
    np.testing.assert_allclose(again.positions, end.positions, atol=1e-12)
    assert moved(start, again)[0].max() < 1e-12
