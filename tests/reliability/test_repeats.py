"""What may be done again in one process: run 0, clear, another simulation, loading the plugin."""

from __future__ import annotations

from pathlib import Path

import lammps_skin.plugin
import numpy as np
import pytest
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import build

from tests.cells.conftest import assert_same_events
from tests.reliability.conftest import (
    SNAPSHOT,
    WHOLE_RUN,
    assert_same_state,
    founders,
    run_script,
    snapshot,
    variables,
)

PLUGIN = Path(lammps_skin.plugin.folder()) / "skinplugin.so"


@pytest.fixture(scope="module")
def short(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run to t = 6, with events, its end in end.dump."""
    directory = tmp_path_factory.mktemp("short")
    build(scene.replace(end_time=6.0), directory, founders(scene))
    run_script(directory, WHOLE_RUN + SNAPSHOT)
    assert len(log(directory).splitlines()) > 5
    return directory


def log(directory: Path) -> str:
    return (directory / "events.csv").read_text()


def test_run_0_changes_nothing(short: Path, scene: Scene, tmp_path: Path) -> None:
    """Before the run and in the middle of it; pairs and schedules are not set up twice."""
    build(scene, tmp_path, founders(scene))
    nothing = "run 0\n" * 3
    half = run_script(
        tmp_path,
        f"variable running index 0\n{WHOLE_RUN}{nothing}run 250\n{nothing}run 250\n{SNAPSHOT}",
    )
    assert half.count("Loop time") == 9
    assert log(tmp_path) == log(short)
    assert_same_state(tmp_path, short, 1e-12)


@pytest.mark.parametrize("command", ["run 0 post no", "write_data {}/now.data", "print now"])
def test_commands_between_pieces_change_no_times(
    command: str, short: Path, scene: Scene, tmp_path: Path
) -> None:
    """The events are those of the run without a command, and so is the time."""
    with Simulation.begin(scene, tmp_path, founders(scene)) as simulation:
        for until in (0.6, 2.4, 4.8, 6.0):
            simulation.run(until=until)
            simulation.command(command.format(tmp_path))
            assert simulation.time == pytest.approx(until, rel=1e-12)
    assert_same_events(tmp_path, short)


def test_clear_and_again(short: Path, scene: Scene, tmp_path: Path) -> None:
    """Three times the same run in one process."""
    build(scene.replace(end_time=6.0), tmp_path, founders(scene))
    names = " ".join(
        line.split()[1]
        for script in tmp_path.glob("*.in")
        for line in script.read_text().splitlines()
        if line.startswith("variable")
    )
    forget = "".join(f"variable {name} delete\n" for name in dict.fromkeys(names.split()))
    again = f"clear\n{forget}{WHOLE_RUN}"
    run_script(tmp_path, f"{WHOLE_RUN}{again}{again}{SNAPSHOT}")
    assert log(tmp_path) == log(short)
    assert_same_state(tmp_path, short, 0.0)


def test_two_simulations_side_by_side(short: Path, scene: Scene, tmp_path: Path) -> None:
    """In turns of uneven length; each is what it would be alone."""
    small = scene.replace(end_time=6.0)
    with (
        Simulation.begin(small, tmp_path / "one", founders(small)) as one,
        Simulation.begin(small.replace(seed=5), tmp_path / "two", founders(small)) as two,
    ):
        for until in (1.2, 3.0, 6.0):
            one.run(until=until)
            two.run(until=until / 2)
        cells = one.cells()
    assert log(tmp_path / "one") == log(short)
    assert log(tmp_path / "two") != log(short)
    told = snapshot(short / "end.dump")
    places = told[np.isin(told[:, 0], cells.ids), 2:5]
    np.testing.assert_allclose(cells.positions, places, rtol=0, atol=1e-12)


def test_plugin_loaded_twice(short: Path, scene: Scene, tmp_path: Path) -> None:
    build(scene, tmp_path, founders(scene))
    load = f"plugin load {PLUGIN}\n"
    said = run_script(
        tmp_path, f"{load}{load}{WHOLE_RUN}{SNAPSHOT}plugin list\n", *variables(end_time=6.0)
    )
    assert said.split("Currently loaded plugins")[1].count("fix style plugin skin/cells") == 1
    assert log(tmp_path) == log(short)
    assert_same_state(tmp_path, short, 0.0)
