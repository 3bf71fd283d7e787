"""A small real run, and moments whose membrane and cells are known exactly."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from lammps_skin.arrays import Floats
from lammps_skin.figures import gallery, snapshot
from lammps_skin.figures.look import Look
from lammps_skin.figures.moments import Moment
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start import lattice
from lammps_skin.trajectory.dump import write_dump
from lammps_skin.trajectory.frame import CELL_STATE
from lammps_skin.trajectory.store import Store


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One stem cell, t = 0 to 10 in steps of 5, as skin.h5 and skin.dump."""
    directory = tmp_path_factory.mktemp("one-stem")
    scene = Scene.load("one-stem").replace(end_time=10.0, **{"output.dump_interval": 5.0})
    with Simulation.begin(scene, directory) as simulation:
        simulation.run()
    write_dump(directory / "skin.dump", Store(directory / "skin.h5"), scene.kinds)
    return directory


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer pixels, to be quick."""
    monkeypatch.setattr(gallery, "LOOK", Look(size=160, dpi=30))
    monkeypatch.setattr(snapshot, "Look", lambda: Look(size=160, dpi=30))


Landscape = Callable[..., Moment]


@pytest.fixture
def landscape() -> Landscape:
    """Moment of a membrane z = height(x, y), and of particles (kind, x, y, z) beside it."""

    def make(height: Callable[[Floats, Floats], Floats], *particles: tuple[float, ...]) -> Moment:
        scene = Scene.from_dict({"membrane": {"lattice": [60, 70]}, "cells": {"stem": 1, "nd": 1}})
        membrane = lattice.positions(scene.membrane.lattice, scene.spacing, 0.0)
        membrane[:, 2] = height(membrane[:, 0], membrane[:, 1])
        others = np.array(particles, float).reshape(-1, 4)
        kinds = np.concatenate([np.full(len(membrane), Kind.MEMBRANE), others[:, 0].astype(int)])
        positions = np.concatenate([membrane, others[:, 1:]])
        triangles = lattice.triangles(scene.membrane.lattice)
        z = positions[kinds != Kind.DERMAL, 2]
        heights = float(z.min() - 1.4), float(z.max() + 2.8)
        relief = float(membrane[:, 2].min()), float(membrane[:, 2].max())
        ids = np.arange(1, len(kinds) + 1)
        state = {name: np.full(len(kinds), fill) for name, fill in CELL_STATE.items()}
        return Moment(
            scene, 0.0, kinds, positions, triangles, heights, relief, ids, state,
            cast(Store, None),
        )  # fmt: skip

    return make
