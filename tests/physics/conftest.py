"""Fixtures for tests of the membrane alone."""

from collections.abc import Iterator
from typing import Any

import pytest
from lammps_skin.engine.engine import open_lammps
from sheets import SETTINGS, Sheet, make_sheet


@pytest.fixture(params=["crumpled", "folded"])
def sheet(request: pytest.FixtureRequest) -> Sheet:
    """Return membranes of both shapes."""
    return make_sheet(request.param)


@pytest.fixture
def lammps() -> Iterator[Any]:
    """Return a LAMMPS without anything in it."""
    engine = open_lammps()
    engine.commands_string(SETTINGS)
    yield engine
    engine.close()
