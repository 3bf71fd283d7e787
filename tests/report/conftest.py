"""A small run with births and losses, and its page in Chromium."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.report.page import report
from lammps_skin.run.simulation import Simulation

from tests.report.browser import CHROMIUM, Browser


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One stem cell with descendants of few generations, which detach, on a small membrane."""
    directory = tmp_path_factory.mktemp("small") / "small"
    scene = Scene.load("one-stem").replace(
        end_time=300.0,
        **{"output.dump_interval": 60.0, "cells.generations": 2, "dermis.present": False},
    )
    with Simulation.begin(scene, directory) as simulation:
        simulation.run()
    return directory


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    if not CHROMIUM:
        pytest.skip("chromium is not installed: pages are not tried in a browser")
    browser = Browser(tmp_path_factory.mktemp("chromium"))
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def written(run: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of the run."""
    return report([run], tmp_path_factory.mktemp("page") / "report.html")


@pytest.fixture
def page(browser: Browser, written: Path) -> Browser:
    """The page as it is opened from disk."""
    browser.errors.clear()
    if browser.shown == written.as_uri():
        browser.restore()
    else:
        browser.requested.clear()
        browser.open(written.as_uri())
    return browser
