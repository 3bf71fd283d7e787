"""Studies of scenes that are run in a second."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import pytest
from lammps_skin.study.studies.design import Design
from lammps_skin.study.studies.runs import Study, StudyRun

TINY = """\
[scene]
name = "tiny"
end_time = 3.0
[scene.dermis]
present = false
[scene.membrane]
lattice = [12, 14]
[scene.cells]
stem = 1
cycle_delay = 0.5
cycle_rate = 2.0
first_phase = 0.5
[scene.numerics]
accuracy = "reference"
[scene.output]
dump_interval = 0.5
"""


def made(place: Path, begin: str = "", end: str = "", folder: str = "study") -> Study:
    """A study of the tiny scene: what its file begins with, what it ends with, its folder."""
    path = place / "tiny.toml"
    seeds = "" if "seeds" in begin else 'seeds = "1-2"'
    path.write_text(f"{seeds}\n{begin}\n{TINY}\n{end}\n")
    return Study(Design.load(path), place / folder)


def events(runs: Iterable[StudyRun]) -> list[list[str]]:
    """What has happened to each run."""
    return [[line["event"] for line in run.history] for run in runs]


@pytest.fixture
def study(tmp_path: Path) -> Callable[..., Study]:
    """A study of the tiny scene: what its file begins with, what it ends with, its folder."""

    def make(begin: str = "", end: str = "", folder: str = "study") -> Study:
        return made(tmp_path, begin, end, folder)

    return make
