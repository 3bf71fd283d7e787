"""docs/compatibility.md says what the table of commands says."""

import re
import shutil
from collections import Counter
from pathlib import Path

import pytest
from lammps_skin.errors import SimulationError
from lammps_skin.run.simulation import Simulation

from tests.compatibility.conftest import Runner
from tests.compatibility.page import PAGE, whole
from tests.compatibility.scenes import configuration_of, scene_of
from tests.compatibility.tries import table


def test_page_holds_the_table() -> None:
    text = PAGE.read_text("utf-8")
    assert text == whole(text), "make it anew: python -m tests.compatibility.page"


def test_commands_are_named_once() -> None:
    names = Counter((row.family, row.command) for row in table())
    assert max(names.values()) == 1


def test_example_runs(scenes: Path, run_in: Runner, tmp_path: Path) -> None:
    """Shortened: it heals for 120 steps."""
    directory = tmp_path / "wound"
    shutil.copytree(scenes / "cells", directory)
    example = re.findall("^```\n(.*?)^```$", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)[0]
    short = re.sub(r"^run +4000$", "run 120", example, flags=re.MULTILINE)
    assert short.count("run 120") == 2
    (directory / "try.in").write_text(short)
    assert run_in(directory, "") == 0, (directory / "error.txt").read_text()
    assert len((directory / "density.txt").read_text().splitlines()) > 100


@pytest.mark.parametrize(
    "commands",
    [
        ("fix change all deform 1 x scale 1.05 remap x",),
        ("change_box all triclinic", "fix change all deform 1 xy erate 0.05 remap x"),
        ("fix change all press/berendsen x 1.0 1.0 10.0 y 1.0 1.0 10.0",),
    ],
    ids=["deform", "shear", "press"],
)
@pytest.mark.parametrize("interval", [0.0, 1.0])
def test_boxes_of_frames(interval: float, commands: tuple[str, ...]) -> None:
    """Where the box changes a run that records frames ends with the line of the page."""
    line = "the box does not begin at the origin, or is tilted"
    assert line in " ".join(PAGE.read_text("utf-8").split())
    scene = scene_of("membrane").replace(**{"output.dump_interval": interval})
    with Simulation.begin(scene, configuration=configuration_of(scene)) as simulation:
        for command in commands:
            simulation.command(command)
        if not interval:
            simulation.run(until=2.0)
            return
        with pytest.raises(SimulationError, match=line):
            simulation.run(until=2.0)
