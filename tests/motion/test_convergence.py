"""Orders of convergence of the integrators where nothing happens but smooth forces."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import CONTACT, HALF_SEPARATION, HEIGHT, membrane_scene, place

ORDERS = {"euler": 1, "rkl1": 1, "rkl2": 2}
END = 2.0
TOLERANCE = 0.1
LIMIT = 1.0  # of stiffness: 99 % of the particles move slower, but not all


def observed(errors: list[float]) -> np.ndarray:
    """Orders between successive halvings of the timestep."""
    return np.log2(np.array(errors[:-1]) / errors[1:])


def sheet(integrator: str, timestep: float, limit: float = 0.0, move: float = 0.0) -> Scene:
    return Scene.load("bare-membrane").replace(
        **{
            "parameters": "printed", "membrane.lattice": [12, 14], "membrane.noise": 0.05,
            "output.dump_interval": 0.0, "output.thermo_interval": 2.0,
            "numerics.accuracy": "reference",
            "numerics.integrator": integrator,
            "numerics.stages": 5, "numerics.timestep": timestep, "numerics.largest_move": move,
            "numerics.stiffness_limit": limit,
        }
    )  # fmt: skip


def smooth_sheet(scene: Scene, start: Configuration) -> np.ndarray:
    """Positions at the end; harmonic links, since the slope of the model's has kinks at rest."""
    with Simulation.begin(scene, configuration=start) as simulation:
        for command in ("bond_style harmonic", "bond_coeff * 0.5 0.5"):
            simulation.command(command)
        simulation.run(until=END)
        moved: np.ndarray = simulation.forces().positions
        motion = simulation.motion()
    if scene.numerics.stiffness_limit:
        assert 0.9 < motion.lowered < 1
    if scene.numerics.largest_move:
        assert motion.divided == motion.steps
    return moved


@pytest.mark.parametrize("limit", [0.0, LIMIT])
@pytest.mark.parametrize(("integrator", "order"), ORDERS.items())
def test_membrane(integrator: str, order: int, limit: float) -> None:
    start = Configuration.from_scene(sheet("rkl2", 0.01))
    exact = smooth_sheet(sheet("rkl2", END / 2048, limit), start)
    errors = [
        float(np.abs(smooth_sheet(sheet(integrator, END / n, limit), start) - exact).max())
        for n in (64, 128, 256)
    ]
    assert np.abs(start.positions - exact).max() > 100 * errors[0] > 0
    np.testing.assert_allclose(observed(errors), order, atol=TOLERANCE)


def test_divided_euler() -> None:
    """Where every step is divided, the largest move takes the place of the timestep."""
    start = Configuration.from_scene(sheet("rkl2", 0.01))
    exact = smooth_sheet(sheet("rkl2", END / 2048), start)
    errors = [
        float(np.abs(smooth_sheet(sheet("euler", END, move=move), start) - exact).max())
        for move in (2e-4, 1e-4, 5e-5)
    ]
    np.testing.assert_allclose(observed(errors), 1, atol=TOLERANCE)


def pair_length(integrator: str, timestep: float, directory: Path) -> float:
    """Distance of the two cells of a division at the end, nothing else pulling at them."""
    free: dict[str, Any] = {
        "cells.adhesion_stiffness": 0.0, "cells.binding_stiffness": 0.0,
        "cells.membrane_exclusion_stiffness": 0.0, "cells.generations": 0,
        "membrane.stretch_stiffness": 0.0, "membrane.bending_stiffness": 0.0,
        "numerics.integrator": integrator, "numerics.stages": 5,
        "numerics.timestep": timestep, "numerics.largest_move": 0.0, "numerics.rounding": 0.0,
    }  # fmt: skip
    scene = membrane_scene((12, 14), **free, **{"cells.division_stiffness": 0.5})
    configuration = place(
        scene,
        [(Kind.STEM, (3.0, 3.0, HEIGHT + CONTACT), 0),
         (Kind.EXHAUSTED, (3.0 + 2 * HALF_SEPARATION, 3.0, HEIGHT + CONTACT), 0)],
    )  # fmt: skip
    configuration.pair[-2:] = len(configuration.pair) - np.array([0, 1])
    configuration.pair_start[-2:] = 0.0
    with Simulation.begin(scene, directory, configuration) as simulation:
        simulation.run(until=END)
        places = simulation.cells().positions
    return float(np.linalg.norm(places[1] - places[0]))


@pytest.mark.parametrize(("integrator", "order"), ORDERS.items())
def test_growing_spring(integrator: str, order: int, tmp_path: Path) -> None:
    """Stages take the natural length at their own times: dr/dt = -2 k (r - l0 - g t)."""
    k, start, growth = 0.5, 2 * HALF_SEPARATION, 0.14
    lag = growth / (2 * k)
    exact = start + growth * END - lag * (1 - np.exp(-2 * k * END))
    errors = [abs(pair_length(integrator, END / n, tmp_path / str(n)) - exact) for n in (8, 16, 32)]
    np.testing.assert_allclose(observed(errors), order, atol=TOLERANCE)
