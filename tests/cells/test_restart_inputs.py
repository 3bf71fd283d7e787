"""The input scripts as LAMMPS reads them: ranks, threads, overrides, restart and data files."""

import math
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from lammps_skin.kinds import Kind
from lammps_skin.model.scene import Scene
from lammps_skin.run.simulation import Simulation
from lammps_skin.start.build import build
from lammps_skin.start.configuration import Configuration

from tests.cells.conftest import (
    HEIGHT,
    QUIET,
    TIME_DIGITS,
    Frame,
    assert_same_events,
    busy_scene,
    crowd,
    first_division,
    frames,
    lmp,
    membrane_scene,
    of_kind,
    place,
    read_events,
    thermo,
)

HALF, END = 6.0, 12.0
ROUNDING = 1e-9
RESTART = ("-var", "restart", "skin.1.restart")


@pytest.fixture(scope="module")
def scene() -> Scene:
    return busy_scene(
        **{"end_time": END, "output.dump_interval": 1.0, "output.checkpoint_interval": HALF}
    )


def founders(scene: Scene) -> Configuration:
    return crowd(scene, across=5, amplitude=0.5, above=2.2)


def run(directory: Path, *arguments: str, ranks: int = 1) -> None:
    process = lmp(directory, *arguments, ranks=ranks)
    assert process.returncode == 0, process.stdout[-2000:] + process.stderr[-2000:]


def variables(*values: str) -> list[str]:
    """Arguments that override variables."""
    return [word for value in values for word in ("-var", *value.split())]


def failure(directory: Path, *arguments: str) -> str:
    """The error of a run that stops."""
    process = lmp(directory, *arguments)
    assert process.returncode != 0
    errors = [line for line in process.stdout.splitlines() if line.startswith("ERROR")]
    assert len(errors) == 1
    return errors[0]


@pytest.fixture(scope="module")
def whole(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a run in one go, on one rank, with many events in both of its halves."""
    directory = tmp_path_factory.mktemp("whole")
    build(scene, directory, founders(scene))
    run(directory)
    times = [event.time for event in read_events(directory)]
    assert min(sum(time < HALF for time in times), sum(time > HALF for time in times)) > 15
    return directory


def all_frames(directory: Path) -> list[Frame]:
    """The frames of all dump files, in the order in which they were written."""
    dumps = sorted(directory.glob("skin*.dump"), key=lambda dump: dump.stat().st_mtime_ns)
    return [frame for dump in dumps for frame in frames(dump)]


def assert_same_end(directory: Path, other: Path, sides: tuple[float, ...]) -> None:
    """The same particles in the same places in the last frames, and the same last counts."""
    (time, ids, types, ours), (time_, ids_, types_, theirs) = (
        frames(directory)[-1],
        frames(other)[-1],
    )
    assert (time, ids, types) == (time_, ids_, types_)
    assert len(ids) > 24 * 28
    delta = ours - theirs
    delta[:, :2] -= np.multiply(sides[:2], np.round(delta[:, :2] / sides[:2]))
    assert np.abs(delta).max() < ROUNDING
    last, last_ = thermo(directory)[-1], thermo(other)[-1]
    assert last.keys() == last_.keys()
    for column, value in last.items():
        assert value == pytest.approx(last_[column], rel=1e-8, abs=1e-9), column


@pytest.mark.parametrize(
    ("ranks", "arguments"),
    [(2, ()), (1, ("-sf", "omp", "-pk", "omp", "2"))],
    ids=["two-ranks", "two-threads"],
)
def test_ranks_and_threads_do_the_same(
    ranks: int, arguments: tuple[str, ...], scene: Scene, whole: Path, tmp_path: Path
) -> None:
    build(scene, tmp_path, founders(scene))
    run(tmp_path, *arguments, ranks=ranks)
    assert_same_events(tmp_path, whole)
    assert_same_end(tmp_path, whole, scene.box_sides)


# ---- overrides


def test_seed_is_overridden(scene: Scene, whole: Path, tmp_path: Path) -> None:
    build(scene, tmp_path, founders(scene))
    run(tmp_path, *variables("seed 99"))
    stem = np.flatnonzero(founders(scene).kinds == Kind.STEM) + 1
    for directory, seed in ((tmp_path, 99), (whole, scene.cell_seed)):
        first: dict[int, float] = {}
        for birth in of_kind(read_events(directory), "birth"):
            first.setdefault(birth.parent, birth.time)
        told = {int(cell): first_division(scene, seed, int(cell)) for cell in stem}
        for cell, time in told.items():
            if time < END - 0.2:
                assert first[cell] == pytest.approx(time, rel=TIME_DIGITS)
        assert sum(time < END - 0.2 for time in told.values()) >= 3


@pytest.mark.parametrize("start", [0.0, HALF])
def test_timestep_and_end_time_are_overridden(start: float, tmp_path: Path) -> None:
    """Also where the configuration does not begin at time 0."""
    scene = busy_scene(**{"end_time": END})
    configuration = founders(scene)
    configuration.time = start
    build(scene, tmp_path, configuration)
    run(tmp_path, *variables("timestep 0.01", "end_time 8", "thermo_interval 1"))
    times = [row["Time"] for row in thermo(tmp_path)]
    steps = [row["Step"] for row in thermo(tmp_path)]
    np.testing.assert_allclose(times, np.arange(start, 8.5), atol=1e-9)
    assert np.diff(steps) == pytest.approx(np.diff(times) / 0.01)


# ---- restart


@pytest.mark.parametrize(
    ("first", "second"), [(1, 1), (1, 2), pytest.param(2, 1, marks=pytest.mark.slow)]
)
def test_restart_goes_on(
    first: int, second: int, scene: Scene, whole: Path, tmp_path: Path
) -> None:
    build(scene, tmp_path, founders(scene))
    run(tmp_path, *variables(f"end_time {HALF}"), ranks=first)
    half = read_events(tmp_path)
    assert 0 < len(half) < len(read_events(whole))
    run(tmp_path, *RESTART, ranks=second)
    assert_same_events(tmp_path, whole)
    assert_same_end(tmp_path, whole, scene.box_sides)
    times = [frame[0] for frame in all_frames(tmp_path)]
    assert times == [frame[0] for frame in frames(whole)]


@pytest.mark.parametrize("event_interval", [0.0, 0.14, 0.2])
def test_restart_cuts_off_what_came_later(
    event_interval: float, scene: Scene, tmp_path: Path
) -> None:
    """Restart in the middle of a run that had gone on, as after a crash.

    With the first two intervals the step after the restart is one that handles events.
    """
    whole, again = tmp_path / "whole", tmp_path / "again"
    build(scene, whole, founders(scene))
    interval = variables(f"event_interval {event_interval}")
    run(whole, *interval)
    shutil.copytree(whole, again)
    run(again, *RESTART, *interval)
    assert_same_events(again, whole)
    assert_same_end(again, whole, scene.box_sides)


def test_restart_with_another_timestep_ends_in_time(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    run(tmp_path, *RESTART, *variables("timestep 0.01"))
    assert thermo(tmp_path)[-1]["Time"] == pytest.approx(END)


def test_restart_without_the_log_begins_one(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    (tmp_path / "events.csv").unlink()
    run(tmp_path, *RESTART)
    rest = [event for event in read_events(whole) if event.time > HALF]
    assert [(e.kind, e.id) for e in read_events(tmp_path)] == [(e.kind, e.id) for e in rest]


def test_restart_refuses_the_log_of_another_run(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    (tmp_path / "events.csv").write_text("time,kind\n")
    assert "it is not the log of this run" in failure(tmp_path, *RESTART)


def test_restart_remembers_the_ids_of_the_dead(tmp_path: Path) -> None:
    """The cell with the highest id dies before the restart, a stem cell divides after it."""
    output = {**QUIET, "checkpoint_interval": 1.0}
    scene = membrane_scene(
        **{
            "end_time": 2.0,
            "numerics.accuracy": "reference",
            "numerics.timestep": 0.02,
            "output": output,
        }
    )
    spot = (6.0, 7 * math.sqrt(3) / 2)
    configuration = place(
        scene,
        [(Kind.STEM, (*spot, HEIGHT + 2.4), 10), (Kind.EXHAUSTED, (1.0, spot[1], HEIGHT + 3.1), 0)],
    )
    configuration.next_division[-2] = 1.5
    build(scene, tmp_path, configuration)
    run(tmp_path, *variables("end_time 1"))
    run(tmp_path, *RESTART)
    assert [(e.kind, e.id) for e in read_events(tmp_path)] == [("death", 674), ("birth", 675)]
    row = thermo(tmp_path)[-1]
    assert (row["f_cells[9]"], row["f_cells[10]"]) == (1, 1)


def test_membrane_without_cells_restarts(tmp_path: Path) -> None:
    scene = Scene.load("bare-membrane").replace(
        **{
            "membrane.lattice": [24, 28], "end_time": 2.0, "numerics.timestep": 0.02,
            "output": {"dump_interval": 1.0, "checkpoint_interval": 1.0},
        }
    )  # fmt: skip
    build(scene, tmp_path)
    run(tmp_path)
    _, _, _, told = frames(tmp_path)[-1]
    run(tmp_path, *RESTART)
    _, _, _, found = frames(tmp_path)[-1]
    np.testing.assert_allclose(found[:, 2], told[:, 2], rtol=0, atol=ROUNDING)
    assert np.ptp(found[:, 2]) > 1e-3


# ---- data files


def test_written_data_file_goes_on(scene: Scene, whole: Path, tmp_path: Path) -> None:
    """The state of the cells goes through write_data and read_data."""
    with Simulation.begin(scene, tmp_path, founders(scene)) as simulation:
        simulation.run(until=HALF)
        simulation.command(f"write_data {tmp_path / 'half.data'} nocoeff")
    shutil.copyfile(tmp_path / "half.data", tmp_path / "skin.data")
    step = round(HALF / scene.numerics.timestep)
    run(tmp_path, *variables(f"start_time {HALF}", f"start_step {step}"))
    rest = [event for event in read_events(whole) if event.time > HALF]
    found = read_events(tmp_path)
    assert [(e.kind, e.id, e.parent, e.divisions_left) for e in found] == [
        (e.kind, e.id, e.parent, e.divisions_left) for e in rest
    ]
    assert [e.time for e in found] == pytest.approx([e.time for e in rest], rel=TIME_DIGITS)
    assert np.abs(frames(tmp_path)[-1][3] - frames(whole)[-1][3])[:, 2].max() < ROUNDING


# ---- a scene names only what it has


def texts(directory: Path) -> str:
    """Everything built and logged, but for the comments of the input scripts."""
    files = [path for path in directory.iterdir() if path.suffix != ".csv"]
    lines = [line for path in files for line in path.read_text().splitlines()]
    return "\n".join(line.split("#")[0] for line in lines)


def fixes(directory: Path) -> list[str]:
    """Ids of the fixes that the log shows."""
    log = (directory / "log.lammps").read_text()
    return re.findall(r"^fix +(\w+) \w+ [\w/]+", log, re.MULTILINE)


def part_of(**changes: object) -> Scene:
    return Scene.from_dict(
        {
            "end_time": 0.1,
            "membrane": {"lattice": [24, 28]},
            "output": QUIET,
            "numerics": {"accuracy": "reference"},
        }
    ).replace(**changes)


def test_scene_without_dermis_has_none_of_it(tmp_path: Path) -> None:
    build(part_of(**{"dermis.present": False, "cells.stem": 1}), tmp_path)
    run(tmp_path)
    assert not list(tmp_path.glob("dermis*"))
    assert "dermal" not in texts(tmp_path)
    assert set(fixes(tmp_path)) == {"state", "cells", "motion"}


def test_scene_without_cells_has_none_of_them(tmp_path: Path) -> None:
    build(part_of(**{"dermis.volume_fraction": 0.1}), tmp_path)
    run(tmp_path)
    assert not list(tmp_path.glob("cell*"))
    assert len((tmp_path / "events.csv").read_text().splitlines()) == 1
    for word in ("skin/cells", "stem", "exhausted", "f_cells", "cell_"):
        assert word not in texts(tmp_path)
    assert "dermal" in texts(tmp_path)
    assert set(fixes(tmp_path)) == {"wall", "motion"}
