"""Runs to compare with, and one that a kill has ended half way."""

from pathlib import Path

import pytest
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import build

from tests.run.disturbed import Outcome, Runner, eventful, founders, outcome


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    directory, scene = tmp_path_factory.mktemp("undisturbed"), eventful()
    with Simulation.begin(scene, directory, founders(scene)) as whole:
        whole.run()
        found = outcome(directory, whole)
    for kind in ("birth", "death", "division_end"):
        assert found.events.count(kind) > 3
    return found


@pytest.fixture
def built(tmp_path: Path) -> Path:
    scene = eventful()
    build(scene, tmp_path, founders(scene))
    return tmp_path


@pytest.fixture(scope="session")
def halfway(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run that a kill has ended after t = 5: copy it."""
    directory, scene = tmp_path_factory.mktemp("halfway"), eventful()
    build(scene, directory, founders(scene))
    with Runner(directory) as runner:
        runner.wait_for(5.1)
        runner.process.kill()
    return directory
