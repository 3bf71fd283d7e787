"""A rough sheet with cells that divide often, and the command."""

from pathlib import Path

import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.study.tradeoff.measure import Measurements

from tests.study.ensemble.conftest import skin  # noqa: F401


@pytest.fixture
def busy() -> Scene:
    return Scene.from_dict(
        {
            "name": "busy",
            "end_time": 4.0,
            "dermis": {"present": False},
            "membrane": {"lattice": [24, 28], "noise": 0.02},
            "cells": {"stem": 3, "cycle_delay": 0.1, "cycle_rate": 5.0, "first_phase": 0.1},
        }
    )


@pytest.fixture
def measurements(busy: Scene, tmp_path: Path) -> Measurements:
    return Measurements(busy, tmp_path / "measured", interval=1.0)
