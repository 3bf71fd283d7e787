"""One small run with births and removals, over a few moments, and one with papillae."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from lammps_skin.engine.engine import Cells, Forces
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.configuration import Configuration

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


def papillae() -> Configuration:
    """Two papillae of different heights, and cells on them and beside them."""
    y, x = np.mgrid[0:46, 0:40] / [[[46]], [[40]]] * 20.0
    heights = [
        height * np.exp(-((x - at) ** 2 + (y - at) ** 2) / (2 * 2.2**2))
        for at, height in ((5.0, 5.0), (15.0, 4.0))
    ]
    return Configuration.from_scene(crowding().replace(**{"cells.stem": 6}), sum(heights))


def recorded(directory: Path, scene: Scene, start: Configuration | None, frames: int) -> Run:
    """A run, and what the simulation said at each of its frames."""
    found = Run(directory, scene, [], [], [])
    with Simulation.begin(scene, directory, start) as simulation:
        for n in range(frames):
            if n:
                simulation.run(until=n * INTERVAL)
            found.particles.append(simulation.forces())
            found.cells.append(simulation.cells())
            found.energies.append(simulation.energies())
    return found


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return recorded(tmp_path_factory.mktemp("crowding"), crowding(), None, FRAMES)


@pytest.fixture(scope="session")
def run_with_papillae(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return recorded(tmp_path_factory.mktemp("papillae"), crowding(), papillae(), 3)
