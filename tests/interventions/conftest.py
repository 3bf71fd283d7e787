"""A small busy scene, and one in which all that can be done to it is done."""

from pathlib import Path
from typing import Any

import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation

KEYS: dict[str, Any] = {
    "name": "busy",
    "end_time": 24.0,
    "membrane": {"lattice": [24, 28], "height": 8.0},
    "cells": {
        "stem": 2, "nd": 1, "arrangement": "random", "generations": 2,
        "cycle_delay": 2.0, "cycle_rate": 1.0, "first_phase": 2.0, "division_rate": 1.0,
        "kinds": {"mutant": {"like": "stem"}},
    },
    "output": {"dump_interval": 2.0, "checkpoint_interval": 4.0},
    "interventions": [
        {"name": "thinning", "every": 3.1, "until": 15.0, "remove": ["ta", "exhausted"],
         "fraction": 0.3},
        {"name": "softer", "at": 6.25, "set": {
            "dermis.stiffness": 0.02, "cells.kinds.ta.stiffness": 5.0, "cells.cycle_rate": 0.5}},
        {"name": "mutation", "at": 9.0, "convert": "stem", "to": "mutant", "fraction": 0.6},
        {"name": "wound", "at": 12.0, "remove": "all", "within": {"cylinder": [6.0, 6.0, 3.0]}},
        {"name": "graft", "at": 14.0, "add": "stem", "places": [[6.0, 6.0]]},
        {"name": "stiffer", "at": 16.0, "set": {"membrane.bending_stiffness": 1.0}},
    ],
}  # fmt: skip


@pytest.fixture(scope="session")
def scene() -> Scene:
    return Scene.from_dict(KEYS)


@pytest.fixture(scope="session")
def whole(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run of it."""
    directory = tmp_path_factory.mktemp("whole")
    with Simulation.begin(scene, directory) as simulation:
        simulation.run()
    return directory
