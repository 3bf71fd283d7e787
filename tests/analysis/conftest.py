"""One small run with births and removals, over a few moments."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest
from lammps_skin.engine.engine import Cells, Forces
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation

INTERVAL, FRAMES = 2.0, 9


class Run(NamedTuple):
    """A run directory, and what the simulation said at the time of every frame."""

    directory: Path
    scene: Scene
    particles: list[Forces]
    cells: list[Cells]
    energies: list[dict[str, float]]


def crowding() -> Scene:
    """Short cycles on a small membrane, so that cells cover it, push each other and leave."""
    return Scene.from_dict(
        {
            "name": "crowding",
            "end_time": INTERVAL * (FRAMES - 1),
            "dermis": {"present": False},
            "membrane": {"lattice": [40, 46]},
            "cells": {
                "stem": 3, "nd": 2, "arrangement": "random", "generations": 3,
                "cycle_delay": 1.0, "cycle_rate": 1.0, "first_phase": 1.0, "division_rate": 2.0,
            },
            "numerics": {"accuracy": "reference"},
            "output": {"dump_interval": INTERVAL, "checkpoint_interval": 0.0},
        }
    )  # fmt: skip


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    directory = tmp_path_factory.mktemp("crowding")
    scene = crowding()
    found = Run(directory, scene, [], [], [])
    with Simulation.begin(scene, directory) as simulation:
        for n in range(FRAMES):
            if n:
                simulation.run(until=n * INTERVAL)
            found.particles.append(simulation.forces())
            found.cells.append(simulation.cells())
            found.energies.append(simulation.energies())
    return found
