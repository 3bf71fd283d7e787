"""One small run with births, removals and changes of kind, and what the simulation said of it."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from lammps_skin import lattice
from lammps_skin.configuration import Configuration
from lammps_skin.engine import Cells, Forces
from lammps_skin.kinds import Kind
from lammps_skin.scene import Scene
from lammps_skin.simulation import Simulation
from lammps_skin.trajectory.convert import convert
from lammps_skin.trajectory.dump import Frame, read_dump

INTERVAL, FRAMES = 0.5, 24


class Run(NamedTuple):
    """A directory with skin.dump and skin.h5, and the truth at the time of every frame."""

    directory: Path
    scene: Scene
    particles: list[Forces]
    cells: list[Cells]
    frames: list[Frame]


def small_scene() -> Scene:
    """Cycles of about 1 time unit, pairs of half of that."""
    return Scene.from_dict(
        {
            "name": "small",
            "dermis": {"present": False},
            "membrane": {"lattice": [24, 28]},
            "cells": {
                "stem": 2, "nd": 1, "arrangement": "random", "generations": 2,
                "cycle_delay": 0.5, "cycle_rate": 2.0, "first_phase": 0.5, "division_rate": 5.0,
            },
            "numerics": {"event_interval": 0.1},
            "output": {"dump_interval": INTERVAL, "checkpoint_interval": 0.0},
        }
    )  # fmt: skip


def high_cells(scene: Scene) -> Configuration:
    """The first cells of the scene, and exhausted cells so high that they leave at once."""
    plain = Configuration.from_scene(scene)
    more = np.array([[2.0, 2.0, 26.0], [6.0, 2.0, 26.0], [10.0, 10.0, 26.0]])
    links, hinges = lattice.links_and_hinges(scene.membrane.lattice)
    return Configuration(
        box=plain.box,
        kinds=np.concatenate([plain.kinds, [Kind.EXHAUSTED] * len(more)]),
        positions=np.concatenate([plain.positions, more]),
        links=links,
        hinges=hinges,
        divisions_left=np.concatenate([plain.divisions_left, [0] * len(more)]),
    )


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    directory = tmp_path_factory.mktemp("run")
    scene = small_scene()
    particles, cells = [], []
    with Simulation(scene, directory, high_cells(scene)) as simulation:
        for n in range(FRAMES):
            if n:
                simulation.run(until=n * INTERVAL)
            particles.append(simulation.forces())
            cells.append(simulation.cells())
    convert(directory)
    return Run(directory, scene, particles, cells, list(read_dump(directory / "skin.dump")))
